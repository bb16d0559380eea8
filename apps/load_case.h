#pragma once
#include "apps/scene.h"
#include "dem/assembly.h"

#include <vector>

namespace apps {

/// The load history of a scene for the solvers: tension positive, force or displacement of the
/// upper platen, or factor of the particle loads.
/// \param area    on which the stress acts [m^2]
/// \param length  that the strain refers to [m]
dem::Loading make_loading(const Scene& scene, double area, double length);

/// Times at which the history is recorded, from the start to the end of the loading.
std::vector<double> history_times(const Scene& scene, const dem::Loading& loading);

/// Times at which particles and bonds are stored: start, those asked for, end.
std::vector<double> snapshot_times(const Scene& scene, const dem::Loading& loading);

/// Nominal axial stress [Pa] and strain [-] at the specimen's face, compression positive.
double face_stress(const dem::Assembly& assembly, double platen_force);

} // namespace apps
