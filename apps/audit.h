#pragma once
#include "apps/run.h"

namespace apps {

/// Compares an explicit run with the event or linear solver on the same scene, where these apply,
/// and prints the error that viscosity scaling, inertia and damping cause. The comparison is also
/// written as audit.csv.
void print_scaling_audit(const RunInProgress& run, const std::filesystem::path& folder);

} // namespace apps
