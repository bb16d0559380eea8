#include "apps/events_run.h"

#include "apps/equations_text.h"
#include "apps/stopwatch.h"
#include "dem/storage.h"

#include <fmt/format.h>

namespace apps {

void EventsRun::work_towards(double time)
{
  const Stopwatch watch;
  for (; !ended() && !reached(time) && watch.seconds() < work_slice; ++n_steps_)
    state_ = solver_.step(std::move(state_));
}

Snapshot EventsRun::snapshot(double time) const
{
  return network_snapshot(model_.network, time, state_.damage.status,
                          solver_.displacements(state_, time),
                          solver_.elastic_displacements(state_, time));
}

void EventsRun::save(dem::Hdf5File& file) const
{
  dem::write_state(file, "state", state_);
}

void EventsRun::load(const dem::Hdf5File& file)
{
  state_ = dem::read_events_state(file, "state", model_);
  solver_.resume(state_);
}

std::string EventsRun::statistics() const
{
  const auto& s = solver_.network_solver().statistics();
  return fmt::format("{}, {} updates by a broken bond or opened contact, energy in regularising "
                     "springs {:.1e}",
                     equations_text(model_.network, s), s.n_updates, state_.largest_ground_share);
}

Counts EventsRun::counts() const
{
  const auto& s = solver_.network_solver().statistics();
  return {{"unknowns", double(model_.network.n_dofs)},
          {"steps", double(n_steps_)},
          {"solves", double(s.n_factorisations + s.n_updates + s.n_refinements)},
          {"factorisations", double(s.n_factorisations)}};
}

} // namespace apps
