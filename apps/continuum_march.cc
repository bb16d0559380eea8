#include "apps/continuum_march.h"

#include "apps/continuum_balance.h"
#include "apps/continuum_steps.h"
#include "apps/interrupt.h"

#include <fmt/format.h>

#include <cmath>

namespace apps {

template <int dim>
bool has_ended(const ContinuumInProgress<dim>& run)
{
  return run.march.has_lost ||
         (run.volumes && run.face.platen &&
          std::abs(motion(run)) >= run.scene.scene->load.strain_limit * run.face.length);
}

namespace {

/// Shows how far a run is and stores it when it is time to.
/// \return false if it is to stop
template <int dim>
bool look_up(const ContinuumInProgress<dim>& run, Watch& watch, double fraction)
{
  watch.progress.update(
      fraction, fmt::format("t = {:.4g} s, {} steps{}", run.march.time, run.march.n_steps,
                            run.march.n_changes > 0
                                ? fmt::format(", {} times after breakages", run.march.n_changes)
                                : ""));
  const double now = watch.progress.seconds();
  const bool due = now - watch.last_checkpoint > run.scene.scene->output.checkpoint_interval;
  const bool stopped = run.ranks.any(interrupted());
  if (has_ended(run))
    return true;
  if (stopped || run.ranks.any(due)) {
    watch.last_checkpoint = now;
    write_continuum_checkpoint(run, watch.folder);
  }
  return !stopped;
}

/// One step, or more of what breaks at an instant.
template <int dim>
void step(ContinuumInProgress<dim>& run, double to)
{
  balance(run);
  const ContinuumInput& v = run.scene.scene->continuum;
  const fem::StepSettings settings{v.step_tolerance, v.first_step, 3};
  if (run.march.is_settled) {
    run.last_time = run.march.time;
    run.last_motion = motion(run);
  }
  const long n_changes = run.march.n_changes;
  fem::march_step(*run.specimen, *run.points, run.march, run.history, settings, to);
  if (run.march.n_changes > n_changes && run.specimen->supports().driven)
    run.elastic_compliance = 1 / run.specimen->drive_stiffness(); // of the jump after it
}

} // namespace

template <int dim>
bool advance(ContinuumInProgress<dim>& run, double stop, Watch& watch, double fraction)
{
  const bool jump = dem::last_jump(run.loading, stop) == stop || stop == run.loading.points[0].time;
  const double to = jump ? std::nextafter(stop, 0.) : stop;
  const auto goes_on = [&] { return !has_ended(run); };
  while (goes_on() && (run.march.time < to || !run.march.is_settled)) {
    step(run, to);
    if (!look_up(run, watch, fraction))
      return false;
  }
  if (!jump || !goes_on() || run.march.time > stop || run.n_jumped > run.n_recorded)
    return true;
  run.march.time = stop;
  fem::apply_jump(*run.specimen, *run.points, run.march, run.history);
  run.n_jumped = run.n_recorded + 1;
  if (run.specimen->supports().driven)
    run.elastic_compliance = 1 / run.specimen->drive_stiffness();
  while (goes_on() && !run.march.is_settled) {
    step(run, stop);
    if (!look_up(run, watch, fraction))
      return false;
  }
  return true;
}

template bool has_ended(const ContinuumInProgress<2>&);
template bool has_ended(const ContinuumInProgress<3>&);
template bool advance(ContinuumInProgress<2>&, double, Watch&, double);
template bool advance(ContinuumInProgress<3>&, double, Watch&, double);

} // namespace apps
