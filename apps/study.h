#pragma once
#include "apps/run.h"
#include "apps/study_factors.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace apps {

/// Up to so many runs each is told of and drawn in full; of more, the study as a whole is.
constexpr std::size_t most_in_full = 8;

/// The runs of a scene with a section Study; empty if it describes a single run.
std::vector<StudyRun> study_runs(const Scene& scene);

/// Names of the runs of a study and their exit codes, from the runs.csv in its folder; -1: not
/// started. Empty without that file.
std::map<std::string, int> listed_runs(const std::filesystem::path& folder);

/// What is wrong with the runs of a study, each checked as a scene of its own.
std::vector<Diagnostic> check_study_runs(const std::filesystem::path& scene_file,
                                         const std::vector<std::string>& overrides,
                                         const std::vector<StudyRun>& runs);

/// Runs a study: each run in a process and a folder of its own, as many at a time as there are
/// threads, and figures of all runs together. Runs that have finished before are kept when it is
/// resumed. \return the exit code
int run_study(LoadedScene scene, const RunOptions& options, bool resume);

} // namespace apps
