#pragma once
#include <span>
#include <vector>

namespace dem {

/// Value of a load at a time; two points at one time make a jump.
struct LoadPoint {
  double time;  ///< [s]
  double value; ///< force [N], displacement [m] or load factor [-]
};

/// What is prescribed over time, piecewise linear.
///
/// Tension positive: the compressive creep load is a negative force on the upper platen.
struct Loading {
  enum class Control {
    force,       ///< force on the upper platen [N], or factor on the loads of particles [-]
    displacement ///< displacement of the upper platen [m]
  };
  Control control = Control::force;
  std::vector<LoadPoint> points;
  /// The force is that on the nominal area and follows the area of a specimen that keeps its
  /// volume: force = value / (1 + strain) with the strain tension positive. Control by force only.
  bool true_stress = false;
};

/// Loads that users name, as points. Values as in `Loading`.
Loading step_load(Loading::Control control, double value, double end_time);
Loading step_and_release(double force, double release_time, double end_time);
Loading ramp(Loading::Control control, double rate, double end_time);

/// Value at a time [s]; after a jump at a jump. The last value holds for ever.
double load_value(const Loading& loading, double time);

/// Slope [1/s] just after a time.
double load_rate(const Loading& loading, double time);

/// Mean value over the time span that ends at a time; the load is 0 before its first point.
double mean_load(const Loading& loading, double time, double span);

/// Time of the last jump at or before a time; the first point counts as one unless its value is 0.
/// Minus infinity if there was none.
double last_jump(const Loading& loading, double time);

/// First breakpoint after a time, or infinity.
double next_breakpoint(const Loading& loading, double time);

double end_time(const Loading& loading);

/// \throws std::invalid_argument if times are negative, not increasing, or fewer than two points
///         are given, or if a value is not a finite number
void validate(const Loading& loading);

} // namespace dem
