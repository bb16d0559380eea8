#pragma once
#include "dem/strength.h"
#include "fem/material_points.h"

#include <vector>

namespace coupling {

/// What has become of a point that is a volume of bonded spheres.
struct PointDamage {
  bool is_live = false;      ///< it is not on the law of its intact volume any more
  double broken_share = 0;   ///< of its bonds [-]
  double stiffness_loss = 0; ///< of the trace of its elastic stiffness [-]
  double since = 0;          ///< first change [s]
};

/// Points of a body each of which is a volume of bonded spheres that can break. Two kinds: those
/// whose bonds share one law and that move little (VolumePoints), and those that the quasi-static
/// solver follows (QuasistaticPoints).
class BreakingPoints : public fem::MaterialPoints {
public:
  virtual std::size_t n_live() const = 0;   ///< points that are not on their law
  virtual std::size_t n_broken() const = 0; ///< bonds that are not intact, of all points
  virtual std::size_t n_bonds() const = 0;  ///< of all points
  virtual std::size_t n_failed() const = 0; ///< points whose volume hangs together no more

  virtual PointDamage damage(std::size_t point) const = 0;

  /// Whether the volume of a point found no equilibrium in the last trial step.
  virtual bool is_lost(std::size_t /*point*/) const { return false; }

  /// Largest force over present strength among the bonds of a point [-]; at 1 one breaks.
  virtual double strength_use(std::size_t point) const = 0;

  /// The largest of all points; where many are to be looked at, of those that may have it.
  virtual double largest_strength_use() const = 0;

protected:
  BreakingPoints() = default;
  BreakingPoints(const BreakingPoints&) = default;
  BreakingPoints& operator=(const BreakingPoints&) = default;
};

/// Overload of a bond without strength.
constexpr double without_strength = 1e300;

/// Overload from which on bonds break together with the most loaded one: within the tolerance of
/// it, or, far beyond the strength, where its logarithm is down by ten times the tolerance.
double least_overload(double largest, double tolerance);

/// Largest absolute principal value.
double largest_principal(const fem::Vec6& strain);

} // namespace coupling
