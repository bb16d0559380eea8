#include "fem/mandel.h"

#include <array>
#include <numbers>

namespace fem {

namespace {

constexpr double root2 = std::numbers::sqrt2;
constexpr std::array<int, 6> row{0, 1, 2, 1, 0, 0}, column{0, 1, 2, 2, 2, 1};

/// 1, 1, 1, sqrt2, sqrt2, sqrt2.
Vec6 shear_weight()
{
  return {1, 1, 1, root2, root2, root2};
}

Mat6 scaled(const Mat6& matrix, const Vec6& weight)
{
  return weight.asDiagonal() * matrix * weight.asDiagonal();
}

} // namespace

Vec6 mandel_vector(const Mat3& tensor)
{
  Vec6 result;
  for (std::size_t i = 0; i < 6; ++i)
    result[Eigen::Index(i)] =
        0.5 * (tensor(row[i], column[i]) + tensor(column[i], row[i])) * (i < 3 ? 1 : root2);
  return result;
}

Mat3 tensor(const Vec6& mandel)
{
  Mat3 result;
  for (std::size_t i = 0; i < 6; ++i)
    result(row[i], column[i]) = result(column[i], row[i]) =
        mandel[Eigen::Index(i)] / (i < 3 ? 1 : root2);
  return result;
}

Vec6 mandel_stress_from_voigt(const Vec6& stress)
{
  return stress.cwiseProduct(shear_weight());
}

Vec6 tensor_components(const Vec6& mandel)
{
  return mandel.cwiseQuotient(shear_weight());
}

Vec6 mandel_strain_from_voigt(const Vec6& strain)
{
  return strain.cwiseQuotient(shear_weight());
}

Vec6 voigt_strain(const Vec6& strain)
{
  return strain.cwiseProduct(shear_weight());
}

Mat6 mandel_compliance_from_voigt(const Mat6& compliance)
{
  return scaled(compliance, shear_weight().cwiseInverse());
}

Mat6 voigt_compliance(const Mat6& compliance)
{
  return scaled(compliance, shear_weight());
}

Mat6 mandel_stiffness_from_voigt(const Mat6& stiffness)
{
  return scaled(stiffness, shear_weight());
}

Mat6 voigt_stiffness(const Mat6& stiffness)
{
  return scaled(stiffness, shear_weight().cwiseInverse());
}

Mat6 mandel_rotation(const Mat3& rotation)
{
  Mat6 result;
  for (Eigen::Index i = 0; i < 6; ++i)
    result.col(i) = mandel_vector(rotation * tensor(Vec6::Unit(i)) * rotation.transpose());
  return result;
}

Mat6 rotated(const Mat6& matrix, const Mat3& rotation)
{
  const Mat6 turn = mandel_rotation(rotation);
  return turn * matrix * turn.transpose();
}

} // namespace fem
