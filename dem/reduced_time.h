#pragma once
#include "dem/temperature_shift.h"

#include <span>
#include <vector>

namespace dem {

/// Temperature at a time; two points at one time make a jump.
struct TemperaturePoint {
  double time;        ///< [s]
  double temperature; ///< [K]
};

/// Time as a binder feels it whose temperature changes: xi(t) = integral of dt / a_T(T(t)) from 0.
///
/// All viscosities are multiplied by a_T, so in reduced time a thermorheologically simple law is
/// what it is at the reference temperature. The temperature is linear between its points and
/// constant before the first and after the last. Make one with `make_reduced_time`.
struct ReducedTime {
  /// Start of a piece of time in which the temperature is linear and a_T changes little.
  struct Piece {
    double time;        ///< [s]
    double temperature; ///< just after that time [K]
    double slope;       ///< of the temperature [K/s]
    double reduced;     ///< reduced time up to there [s]
  };
  TemperatureShift shift;
  std::vector<Piece> pieces; ///< the first begins at time 0, the last never ends
};

/// \throws std::invalid_argument if there is no point, if times decrease or are negative, or if the
///         shift law does not reach one of the temperatures
ReducedTime make_reduced_time(std::span<const TemperaturePoint> points,
                              const TemperatureShift& shift);

/// Temperature [K] just after a time [s].
double temperature(const ReducedTime& history, double time);

/// a_T [-] just after a time [s].
double shift_factor(const ReducedTime& history, double time);

/// Reduced time that passes between two times >= 0 [s]; negative if they are in reverse order.
///
/// Gauss quadrature of the law itself on each piece: relative error below 1e-13, also for short
/// spans late in a long history.
double reduced_duration(const ReducedTime& history, double from, double to);

/// xi(t) [s] at a time >= 0, with the same accuracy.
double reduced_time(const ReducedTime& history, double time);

} // namespace dem
