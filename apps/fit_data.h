#pragma once
#include "fem/measurements.h"

#include <filesystem>
#include <string>
#include <vector>

namespace apps {

/// A table of a laboratory test.
struct FitData {
  fem::Measurements measurements;
  std::vector<std::string> specimens; ///< of each point; empty without such a column
  bool has_temperature = false;
  std::vector<double> stresses; ///< of each point [Pa]; empty without such a column
};

/// Reads a CSV whose columns carry units:
///
///   time [s], creep compliance [1/GPa]
///   time [s], axial strain [%], axial stress [kPa]     (creep: their ratio is the compliance)
///   time [s], relaxation modulus [MPa]
///   frequency [Hz], dynamic modulus [MPa], and maybe phase angle [deg]
///
/// and maybe temperature [degC] (without it: 20 degC), specimen (any text), weight.
/// \throws std::invalid_argument naming file, line and column: a column that is missing, unknown,
/// or
///         of another dimension; a cell that is not a number or not > 0; a phase angle outside 0 to
///         90 degrees; times that do not rise within a specimen, temperature and stress; fewer than
///         three rows
FitData read_fit_data(const std::filesystem::path& file);

} // namespace apps
