#include "fem/march.h"

#include "fem/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace fem {

namespace {

/// What the points of each rank answer; a rank that fails fails on all.
template <int dim, class Ask>
auto answer(const Specimen<dim>& specimen, const Ask& ask)
{
  decltype(ask()) result{};
  together(specimen.elements().ranks(), [&] { result = ask(); });
  return result;
}

/// Solves a step from the present time, and counts what it took.
template <int dim>
void attempt(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
             const LoadState& load, double duration, double reduced_step)
{
  points.begin_step(state.time, duration);
  const StepReport report =
      specimen.solve_step(load, reduced_step, [&](std::span<const Vec6> increment, double step) {
        return answer(specimen, [&] { return points.evaluate(increment, step); });
      });
  state.n_solves += report.n_solves;
  state.n_iterations += report.n_iterations;
  state.n_assemblies += report.assembled;
}

/// The same; false if there is no equilibrium because some point found no state of its own, or
/// because points are not linear in the step, on all ranks alike.
template <int dim>
bool try_step(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
              const LoadState& load, double duration, double reduced_step)
{
  try {
    attempt(specimen, points, state, load, duration, reduced_step);
    return true;
  } catch (const NoEquilibrium&) {
    const int mine = points.has_lost() || !points.are_affine();
    if (dealii::Utilities::MPI::max(mine, specimen.elements().ranks()) == 0)
      throw;
    return false;
  }
}

/// Estimated error of the step that was tried, over the largest size so far, on all ranks [-].
template <int dim>
double step_error(const Specimen<dim>& specimen, const MaterialPoints& points, double& largest)
{
  const StepError own = points.step_error(specimen.elements().weights());
  const MPI_Comm ranks = specimen.elements().ranks();
  const double square = dealii::Utilities::MPI::sum(own.square, ranks);
  const double size = dealii::Utilities::MPI::sum(own.size_square, ranks);
  largest = std::max(largest, std::sqrt(size));
  return largest > 0 ? std::sqrt(square) / largest : 0;
}

constexpr double strain_at_rupture = 0.5;
/// Least step over that which is wanted, where points lose their equilibrium.
constexpr double least_share_found = 1e-6;

double largest_strain(const MaterialPoints& points)
{
  double largest = 0;
  for (const Vec6& strain : points.strain())
    largest = std::max(largest, strain.norm());
  return largest;
}

template <int dim>
void commit(Specimen<dim>& specimen, MaterialPoints& points)
{
  together(specimen.elements().ranks(), [&] { points.commit(); });
  specimen.commit();
}

/// Changes the points that are overloaded, most loaded first, and restores equilibrium, until none
/// is, or so often.
template <int dim>
void settle(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
            const History& history)
{
  const MPI_Comm ranks = specimen.elements().ranks();
  state.is_settled = false;
  points.begin_step(state.time, 0); // after a restart they do not know the time
  for (int pass = 0; pass < most_passes; ++pass) {
    const double overload =
        dealii::Utilities::MPI::max(answer(specimen, [&] { return points.overload(); }), ranks);
    state.is_settled = overload < 1;
    if (state.is_settled)
      return;
    together(ranks, [&] { points.change(overload); });
    ++state.n_changes;
    try {
      attempt(specimen, points, state, history.load(state.time), 0, 0);
    } catch (const RankFailure&) {
      throw;                              // says nothing about the body
    } catch (const std::runtime_error&) { // on all ranks alike
      state.has_lost = true;
      return;
    }
    commit(specimen, points);
    state.has_lost = dealii::Utilities::MPI::max(largest_strain(points), ranks) > strain_at_rupture;
    if (state.has_lost)
      return;
  }
}

/// A step shortened to where the first point changes, if one does within it, and further as long as
/// points find no equilibrium there.
/// \return its duration; 0 if there is none
template <int dim>
double shortened(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
                 const History& history, double step)
{
  const double share = dealii::Utilities::MPI::min(
      answer(specimen, [&] { return points.share_without_change(); }), specimen.elements().ranks());
  if (share >= 1)
    return step;
  const double least = std::nextafter(state.time, std::numeric_limits<double>::max()) - state.time;
  double shorter = std::min(step, std::max(share * step, least));
  const double least_found = least_share_found * shorter;
  for (; shorter >= least_found; shorter *= 0.25) {
    const double end = state.time + shorter;
    if (try_step(specimen, points, state, history.load(end), shorter,
                 history.reduced_time(end) - history.reduced_time(state.time)))
      return shorter;
    ++state.n_rejected;
  }
  return 0;
}

} // namespace

template <int dim>
void apply_jump(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
                const History& history)
{
  state.next_step = 0;
  state.has_lost = !try_step(specimen, points, state, history.load(state.time), 0, 0);
  if (state.has_lost)
    return;
  commit(specimen, points);
  settle(specimen, points, state, history);
}

template <int dim>
void march_step(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
                const History& history, const StepSettings& settings, double stop)
{
  if (!state.is_settled) {
    settle(specimen, points, state, history);
    return;
  }
  constexpr double least_share = 1e-12; // of the way to the stop
  const double way = stop - state.time;
  double h = state.next_step > 0 ? state.next_step : settings.first_step;
  h = step_within(h, way);
  while (true) {
    const bool last = h == way;
    const double end = last ? stop : state.time + h;
    const LoadState load = last ? history.load_before(stop) : history.load(end);
    const bool found = try_step(specimen, points, state, load, h,
                                history.reduced_time(end) - history.reduced_time(state.time));
    if (!found) {
      ++state.n_rejected;
      h *= 0.25;
      state.has_lost = !(h > least_share_found * way);
      if (state.has_lost)
        return;
      continue;
    }
    double size = state.size;
    const double error = step_error(specimen, points, size);
    if (error <= settings.tolerance) {
      const double held = shortened(specimen, points, state, history, h);
      state.has_lost = held == 0;
      if (state.has_lost)
        return;
      commit(specimen, points);
      const bool whole = held == h;
      state.time = whole ? end : state.time + held;
      settle(specimen, points, state, history);
      state.error_sum += error;
      state.size = size;
      ++state.n_steps;
      const double next = next_step(h, error, settings);
      // a step cut short says nothing against the size that was meant
      state.next_step = last || !whole ? std::max(next, std::min(state.next_step, 3 * next)) : next;
      return;
    }
    ++state.n_rejected;
    h = smaller_step(h, error, settings);
    if (!(h > least_share * way))
      throw std::runtime_error(
          fmt::format("at t = {:.6g} s no step is small enough: the estimated error of a step of "
                      "{:.3g} s is {:.3g}, wanted {:.3g}",
                      state.time, h, error, settings.tolerance));
  }
}

template void apply_jump(Specimen<2>&, MaterialPoints&, MarchState&, const History&);
template void apply_jump(Specimen<3>&, MaterialPoints&, MarchState&, const History&);
template void march_step(Specimen<2>&, MaterialPoints&, MarchState&, const History&,
                         const StepSettings&, double);
template void march_step(Specimen<3>&, MaterialPoints&, MarchState&, const History&,
                         const StepSettings&, double);

} // namespace fem
