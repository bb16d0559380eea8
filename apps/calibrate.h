#pragma once
#include "apps/run.h"

#include <filesystem>
#include <string>

namespace apps {

/// Options of `mastic calibrate`.
struct CalibrateOptions {
  std::string from = "specimen"; ///< what is to creep as measured: specimen or element
  std::string branches = "auto"; ///< "auto" or a number of Kelvin branches
  std::string shift = "none";    ///< none, wlf, arrhenius or free: of data at several temperatures
  std::string reference;         ///< temperature; empty: the measured one nearest to 20 degC
  double accuracy = 0.02;        ///< auto: the fewest branches whose rms error is at most this [-]
  std::filesystem::path output;  ///< folder; empty: results/NAME-calibration
};

/// Finds the bond law with which the packing of a scene creeps as a measured table says; writes it
/// as a section that a scene can include, with a table of errors over the number of branches; runs
/// the packing with it as a check. \return the exit code
/// \throws std::invalid_argument for a scene or data that cannot be used
int calibrate_verb(const std::string& scene, const std::filesystem::path& data,
                   const CalibrateOptions& calibration, const RunOptions& options);

} // namespace apps
