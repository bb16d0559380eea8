#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace apps {

/// Options of `mastic fit`, as the command line gives them.
struct FitOptions {
  std::string form = "series"; ///< series, burgers, power, sigmoid or 2s2p1d
  std::string terms = "auto";  ///< "auto" or a number
  std::string shift = "none";  ///< none, wlf, arrhenius or free
  std::string reference;       ///< temperature; empty: the measured one nearest to 20 degC
  double poisson_ratio = 0.35; ///< of the isotropic law
  bool robust = false;
  int bootstrap = 0; ///< number of samples for intervals of a series; 0: none
  std::uint64_t seed = 1;
  bool plots = true;
  std::filesystem::path output; ///< folder; empty: results/NAME-fit
};

/// Fits a law to a table of a laboratory test; writes law, report, tables and figures into a folder
/// and prints a summary. \return the exit code
/// \throws std::invalid_argument for bad data or options, naming file, line and column
int fit_verb(const std::filesystem::path& file, const FitOptions& options);

} // namespace apps
