#include "dem/quasistatic_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

constexpr int most_passages = 400;
/// Of them, one tries first whether the specimen stands by itself.
constexpr int passages_per_attempt = 4;
constexpr double usual_hold = 1e-3, least_hold = 1e-6, largest_hold = 1e3;
/// Out-of-balance force while more breakages are likely, over that of the settings: what comes next
/// changes the forces more.
constexpr double avalanche_looseness = 100;

/// Each passage may move further than the one before.
double first_hold(double last)
{
  return last > 0 ? std::max(last / 3, least_hold) : usual_hold;
}

double avalanche_tolerance(const QuasistaticSettings& settings)
{
  return settings.breakage_batch > 1
             ? std::min(1e-2, avalanche_looseness * settings.residual_tolerance)
             : settings.residual_tolerance;
}

} // namespace

void QuasistaticSolver::end_if_ruptured(QuasistaticState& state) const
{
  const double gauge = model_->assembly.gauge_length, from = *state.passage_start / gauge,
               to = state.path.back().displacement / gauge;
  if (std::abs(to - from) < model_->settings.passage_limit)
    return;
  state.end = RunEnd::lost_equilibrium;
  state.end_reason =
      fmt::format("rupture at t = {:.6g} s: no equilibrium between {:.4g} % and {:.4g} % of strain",
                  state.time(), 100 * std::abs(from), 100 * std::abs(to));
}

void QuasistaticSolver::pass_through(QuasistaticState& state, double duration,
                                     const Equilibrium& failed)
{
  ++state.n_passages;
  if (!state.passage_start)
    state.passage_start = state.path.back().displacement;
  if (++state.passages_in_a_row <= most_passages)
    for (double hold = first_hold(state.passage_hold); hold < largest_hold; hold *= 10) {
      Trial trial = attempt(state, duration, hold, avalanche_tolerance(model_->settings));
      if (!trial.equilibrium.found)
        continue;
      state.passage_hold = hold;
      take(state, std::move(trial), duration == 0);
      state.settled = false;
      end_if_ruptured(state);
      return;
    }
  state.end = RunEnd::lost_equilibrium;
  const Index dof = failed.worst_body;
  std::string place = "the upper platen";
  for (std::size_t i = 0; i + 2 < state.centre.size(); ++i)
    if (model_->dofs.first_dof[i] >= 0 && dof >= model_->dofs.first_dof[i] &&
        dof < model_->dofs.first_dof[i] + 6)
      place =
          fmt::format("particle {} at ({:.4g}, {:.4g}, {:.4g}) mm", i, 1e3 * state.centre[i].x(),
                      1e3 * state.centre[i].y(), 1e3 * state.centre[i].z());
  state.end_reason = fmt::format("no equilibrium was found at t = {:.6g} s; the force is most out "
                                 "of balance at {}",
                                 state.time(), place);
}

void QuasistaticSolver::settle(QuasistaticState& state)
{
  if (state.passages_in_a_row % passages_per_attempt != 0) { // hardly at rest so soon
    pass_through(state, 0, {});
    return;
  }
  Trial trial = attempt(state, 0, 0,
                        state.in_avalanche ? avalanche_tolerance(model_->settings)
                                           : model_->settings.residual_tolerance);
  if (!trial.equilibrium.found) {
    pass_through(state, 0, trial.equilibrium);
    return;
  }
  state.passages_in_a_row = 0;
  take(state, std::move(trial), true);
  if (state.end == RunEnd::running)
    break_bonds(state);
}

} // namespace dem
