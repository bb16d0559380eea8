#pragma once
#include "fem/specimen.h"
#include "fem/step_size.h"

#include <functional>

namespace fem {

/// The history that a body is under.
struct History {
  std::function<LoadState(double time)> load;        ///< at a time; at a jump the value after it
  std::function<LoadState(double time)> load_before; ///< at a jump the value before it
  std::function<double(double time)> reduced_time;   ///< int dt / a_T [s]
};

/// How far a run is, and what it took.
struct MarchState {
  double time = 0;      ///< [s]
  double next_step = 0; ///< [s]; 0 after a jump
  double error_sum = 0; ///< sum of the estimated errors of all steps [-]
  double size =
      0; ///< largest strain or stress so far, which errors are over (a norm over the body)
  long n_changes = 0;     ///< equilibria found anew after points have changed
  bool is_settled = true; ///< or points are still overloaded at the present time
  bool has_lost = false;  ///< equilibrium: changes went on until the body came apart
  long n_steps = 0, n_rejected = 0, n_solves = 0, n_iterations = 0, n_assemblies = 0;
};

/// Equilibria after changes that `apply_jump` and `march_step` find before they return, so that
/// whoever calls them can look up in a long avalanche.
constexpr int most_passes = 20;

/// Applies the loads at the present time at once: the elastic answer to a jump. Points that cannot
/// bear it change, the most loaded first, and equilibrium is found again, until all can
/// (`is_settled`; `march_step` goes on with it), or until there is none or the strain of a point is
/// above 1/2 (`has_lost`; no step must follow).
/// \throws std::runtime_error as Specimen::solve_step
/// \throws RankFailure on all ranks, if the points of one fail; the state is not to be used then
template <int dim>
void apply_jump(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
                const History& history);

/// One accepted step towards a time, and not beyond it; steps whose estimated error is above the
/// tolerance are tried again at a smaller size. A step ends where a point changes; what follows
/// from that at the same instant is done, too. If the state is not settled, nothing but that is.
/// Steps in which a point finds no state of its own are tried smaller, down to a millionth of the
/// way; then equilibrium is lost (`has_lost`).
/// \throws std::runtime_error naming the time, if no step is small enough or one does not converge
/// \throws RankFailure as apply_jump
template <int dim>
void march_step(Specimen<dim>& specimen, MaterialPoints& points, MarchState& state,
                const History& history, const StepSettings& settings, double stop);

} // namespace fem
