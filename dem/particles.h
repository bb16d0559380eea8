#pragma once
#include "dem/types.h"

#include <numbers>
#include <vector>

namespace dem {

/// Spheres. All arrays have the same length.
struct Particles {
  std::vector<Vec3> centre;        ///< [m]
  std::vector<double> radius;      ///< [m], > 0
  std::vector<int> material_class; ///< chooses the bond law together with the partner's class
  double density = 2700;           ///< [kg/m^3]

  std::size_t size() const { return radius.size(); }
};

/// Volume of a sphere [m^3].
inline double sphere_volume(double radius)
{
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

/// Upright cylinder with its base at z = 0 and its axis at x = y = 0.
struct Cylinder {
  double radius; ///< [m]
  double height; ///< [m]

  double area() const { return std::numbers::pi * radius * radius; }
  double volume() const { return area() * height; }
};

} // namespace dem
