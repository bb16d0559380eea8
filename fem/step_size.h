#pragma once
#include <algorithm>
#include <cmath>

namespace fem {

/// How time steps are chosen.
struct StepSettings {
  double tolerance = 1e-4;   ///< estimated error of a step over the strain or stress [-]
  double first_step = 1e-3;  ///< after a jump [s]
  double largest_growth = 3; ///< of a step over the one before
};

/// Share of a step at which its estimated error, of third order, would be just below the tolerance.
inline double step_factor(double error, const StepSettings& settings)
{
  return error > 0 ? 0.9 * std::cbrt(settings.tolerance / error) : settings.largest_growth;
}

/// The step after one that was accepted, and the one to try again after one that was not.
inline double next_step(double step, double error, const StepSettings& settings)
{
  return step * std::clamp(step_factor(error, settings), 0.3, settings.largest_growth);
}
inline double smaller_step(double step, double error, const StepSettings& settings)
{
  return step * std::clamp(step_factor(error, settings), 0.1, 0.7);
}

/// A step that was meant, made to meet a stop: the whole way if it reaches it, half of the way
/// rather than leave a small rest.
inline double step_within(double step, double way)
{
  if (step >= way * (1 - 1e-12))
    return way;
  return step > way / 2 ? way / 2 : step;
}

} // namespace fem
