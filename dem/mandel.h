#pragma once
#include "dem/types.h"

#include <array>
#include <numbers>

namespace dem {

/// Components of a symmetric second-order tensor as vectors in Mandel notation: 11, 22, 33, 23, 13,
/// 12, with the shears times the square root of 2. Norms and eigenvalues of fourth-order tensors
/// are those of their 6 x 6 matrices.
constexpr std::array<std::array<int, 2>, 6> mandel_axes{
    {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};

/// The symmetric part of a tensor.
inline Vec6 to_mandel(const Mat3& tensor)
{
  Vec6 result;
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = mandel_axes[k];
    result[k] = i == j ? tensor(i, i) : (tensor(i, j) + tensor(j, i)) / std::numbers::sqrt2;
  }
  return result;
}

inline Mat3 from_mandel(const Vec6& vector)
{
  Mat3 result;
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = mandel_axes[k];
    result(i, j) = result(j, i) = i == j ? vector[k] : vector[k] / std::numbers::sqrt2;
  }
  return result;
}

/// Matrix of a rotation of axes: the vector of Q T Q^T is mandel_rotation(Q) times that of T.
inline Mat6 mandel_rotation(const Mat3& rotation)
{
  Mat6 result;
  for (int k = 0; k < 6; ++k)
    result.col(k) = to_mandel(rotation * from_mandel(Vec6::Unit(k)) * rotation.transpose());
  return result;
}

} // namespace dem
