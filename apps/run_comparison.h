#pragma once
#include "dem/hdf5_file.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What of a finished run is compared with another: what the specimen answers to its load.
struct RunCurve {
  std::string quantity;      ///< "strain", "stress" if the strain is prescribed, "displacement"
  std::vector<double> time;  ///< the stated times that were reached [s]
  std::vector<double> value; ///< of the quantity, in its laboratory unit
  std::vector<double> n_broken;
  std::optional<double> rupture_time; ///< lost equilibrium, or strain limit under a load [s]
};

/// Reads it from a result. The row that an early end adds to the history is at no stated time, and
/// left out.
RunCurve read_run_curve(const dem::Hdf5File& result);

/// A column at a time: its value if the time is one of the rows, else between two rows; beyond them
/// the first or the last.
double value_at(const std::vector<double>& times, const std::vector<double>& values, double time);

/// Which of two runs rupture.
enum class Ruptures { neither, both, only_run, only_reference };

/// How far a run is from a reference. Empty where there is nothing to compare.
struct RunErrors {
  double last_time = 0;          ///< last stated time that both reached [s]
  std::optional<double> largest; ///< difference up to there, over the reference's largest value
  std::optional<double> at_end;  ///< difference there, over the reference's value there
  std::optional<double> broken;  ///< of the number of broken bonds there, over the reference's
  std::optional<double> rupture; ///< of the rupture time, over the reference's, if both rupture
  Ruptures ruptures = Ruptures::neither;
};

/// Compares at the reference's stated times, without the instants at which the load jumps (the
/// first, and those that the history has on both sides): values have no meaning there within a run
/// that spreads the jump. A run that stops a little beyond the stated times is interpolated.
RunErrors compare(const RunCurve& run, const RunCurve& reference);

} // namespace apps
