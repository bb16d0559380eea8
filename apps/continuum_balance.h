#pragma once
#include "apps/continuum_progress.h"

#include <string>

namespace apps {

/// Shares the cells out over the ranks anew, with all that has happened to them, if the ranks'
/// costs differ by the ratio that the scene names and what that cost so far is more than the
/// sharing will. All ranks take part; nothing on a single one, or where no point breaks.
template <int dim>
void balance(ContinuumInProgress<dim>& run);

/// What it did, as a line for users; all ranks take part. Empty where it does nothing.
template <int dim>
std::string balance_summary(ContinuumInProgress<dim>& run);

} // namespace apps
