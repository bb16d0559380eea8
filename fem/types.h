#pragma once
#include <Eigen/Core>

#include <complex>

/// Laws and specimens of creeping continua.
///
/// Units inside are SI: s, Pa, 1/Pa, rad/s; tension is positive. Symmetric tensors are 6-vectors
/// and fourth-order tensors 6x6 matrices in Mandel notation (see fem/mandel.h).
namespace fem {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using ComplexMat6 = Eigen::Matrix<std::complex<double>, 6, 6>;

} // namespace fem
