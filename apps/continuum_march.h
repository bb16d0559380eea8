#pragma once
#include "apps/continuum_progress.h"
#include "apps/progress.h"

namespace apps {

/// Whether the test is over before its time: the body has come apart, or strained as far as asked.
template <int dim>
bool has_ended(const ContinuumInProgress<dim>& run);

/// Who looks at a run between its steps.
struct Watch {
  Progress& progress;
  const std::filesystem::path& folder;
  double last_checkpoint = 0;
};

/// The history up to a stop, and the jump of the load there; to the end of the test at most.
/// \return false if it was interrupted
template <int dim>
bool advance(ContinuumInProgress<dim>& run, double stop, Watch& watch, double fraction);

} // namespace apps
