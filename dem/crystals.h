#pragma once
#include "dem/volume_element.h"

#include <cmath>
#include <vector>

namespace dem {

/// Equal touching spheres on a lattice: volume elements whose stiffness is known in closed form.
struct Crystal {
  PeriodicCell cell;
  std::vector<Vec3> centre; ///< [m]
};

/// One sphere of this diameter [m], bonded to six of its own images.
inline Crystal simple_cubic(double diameter)
{
  return {box_cell(Vec3::Constant(diameter)), {Vec3::Zero()}};
}

/// Two spheres in a cube, eight contacts each.
inline Crystal body_centred_cubic(double diameter)
{
  const double edge = 2 * diameter / std::sqrt(3.0);
  return {box_cell(Vec3::Constant(edge)), {Vec3::Zero(), Vec3::Constant(edge / 2)}};
}

/// Four spheres in a cube, twelve contacts each.
inline Crystal face_centred_cubic(double diameter)
{
  const double half = diameter / std::sqrt(2.0);
  return {box_cell(Vec3::Constant(2 * half)),
          {Vec3::Zero(), Vec3(0, half, half), Vec3(half, 0, half), Vec3(half, half, 0)}};
}

/// The same crystal as one sphere bonded to twelve of its own images.
inline Crystal primitive_face_centred_cubic(double diameter)
{
  const double half = diameter / std::sqrt(2.0);
  Mat3 edges;
  edges << 0, half, half, half, 0, half, half, half, 0;
  return {make_periodic_cell(edges), {Vec3::Zero()}};
}

/// Hexagonal close packing: two spheres, twelve contacts each; the axis is along z.
inline Crystal hexagonal_close_packed(double diameter)
{
  const double height = diameter * std::sqrt(8.0 / 3.0);
  Mat3 edges;
  edges << diameter, -diameter / 2, 0, 0, std::sqrt(0.75) * diameter, 0, 0, 0, height;
  return {make_periodic_cell(edges),
          {Vec3::Zero(), Vec3(0, diameter / std::sqrt(3.0), height / 2)}};
}

/// n x n x n cells as one.
inline Crystal repeated(const Crystal& crystal, int n)
{
  Crystal result{{double(n) * crystal.cell.edges}, {}};
  for (int c = 0; c < n; ++c)
    for (int b = 0; b < n; ++b)
      for (int a = 0; a < n; ++a)
        for (const Vec3& centre : crystal.centre)
          result.centre.push_back(centre + crystal.cell.translation({a, b, c}));
  return result;
}

/// The spheres, bonded where they touch.
inline VolumeElement bonded_crystal(const Crystal& crystal, double diameter, const BondLaw& law)
{
  const std::size_t n = crystal.centre.size();
  const Particles particles{crystal.centre, std::vector<double>(n, diameter / 2),
                            std::vector<int>(n, 0)};
  return make_volume_element(crystal.cell, particles,
                             periodic_contacts_within(crystal.cell, particles, 1e-6), {law},
                             {{0, 0, 0}});
}

} // namespace dem
