#pragma once
#include "apps/measured.h"
#include "apps/scene.h"
#include "apps/specimen.h"
#include "apps/specimen_run.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Exit codes of the program.
enum ExitCode {
  exit_ok = 0,
  exit_not_met = 1,         ///< the run came to its end, but not as its section Expect says
  exit_input = 2,           ///< something in the input
  exit_failure = 3,         ///< a computation or a file operation failed
  exit_interrupted = 4,     ///< stopped with a checkpoint
  exit_lost_equilibrium = 5 ///< the specimen ruptured: no equilibrium any more
};

/// How a run was asked for on the command line.
struct RunOptions {
  std::vector<std::string> overrides;
  std::optional<std::filesystem::path> packing; ///< stored packing to use instead of a new one
  int n_threads = 1; ///< of the explicit solver; runs at a time in a study
  bool quiet = false;
  bool for_parent = false; ///< progress in lines for a study
  bool unchecked = false;  ///< without the sections Expect and Repeat
};

/// A run that can be interrupted: what it is made of and how far it is.
struct RunInProgress {
  LoadedScene scene;
  Packing packing;
  Specimen specimen;
  dem::Loading loading;
  SolverDecision decision;
  std::unique_ptr<SpecimenRun> run;
  RunRecord record;
  MeasuredCurve measured;        ///< to be compared with; read before the run
  std::size_t n_recorded = 0;    ///< times of history and snapshots that are done
  std::string files_fingerprint; ///< of the particle and bond files, when they were read
  double wall_time_before = 0; ///< of the solver's preparation and of earlier parts of the run [s]
  int n_threads = 1;
  std::vector<std::string> log; ///< what was said
};

/// Folder for the results of a scene.
std::filesystem::path result_folder(const LoadedScene& scene);

/// Makes specimen, loading and solver of a scene and its packing; says what they are.
/// \throws std::invalid_argument if they do not go together
void start_run(RunInProgress& run, const RunOptions& options);

/// Prints diagnostics: errors and warnings to standard error.
void print_diagnostics(const std::vector<Diagnostic>& diagnostics);

/// Runs one scene to its end and writes the results. \return the exit code
int run_scene(LoadedScene scene, const RunOptions& options);

/// Goes on from a checkpoint.
int resume_run(const std::filesystem::path& checkpoint, const RunOptions& options);

/// Writes everything that a finished run leaves: result.h5, CSV tables, ParaView files, figures.
void write_results(const RunInProgress& run, const std::filesystem::path& folder, double wall_time);

std::string name_of(dem::RunEnd end);

} // namespace apps
