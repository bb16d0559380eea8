#pragma once
#include "apps/run_comparison.h"
#include "apps/solver_ladder.h"
#include "apps/timed_run.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A rung of a study: what it took, what it did, and how far it is from the reference.
struct StudyRow {
  Rung rung;
  TimedRun run;
  std::optional<RunCurve> curve; ///< if it finished
  RunErrors errors;
  std::map<std::string, double> counts; ///< unknowns, bonds, steps, solves, factorisations
  double motion = 0; ///< largest strain, or displacement over the specimen's size [-]
  bool is_reference = false;
};

/// What the errors of a study are measured against.
struct StudyReference {
  Rung rung;
  std::string reason;             ///< why it, and how exact it is
  std::optional<double> left_out; ///< size of what it leaves out, relative, if it does [-]
};

/// Where and with what a study was made.
struct StudyProvenance {
  std::string scene, machine;
  int n_threads;
};

/// The accuracies for which the cheapest setting is named [-].
const std::vector<double> accuracies{0.1, 0.01, 0.001};

/// True if a run meets an accuracy: in the quantity compared at all times, in whether the specimen
/// ruptures, and in when.
bool meets(const StudyRow& row, double accuracy);

/// The finished row with the least wall time of the solver among those that meet an accuracy.
const StudyRow* cheapest(const std::vector<StudyRow>& rows, double accuracy);

/// Sets the errors of all finished rows against the one that is the reference.
void measure_errors(std::vector<StudyRow>& rows, const Rung& reference);

/// The table as users read it on the screen, with the rungs that have no numbers below it.
std::string study_table(const std::vector<StudyRow>& rows);

/// "within 1 %: events, 7.4 s" for each accuracy, one a line.
std::string cheapest_text(const std::vector<StudyRow>& rows);

/// The table as CSV: everything, units in the names of the columns.
std::string study_csv(const std::vector<StudyRow>& rows, const StudyReference& reference,
                      const StudyProvenance& provenance);

} // namespace apps
