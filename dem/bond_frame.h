#pragma once
#include "dem/types.h"

#include <cmath>

namespace dem {

/// Axes of a bond: normal from the first centre to the second, and one tangent.
struct BondFrame {
  Vec3 normal;
  Vec3 tangent;

  Vec3 second_tangent() const { return normal.cross(tangent); }
};

/// Half-tangent vector of a rotation: axis times tan(angle / 2). Not finite at 180 degrees.
inline Vec3 half_tangent(const Vec3& rotation)
{
  const double angle = rotation.norm();
  return angle == 0 ? Vec3(Vec3::Zero()) : Vec3(rotation * (std::tan(0.5 * angle) / angle));
}

/// The frame after its bond has turned to a new normal while its two spheres turned, in the mean,
/// by a rotation with this half-tangent vector.
///
/// The tangent follows the shortest rotation between the normals and then the twist of the mean
/// rotation about the normal (swing-twist decomposition). For a rigid rotation of the pair that is
/// exact for any angle below 180 degrees between the normals; lengths and right angles are kept.
inline BondFrame carried(const BondFrame& frame, const Vec3& mean_half_tangent,
                         const Vec3& new_normal)
{
  const double twist = mean_half_tangent.dot(frame.normal); // tan of half the twist
  const Vec3 swung = frame.tangent - frame.tangent.dot(new_normal) /
                                         (1 + frame.normal.dot(new_normal)) *
                                         (frame.normal + new_normal);
  const double squared = twist * twist;
  // written so that a twist near 180 degrees (twist -> infinity) stays finite
  const double cosine =
      squared < 1 ? (1 - squared) / (1 + squared) : (1 / squared - 1) / (1 / squared + 1);
  const double sine = squared < 1 ? 2 * twist / (1 + squared) : 2 / twist / (1 / squared + 1);
  return {new_normal, cosine * swung + sine * new_normal.cross(swung)};
}

} // namespace dem
