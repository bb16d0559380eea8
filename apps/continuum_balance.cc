#include "apps/continuum_balance.h"

#include "apps/continuum_steps.h"
#include "fem/balance.h"
#include "fem/processor_time.h"

#include <fmt/format.h>

namespace apps {

namespace {

template <int dim>
bool can_balance(const ContinuumInProgress<dim>& run)
{
  return run.ranks.number() > 1 && breaks(run.scene.scene->continuum);
}

/// The body goes on as it was, on other ranks.
template <int dim>
void move(ContinuumInProgress<dim>& run, const std::vector<int>& rank_of_cell)
{
  const double drive = run.specimen->drive_displacement(), force = run.specimen->drive_force();
  const double step = run.points->last_step();
  const auto states =
      fem::move_cells(run.mesh, rank_of_cell, fem::cell_states(*run.specimen, *run.points));
  make_body(run);
  fem::restore_cell_states(*run.specimen, *run.points, states, drive);
  run.specimen->set_drive_force(force);
  run.points->set_last_step(step);
}

} // namespace

template <int dim>
void balance(ContinuumInProgress<dim>& run)
{
  RankCosts& costs = run.costs;
  const double limit = run.scene.scene->continuum.volumes.balance;
  if (!can_balance(run) || !costs.is_due(run.points->costs(), run.ranks))
    return;
  costs.look(run.points->costs(), run.specimen->elements().n_cells(), run.ranks);
  const double now = costs.imbalance();
  if (limit == 0 || now < limit || costs.waited() < costs.price())
    return;
  const double start = fem::processor_time();
  const fem::Sharing sharing = fem::new_sharing(run.mesh, costs.of_cells());
  if (saving(costs.waited(), now, sharing.imbalance) < costs.price())
    return;
  costs.count_sharing();
  say(run.ranks, fmt::format("  t = {:.6g} s: cells shared out anew; largest over mean cost of the "
                             "ranks {:.2f}, {:.2f} expected",
                             run.march.time, now, sharing.imbalance));
  move(run, sharing.rank_of_cell);
  costs.begin(fem::processor_time() - start, run.ranks);
}

template <int dim>
std::string balance_summary(ContinuumInProgress<dim>& run)
{
  if (!can_balance(run))
    return "";
  run.costs.look(run.points->costs(), run.specimen->elements().n_cells(), run.ranks);
  return run.costs.summary();
}

template void balance(ContinuumInProgress<2>&);
template void balance(ContinuumInProgress<3>&);
template std::string balance_summary(ContinuumInProgress<2>&);
template std::string balance_summary(ContinuumInProgress<3>&);

} // namespace apps
