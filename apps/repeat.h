#pragma once
#include "apps/run_checks.h"

namespace apps {

/// Makes the run again as the section Repeat says, in child processes with the folder `repeat` in
/// that of the results, and compares.
/// \throws std::runtime_error if the second run fails
std::vector<Check> check_repetition(const RunInProgress& run, const std::filesystem::path& folder,
                                    const RunOptions& options);

} // namespace apps
