#pragma once
#include "apps/work_precision.h"

#include <optional>
#include <vector>

namespace apps {

/// The reference of a study among the solvers that are exact for small displacements, by what they
/// found: `linear` if no bond breaks, else `events`; nothing if neither applies or the
/// displacements are not small.
std::optional<StudyReference> exact_reference(const std::vector<StudyRow>& rows,
                                              const LoadedScene& scene);

/// The implicit solver at its finest as the reference.
StudyReference finest_reference(const LoadedScene& scene);

/// A solver that the user names as the reference: its most exact rung that finished.
std::optional<StudyReference> named_reference(const std::vector<StudyRow>& rows,
                                              const std::string& solver);

/// Largest strain of a run over its history, or largest displacement over the size of the
/// specimen [-].
double largest_motion(const dem::Hdf5File& result);

} // namespace apps
