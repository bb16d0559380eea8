#pragma once
#include "apps/specimen_run.h"

namespace apps {

/// A run that begins with the event solver and goes on with the quasi-static one from the exact
/// state when the strain passes the scene's `Small strain`.
std::unique_ptr<SpecimenRun> make_climbing_run(const Scene& scene, const dem::Assembly& assembly,
                                               const dem::Loading& loading, int n_threads);

} // namespace apps
