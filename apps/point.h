#pragma once
#include <string>

namespace apps {

/// How a point of a material is driven.
struct PointOptions {
  std::string law, history; ///< files
  std::string temperature;  ///< such as "20 degC"; empty: the law's reference temperature
  double tolerance = 1e-6;  ///< of a time step [-]
  std::string output;       ///< file; empty: standard output
};

/// Prints strain and stress of one material point under a history, tension positive.
/// \return the exit code
int point_verb(const PointOptions& options);

} // namespace apps
