#include "fem/step_law.h"

#include "fem/relaxation_law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace fem {

namespace {

/// Appends the columns of a root of a positive semidefinite matrix.
void append_root(const Mat6& matrix, double time, std::vector<Vec6>& columns,
                 std::vector<double>& times)
{
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(matrix);
  const double least = 1e-13 * solver.eigenvalues().maxCoeff();
  for (int k = 0; k < 6; ++k)
    if (solver.eigenvalues()[k] > least) {
      columns.push_back(std::sqrt(solver.eigenvalues()[k]) * solver.eigenvectors().col(k));
      times.push_back(time);
    }
}

} // namespace

double phi_1(double x)
{
  return x == 0 ? 1 : -std::expm1(-x) / x;
}

double phi_2(double x)
{
  if (x >= 1)
    return (1 + std::expm1(-x) / x) / x;
  double term = 0.5, sum = 0.5; // (-x)^k / (k + 2)!
  for (int k = 1; k < 20; ++k) {
    term *= -x / (k + 2);
    sum += term;
  }
  return sum;
}

SteppableLaw steppable_law(const ComplianceLaw& law, TimeScheme scheme)
{
  SteppableLaw result;
  result.scheme = scheme;
  std::vector<Vec6> columns;
  std::vector<double> times;
  if (scheme == TimeScheme::stress_linear) {
    result.instantaneous = law.instantaneous;
    result.lasting = law.fluidity;
    for (const RetardationTerm& term : law.terms)
      append_root(term.compliance, term.time, columns, times);
  } else {
    const RelaxationLaw relaxing = relaxation_law(law);
    result.instantaneous = stiffness(relaxing, 0);
    result.lasting = relaxing.equilibrium;
    for (const RelaxationTerm& term : relaxing.terms)
      append_root(term.stiffness, term.time, columns, times);
  }
  result.factor.resize(6, Eigen::Index(columns.size()));
  result.time.resize(Eigen::Index(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    result.factor.col(Eigen::Index(k)) = columns[k];
    result.time[Eigen::Index(k)] = times[k];
  }
  return result;
}

StepOperator step_operator(const SteppableLaw& law, double step)
{
  if (!(step >= 0 && std::isfinite(step)))
    throw std::invalid_argument(fmt::format("a step of {} s is not possible", step));
  StepOperator result;
  result.step = step;
  const auto& factor = law.factor;
  const Eigen::ArrayXd x = step / law.time;
  result.decay = x * x.unaryExpr(&phi_1);
  if (law.scheme == TimeScheme::strain_linear) {
    result.ramp = x.unaryExpr(&phi_1);
    result.tangent = law.lasting + factor * result.ramp.matrix().asDiagonal() * factor.transpose();
    result.held = factor * result.decay.matrix().asDiagonal() * factor.transpose();
    return result;
  }
  result.ramp = x * x.unaryExpr(&phi_2);
  result.held =
      step * law.lasting + factor * result.decay.matrix().asDiagonal() * factor.transpose();
  const Mat6 compliance = law.instantaneous + step / 2 * law.lasting +
                          factor * result.ramp.matrix().asDiagonal() * factor.transpose();
  result.tangent = compliance.llt().solve(Mat6::Identity());
  result.tangent = (0.5 * (result.tangent + result.tangent.transpose())).eval();
  return result;
}

Vec6 stress_increment(const SteppableLaw& law, const StepOperator& step, const Vec6& stress,
                      const Eigen::Ref<const Eigen::VectorXd>& internal, const Vec6& increment)
{
  const Vec6 fading = law.factor * (step.decay * internal.array()).matrix();
  if (law.scheme == TimeScheme::strain_linear)
    return step.tangent * increment - fading;
  return step.tangent * (increment - step.held * stress + fading);
}

void advance_internal(const SteppableLaw& law, const StepOperator& step, const Vec6& stress,
                      const Vec6& stress_change, const Vec6& increment,
                      Eigen::Ref<Eigen::VectorXd> internal)
{
  const Eigen::ArrayXd before = internal.array();
  if (law.scheme == TimeScheme::strain_linear)
    internal.array() +=
        step.ramp * (law.factor.transpose() * increment).array() - step.decay * before;
  else
    internal.array() += step.decay * ((law.factor.transpose() * stress).array() - before) +
                        step.ramp * (law.factor.transpose() * stress_change).array();
}

} // namespace fem
