#pragma once
#include <Eigen/Geometry>
#include <cstdint>

/// Bonded spheres: packings, bonds, solvers.
///
/// SI units throughout, angles in radians, tension positive. Functions take state and return
/// state; nothing here prints, reads the clock or keeps global data.
namespace dem {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Index of a particle or of a bond.
using Index = std::int32_t;

} // namespace dem
