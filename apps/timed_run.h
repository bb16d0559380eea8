#pragma once
#include "apps/run.h"
#include "apps/solver_ladder.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace apps {

/// What became of a run of a study.
enum class RunState {
  finished,
  refused,     ///< the solver's assumptions do not hold
  over_budget, ///< ended because it took too long
  not_started, ///< a coarser setting took too long already
  failed,
  interrupted
};

std::string name_of(RunState state);

/// What the runs of a study are made from, and how.
struct TimedRuns {
  const LoadedScene& scene;
  std::filesystem::path folder; ///< each run has a folder of its own in it
  std::optional<std::filesystem::path> packing;
  int n_threads = 1;
  int n_repetitions = 1;
  double budget; ///< wall time that a run may take, start and end included [s]
};

/// A run and what it took.
struct TimedRun {
  RunState state = RunState::not_started;
  std::string message;    ///< why it did not finish
  double solver_time = 0; ///< wall time of the solver, median of the repetitions [s]
  double whole_time = 0;  ///< of the program from its start to its end, too [s]
  int n_repetitions = 0;
  double fraction = 1; ///< of the work done, if it did not finish
  bool kept = false;   ///< from an earlier study
};

/// Tells how far a run is: fraction of its work, state.
using Tell = std::function<void(double, const std::string&)>;

/// Runs a rung in a process of its own, as often as is asked for. What the same program has
/// finished before, from the same scene on the same machine, is kept.
TimedRun run_timed(const Rung& rung, const TimedRuns& runs, const Tell& tell);

} // namespace apps
