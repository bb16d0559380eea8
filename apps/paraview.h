#pragma once
#include "apps/run_record.h"

#include <filesystem>

namespace apps {

/// Writes snapshots for ParaView into a folder: particles.pvd (points with radius, displacement,
/// rotation) and bonds.pvd (lines with force, moment, state), one file per time. Lengths in m,
/// points at their displaced places.
void write_paraview(const std::filesystem::path& folder, const dem::Assembly& assembly,
                    const std::vector<Snapshot>& snapshots);

} // namespace apps
