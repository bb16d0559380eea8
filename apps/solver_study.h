#pragma once
#include "apps/solver_ladder.h"

#include <string>
#include <vector>

namespace apps {

/// How a study of solvers was asked for on the command line.
struct SolverStudyOptions {
  LadderOptions ladders;
  std::vector<std::string> overrides;
  std::string reference = "auto"; ///< or a solver
  std::string budget = "300 s";   ///< wall time of a run
  std::string output;             ///< folder; empty: that of the scene's results with "-study"
  std::string packing;            ///< stored packing to use instead of a new one
  int n_threads = 1;              ///< of a run; runs go one at a time
  int n_repetitions = 1;
  bool quiet = false;
};

/// Runs a scene with all solvers at several settings, one run at a time, and says what each costs
/// and how far it is from a reference: a table, study.csv, a figure. Runs that an earlier study of
/// the same scene finished are kept. \return the exit code
int study_verb(const std::string& scene, const SolverStudyOptions& options);

} // namespace apps
