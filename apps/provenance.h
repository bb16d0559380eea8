#pragma once
#include "apps/run_record.h"

#include <complex>
#include <functional>
#include <string>
#include <vector>

namespace apps {

/// Where a file comes from: its kind, program, revision, compiler, machine, time, and the scene's
/// name and title, as attributes.
void write_origin(dem::Hdf5File& file, const LoadedScene& scene, const std::string& kind);

/// |E*| and phase angle over frequency.
/// \param frequencies  [Hz]
/// \param modulus      E* [Pa] at an angular frequency [rad/s]
std::vector<Column> modulus_columns(const std::vector<double>& frequencies,
                                    const std::function<std::complex<double>(double)>& modulus);

} // namespace apps
