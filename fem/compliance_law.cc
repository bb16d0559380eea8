#include "fem/compliance_law.h"

#include "fem/mandel.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace fem {

namespace {

constexpr double tolerance = 1e-12; // of |S_0|

[[noreturn]] void refuse(const std::string& what)
{
  throw std::invalid_argument("compliance law: " + what);
}

void require_symmetric(const Mat6& matrix, double size, const std::string& name)
{
  if (!matrix.allFinite())
    refuse(name + " has an entry that is not a finite number");
  const Mat6 difference = matrix - matrix.transpose();
  Eigen::Index i = 0, j = 0;
  const double largest = difference.cwiseAbs().maxCoeff(&i, &j);
  if (largest > tolerance * size)
    refuse(fmt::format("{} is not symmetric: entries ({}, {}) and ({}, {}) are {:g} and {:g}", name,
                       j + 1, i + 1, i + 1, j + 1, matrix(j, i), matrix(i, j)));
}

void require_semidefinite(const Mat6& matrix, double size, const std::string& name)
{
  require_symmetric(matrix, size, name);
  if (const double least = smallest_eigenvalue(matrix); least < -tolerance * size)
    refuse(fmt::format("{} is not positive semidefinite: its smallest eigenvalue is {:g}", name,
                       least));
}

} // namespace

ComplianceLaw make_compliance_law(const Mat6& instantaneous, const Mat6& fluidity,
                                  std::span<const RetardationTerm> terms)
{
  const double size = instantaneous.norm();
  require_symmetric(instantaneous, size, "the instantaneous compliance");
  if (const double least = smallest_eigenvalue(instantaneous); !(least > tolerance * size))
    refuse(fmt::format("the instantaneous compliance must be positive definite: its smallest "
                       "eigenvalue is {:g}",
                       least));
  ComplianceLaw law{instantaneous, fluidity, {terms.begin(), terms.end()}};
  for (const auto& [time, part] : law.terms) {
    if (!(time > 0 && std::isfinite(time)))
      refuse(fmt::format("a retardation time must be a finite number > 0, found {:g}", time));
    require_semidefinite(part, size,
                         fmt::format("the compliance of the retardation time {:g} s", time));
  }
  std::ranges::sort(law.terms, {}, &RetardationTerm::time);
  for (std::size_t k = 1; k < law.terms.size(); ++k)
    if (law.terms[k].time == law.terms[k - 1].time)
      refuse(fmt::format("the retardation time {:g} s occurs twice", law.terms[k].time));
  const double longest = law.terms.empty() ? 1.0 : law.terms.back().time;
  require_semidefinite(fluidity, size / longest, "the fluidity");
  return law;
}

Mat6 compliance(const ComplianceLaw& law, double t)
{
  Mat6 sum = law.instantaneous + t * law.fluidity;
  for (const auto& [time, part] : law.terms)
    sum -= std::expm1(-t / time) * part;
  return sum;
}

Mat6 compliance_rate(const ComplianceLaw& law, double t)
{
  Mat6 sum = law.fluidity;
  for (const auto& [time, part] : law.terms)
    sum += std::exp(-t / time) / time * part;
  return sum;
}

ComplexMat6 complex_compliance(const ComplianceLaw& law, double omega)
{
  Mat6 storage = law.instantaneous, loss = law.fluidity / omega;
  for (const auto& [time, part] : law.terms) {
    const double tangent = omega * time, weight = 1 / (1 + tangent * tangent);
    storage += weight * part;
    loss += tangent * weight * part;
  }
  ComplexMat6 result;
  result.real() = storage;
  result.imag() = -loss;
  return result;
}

ComplexMat6 complex_stiffness(const ComplianceLaw& law, double omega)
{
  return complex_compliance(law, omega).inverse();
}

double uniaxial_compliance(const ComplianceLaw& law, const Vec3& direction, double t)
{
  if (!(direction.norm() > 0))
    refuse("a direction needs a length > 0");
  const Vec3 unit = direction.normalized();
  const Vec6 stress = mandel_vector(unit * unit.transpose());
  return stress.dot(compliance(law, t) * stress);
}

ComplianceLaw scaled(ComplianceLaw law, double factor)
{
  if (!(factor > 0 && std::isfinite(factor)))
    refuse(fmt::format("a factor must be a finite number > 0, found {:g}", factor));
  law.instantaneous *= factor;
  law.fluidity *= factor;
  for (RetardationTerm& term : law.terms)
    term.compliance *= factor;
  return law;
}

ComplianceLaw with_viscosities_scaled(ComplianceLaw law, double shift_factor)
{
  if (!(shift_factor > 0 && std::isfinite(shift_factor)))
    refuse(fmt::format("a shift factor must be a finite number > 0, found {:g}", shift_factor));
  law.fluidity /= shift_factor;
  for (RetardationTerm& term : law.terms)
    term.time *= shift_factor;
  return law;
}

double smallest_eigenvalue(const Mat6& matrix)
{
  return Eigen::SelfAdjointEigenSolver<Mat6>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

Mat6 nearest_positive_semidefinite(const Mat6& matrix)
{
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(matrix);
  const Vec6 kept = solver.eigenvalues().cwiseMax(0.0);
  const Mat6 result = solver.eigenvectors() * kept.asDiagonal() * solver.eigenvectors().transpose();
  return 0.5 * (result + result.transpose());
}

Mat6 isotropic_shape(double poisson_ratio)
{
  if (!(poisson_ratio > -1 && poisson_ratio < 0.5))
    refuse(
        fmt::format("Poisson's ratio must be above -1 and below 0.5, found {:g}", poisson_ratio));
  Mat6 shape = (1 + poisson_ratio) * Mat6::Identity();
  shape.topLeftCorner<3, 3>().array() -= poisson_ratio;
  return shape;
}

} // namespace fem
