#pragma once
#include "apps/run_record.h"
#include "apps/scene.h"
#include "dem/cyclic_loading.h"

#include <optional>
#include <vector>

namespace apps {

/// The pulses of a cyclic test as forces on the platen, tension positive; nothing for other tests.
std::optional<dem::CyclicLoad> cyclic_load(const Scene& scene, double area);

/// Numbers of the cycles that are recorded, from 1 and ascending; the last is among them.
///
/// All, if there are no more than `Output/History times`; else so many, in steps that grow with the
/// number (in equal steps if `Output/Spacing` is linear).
std::vector<long> recorded_cycles(const Scene& scene);

/// History times of a cyclic test: in each recorded cycle all points of the load, on both sides of
/// jumps, and a sixteenth and a quarter into each block and each rest.
std::vector<double> cycle_times(const Scene& scene, const dem::Loading& loading);

/// Strains of each recorded cycle that was completed: the largest in the direction of the pulse,
/// the one that is left at its end (permanent), and their difference (resilient).
std::vector<Column> cycle_columns(const Scene& scene, const RunRecord& record);

} // namespace apps
