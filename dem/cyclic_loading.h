#pragma once
#include "dem/loading.h"

namespace dem {

/// Equal pulses of a force on the platen, one after the other, each followed by a rest.
///
/// Curved pulses become straight lines between `n_intervals` + 1 points on the curve, evenly spaced
/// in time. Between the points the line is off the curve by at most (pi / n_intervals)^2 / 4 of the
/// amplitude for a haversine, twice that for a sine: 1.0 % and 1.9 % with 16 intervals. The
/// integral over a pulse, and with it what the dashpots keep of it, is that of the curve.
struct CyclicLoad {
  enum class Pulse {
    haversine, ///< base + amplitude sin^2(pi t / loading_time)
    block,     ///< base + amplitude
    sine       ///< base + amplitude sin(2 pi t / loading_time)
  };
  Pulse pulse;
  double base;         ///< value between the pulses, or mean of a sine [N]
  double amplitude;    ///< largest difference from the base [N]
  double loading_time; ///< of a pulse, or period of a sine [s]
  double rest_time;    ///< after each pulse [s]; > 0 for blocks, which would be one otherwise
  long n_cycles;       ///< >= 1
  long n_intervals;    ///< of a curved pulse: a multiple of 4, so that extremes are points
};

/// Duration of a pulse and its rest [s].
inline double period(const CyclicLoad& load)
{
  return load.loading_time + load.rest_time;
}

/// End of a cycle [s], the first being cycle 1; the start of the next one to the last bit.
inline double cycle_end(const CyclicLoad& load, long cycle)
{
  return double(cycle) * period(load);
}

/// The pulses as points in time, from time 0.
/// \throws std::invalid_argument naming the number that cannot be
Loading cyclic_loading(const CyclicLoad& load);

} // namespace dem
