#pragma once
#include <optional>
#include <vector>

namespace fem {

/// What a laboratory test or a virtual one measures over time or frequency.
enum class Quantity {
  creep_compliance,   ///< D(t) [1/Pa]
  relaxation_modulus, ///< E(t) [Pa]
  dynamic_modulus     ///< |E*| [Pa] and, if measured, the phase angle
};

/// One measured point.
struct Measurement {
  double at;                   ///< time [s] or frequency [Hz], > 0
  double value;                ///< of the quantity, > 0
  std::optional<double> phase; ///< phase angle of E* [rad]
  double temperature = 293.15; ///< [K]
  double weight = 1;           ///< of its squared relative error
};

/// A test, at one temperature or several. Either all points have a phase angle or none.
struct Measurements {
  Quantity quantity = Quantity::creep_compliance;
  std::vector<Measurement> points;
};

} // namespace fem
