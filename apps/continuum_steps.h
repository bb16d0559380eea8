#pragma once
#include "apps/continuum_progress.h"

namespace apps {

/// Prints a line on the first rank.
void say(const Ranks& ranks, const std::string& line);

/// What is taken as linear in a time step: as the scene says, or by what is prescribed.
fem::TimeScheme scheme_of(const Scene& scene, const dem::Loading& loading);

/// Loads and reduced time over time; the scene must outlive it.
fem::History history_of(const Scene& scene, const dem::Loading& loading, const BodyLaws& laws);

/// Points of the section Probes, then those of its line [m].
std::vector<fem::Vec3> probe_places(const ContinuumInput::Probes& probes);

/// Elements, virgin states and probes for the mesh as it is.
/// \throws std::invalid_argument for cells without a law, and as the parts that it makes
template <int dim>
void make_body(ContinuumInProgress<dim>& run);

/// Refines where the elastic answer to the largest load asks for it.
template <int dim>
void refine_at_start(ContinuumInProgress<dim>& run);

/// Refines in mid-run, and carries the state over.
template <int dim>
void refine_now(ContinuumInProgress<dim>& run);

/// Displacement of the upper platen, or mean displacement along the loads [m].
template <int dim>
double motion(const ContinuumInProgress<dim>& run);

/// Middle of the cell whose points are strained most, of all ranks [m].
template <int dim>
fem::Vec3 most_strained_place(const ContinuumInProgress<dim>& run);

/// Appends the present state to the history and to the readings of the probes.
template <int dim>
void record_history(ContinuumInProgress<dim>& run);

/// Appends to the history the state before the last step, in which the test has come to its end.
template <int dim>
void record_state_before(ContinuumInProgress<dim>& run);

/// Writes the present fields for ParaView, if they are wanted.
template <int dim>
void record_fields(ContinuumInProgress<dim>& run, const std::filesystem::path& folder);

} // namespace apps
