#pragma once
#include "apps/specimen_run.h"

namespace apps {

/// An intact specimen with proportional laws: known in closed form at all times.
/// \param rate_law  says over which time the strain rate is averaged
std::unique_ptr<SpecimenRun> make_linear_run(const dem::Assembly& assembly,
                                             const dem::Loading& loading,
                                             const dem::RateLaw& rate_law, double strain_limit);

} // namespace apps
