#pragma once
#include "apps/stored_study.h"

#include <filesystem>
#include <string>
#include <vector>

namespace apps {

/// The scene files that a scene names in Study/Scene files, with full names; empty if it names
/// none.
std::vector<std::filesystem::path> collected_scenes(const LoadedScene& scene);

/// What is wrong with the scenes of a collection, each checked as it would be run.
std::vector<Diagnostic> check_collection(const std::vector<std::filesystem::path>& scenes,
                                         const std::vector<std::string>& overrides);

/// Runs the scenes of a collection one after the other, each a single run or a study, in folders of
/// their own within that of the collection, and makes a report of all. A scene that fails does not
/// stop the others. With `resume`, what has finished before is kept. \return the exit code
int run_collection(const StoredStudy& collection, const RunOptions& options, bool resume);

} // namespace apps
