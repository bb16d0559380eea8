#pragma once
#include "apps/specimen_run.h"
#include "dem/quasistatic.h"

namespace apps {

/// A run of the quasi-static solver.
std::unique_ptr<SpecimenRun> make_quasistatic_run(const dem::QuasistaticModel& model,
                                                  int n_threads);

} // namespace apps
