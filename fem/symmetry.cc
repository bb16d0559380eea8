#include "fem/symmetry.h"

#include "fem/mandel.h"

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace fem {

namespace {

using std::numbers::pi;

Mat3 turn(double angle, const Vec3& axis)
{
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// The rotations of a class in its own axes, as many as give the mean.
std::vector<Mat3> rotations(SymmetryClass kind)
{
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  std::vector<Mat3> result;
  if (kind == SymmetryClass::transversely_isotropic)
    for (int k = 0; k < 5; ++k)
      for (const double flip : {0.0, pi})
        result.push_back(turn(2 * pi * k / 5, z) * turn(flip, x));
  else if (kind == SymmetryClass::orthotropic)
    result = {Mat3::Identity(), turn(pi, x), turn(pi, y), turn(pi, z)};
  else // cubic: cyclic changes of the axes, quarter turns, a flip
    for (int cycle = 0; cycle < 3; ++cycle)
      for (int quarter = 0; quarter < 4; ++quarter)
        for (const double flip : {0.0, pi})
          result.push_back(turn(2 * pi * cycle / 3, Vec3(1, 1, 1).normalized()) *
                           turn(pi * quarter / 2, z) * turn(flip, x));
  return result;
}

Mat6 nearest_isotropic(const Mat6& matrix)
{
  Mat6 spherical = Mat6::Zero();
  spherical.topLeftCorner<3, 3>().setConstant(1.0 / 3);
  const double bulk = spherical.cwiseProduct(matrix).sum();
  return bulk * spherical + (matrix.trace() - bulk) / 5 * (Mat6::Identity() - spherical);
}

/// The matrices of a law in units of one another: S_v over the longest retardation time.
std::vector<Mat6> matrices(const ComplianceLaw& law)
{
  std::vector<Mat6> result{law.instantaneous,
                           law.fluidity * (law.terms.empty() ? 1.0 : law.terms.back().time)};
  for (const RetardationTerm& term : law.terms)
    result.push_back(term.compliance);
  return result;
}

double distance(std::span<const Mat6> all, const Symmetry& symmetry)
{
  double difference = 0, size = 0;
  for (const Mat6& each : all) {
    difference += (each - nearest(each, symmetry)).squaredNorm();
    size += each.squaredNorm();
  }
  return size > 0 ? std::sqrt(difference / size) : 0.0;
}

/// Turns the axes about one another as long as that makes the distance less.
Symmetry refined(std::span<const Mat6> all, Symmetry best, double step)
{
  double least = distance(all, best);
  while (step > 1e-8) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const double angle : {step, -step}) {
        const Symmetry tried{best.kind, best.axes * turn(angle, Vec3::Unit(axis))};
        if (const double found = distance(all, tried); found < least) {
          least = found;
          best = tried;
          better = true;
        }
      }
    if (!better)
      step /= 2;
  }
  return best;
}

/// Axes that cover all orientations of a class within about 15 degrees.
std::vector<Mat3> starts(SymmetryClass kind)
{
  std::vector<Mat3> result{Mat3::Identity()};
  const int n_axes = kind == SymmetryClass::transversely_isotropic ? 150 : 60;
  const int n_turns = kind == SymmetryClass::transversely_isotropic ? 1 : 6;
  for (int k = 0; k < n_axes; ++k) { // golden spiral over the half sphere
    const double height = (k + 0.5) / n_axes, angle = k * pi * (3 - std::sqrt(5.0));
    const double radius = std::sqrt(1 - height * height);
    const Mat3 axes = axes_about({radius * std::cos(angle), radius * std::sin(angle), height});
    for (int j = 0; j < n_turns; ++j)
      result.push_back(axes * turn(pi / 2 * j / n_turns, Vec3::UnitZ()));
  }
  return result;
}

Symmetry best_symmetry(std::span<const Mat6> all, SymmetryClass kind)
{
  if (kind == SymmetryClass::isotropic)
    return {kind, Mat3::Identity()};
  std::vector<std::pair<double, Mat3>> candidates;
  for (const Mat3& axes : starts(kind))
    candidates.emplace_back(distance(all, Symmetry{kind, axes}), axes);
  std::ranges::stable_sort(candidates, {}, &std::pair<double, Mat3>::first);
  Symmetry best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 5; ++k) {
    const Symmetry found = refined(all, {kind, candidates[k].second}, 0.1);
    if (const double value = distance(all, found); value < least) {
      least = value;
      best = found;
    }
  }
  return best;
}

template <typename Scalar>
EngineeringConstants<Scalar> constants(const Eigen::Matrix<Scalar, 6, 6>& compliance,
                                       const Mat3& axes)
{
  const Eigen::Matrix<Scalar, 6, 6> turned = mandel_rotation(axes.transpose()).cast<Scalar>() *
                                             compliance * mandel_rotation(axes).cast<Scalar>();
  EngineeringConstants<Scalar> result;
  for (int i = 0; i < 3; ++i) {
    result.young[i] = 1.0 / turned(i, i);
    result.shear[i] = 0.5 / turned(3 + i, 3 + i);
    for (int j = 0; j < 3; ++j)
      result.poisson(i, j) = i == j ? Scalar(-1) : Scalar(-turned(j, i) / turned(i, i));
  }
  return result;
}

} // namespace

Mat3 axes_about(const Vec3& axis)
{
  if (!(axis.norm() > 0))
    throw std::invalid_argument("symmetry: an axis needs a length > 0");
  return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
}

Mat6 nearest(const Mat6& matrix, const Symmetry& symmetry)
{
  if (symmetry.kind == SymmetryClass::isotropic)
    return nearest_isotropic(matrix);
  const Mat6 own = rotated(matrix, symmetry.axes.transpose());
  const std::vector<Mat3> group = rotations(symmetry.kind);
  Mat6 sum = Mat6::Zero();
  for (const Mat3& rotation : group)
    sum += rotated(own, rotation);
  return rotated(sum / double(group.size()), symmetry.axes);
}

double distance(const Mat6& matrix, const Symmetry& symmetry)
{
  return distance(std::span(&matrix, 1), symmetry);
}

ComplianceLaw nearest(const ComplianceLaw& law, const Symmetry& symmetry)
{
  ComplianceLaw result = law;
  result.instantaneous = nearest(law.instantaneous, symmetry);
  result.fluidity = nearest(law.fluidity, symmetry);
  for (RetardationTerm& term : result.terms)
    term.compliance = nearest(term.compliance, symmetry);
  return result;
}

double distance(const ComplianceLaw& law, const Symmetry& symmetry)
{
  return distance(matrices(law), symmetry);
}

Symmetry best_symmetry(const ComplianceLaw& law, SymmetryClass kind)
{
  return best_symmetry(matrices(law), kind);
}

Symmetry best_symmetry(const Mat6& matrix, SymmetryClass kind)
{
  return best_symmetry(std::span(&matrix, 1), kind);
}

EngineeringConstants<double> engineering_constants(const Mat6& compliance, const Mat3& axes)
{
  return constants<double>(compliance, axes);
}

EngineeringConstants<std::complex<double>> engineering_constants(const ComplexMat6& compliance,
                                                                 const Mat3& axes)
{
  return constants<std::complex<double>>(compliance, axes);
}

} // namespace fem
