#pragma once
#include "apps/run.h"

#include <string>

namespace apps {

/// Runs all scenes of a folder that say what they expect, each as a process of its own with a time
/// limit, and prints a table of what was expected and found. The table is also written as hard.csv
/// and hard.md into results/hard.
/// \param folder   empty: the hard cases that come with the program
/// \param options  overrides and number of threads for all of them
/// \return the exit code: not 0 if one is not met
int run_hard_cases(const std::string& folder, const RunOptions& options);

} // namespace apps
