#include "fem/least_squares.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace fem {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Unconstrained least squares on some columns; 0 elsewhere.
VectorXd solution_on(const MatrixXd& a, const VectorXd& b, const std::vector<Index>& columns)
{
  VectorXd x = VectorXd::Zero(a.cols());
  const VectorXd part = MatrixXd(a(Eigen::all, columns)).colPivHouseholderQr().solve(b);
  for (std::size_t k = 0; k < columns.size(); ++k)
    x[columns[k]] = part[Index(k)];
  return x;
}

/// Goes from x towards a solution with negative entries until the first entry is 0; those leave.
void step_back(VectorXd& x, const VectorXd& target, std::vector<Index>& passive)
{
  double reach = 1;
  Index blocking = -1;
  for (const Index j : passive)
    if (target[j] <= 0 && x[j] / (x[j] - target[j]) <= reach) {
      reach = x[j] / (x[j] - target[j]);
      blocking = j;
    }
  x += reach * (target - x);
  if (blocking >= 0)
    x[blocking] = 0;
  std::erase_if(passive, [&](Index j) { return x[j] <= 0; });
  for (Index j = 0; j < x.size(); ++j)
    if (std::find(passive.begin(), passive.end(), j) == passive.end())
      x[j] = 0;
}

MatrixXd jacobian_of(const ResidualFunction& residuals, const VectorXd& at, Index rows)
{
  MatrixXd jacobian(rows, at.size());
  for (Index j = 0; j < at.size(); ++j) {
    const double step = 1e-6 * std::max(1.0, std::abs(at[j]));
    VectorXd low = at, high = at;
    low[j] -= step;
    high[j] += step;
    jacobian.col(j) = (residuals(high) - residuals(low)) / (high[j] - low[j]);
  }
  return jacobian;
}

} // namespace

VectorXd nonnegative_least_squares(const MatrixXd& a, const VectorXd& b)
{
  VectorXd scale = a.colwise().norm();
  for (double& each : scale)
    each = each > 0 ? each : 1.0;
  const MatrixXd unit = a * scale.cwiseInverse().asDiagonal();
  const double threshold = 1e-13 * b.norm();
  std::vector<Index> passive;
  std::vector<bool> tabu(std::size_t(a.cols()), false); // entered and left at once: rounding
  VectorXd x = VectorXd::Zero(a.cols());
  for (Index change = 0; change < 30 * std::max<Index>(a.cols(), 1); ++change) {
    const VectorXd gradient = unit.transpose() * (b - unit * x);
    Index entering = -1;
    for (Index j = 0; j < a.cols(); ++j)
      if (!tabu[std::size_t(j)] && std::find(passive.begin(), passive.end(), j) == passive.end() &&
          gradient[j] > threshold && (entering < 0 || gradient[j] > gradient[entering]))
        entering = j;
    if (entering < 0)
      return x.cwiseQuotient(scale);
    passive.push_back(entering);
    VectorXd target = solution_on(unit, b, passive);
    if (target[entering] <= 0) {
      passive.pop_back();
      tabu[std::size_t(entering)] = true;
      continue;
    }
    std::fill(tabu.begin(), tabu.end(), false);
    while (std::any_of(passive.begin(), passive.end(), [&](Index j) { return target[j] <= 0; })) {
      step_back(x, target, passive);
      target = solution_on(unit, b, passive);
    }
    x = target;
  }
  throw std::runtime_error("non-negative least squares: the active set does not settle");
}

LeastSquaresResult levenberg_marquardt(const ResidualFunction& residuals, const VectorXd& start,
                                       int max_iterations)
{
  LeastSquaresResult at;
  at.parameters = start;
  at.residuals = residuals(start);
  at.objective = at.residuals.squaredNorm();
  if (!std::isfinite(at.objective))
    throw std::invalid_argument("least squares: the residuals at the start are not finite");
  at.jacobian = jacobian_of(residuals, start, at.residuals.size());
  double damping = 1e-3, growth = 2;
  while (at.iterations < max_iterations && !at.converged) {
    ++at.iterations;
    const MatrixXd normal = at.jacobian.transpose() * at.jacobian;
    const VectorXd gradient = at.jacobian.transpose() * at.residuals;
    const VectorXd diagonal =
        normal.diagonal().cwiseMax(1e-12 * normal.diagonal().maxCoeff()).cwiseMax(1e-300);
    const MatrixXd damped = normal + MatrixXd((damping * diagonal).asDiagonal());
    const VectorXd step = -damped.ldlt().solve(gradient);
    const VectorXd tried = at.parameters + step;
    const VectorXd found = residuals(tried);
    const double objective = found.squaredNorm();
    const double promised = step.dot(damping * diagonal.cwiseProduct(step) - gradient);
    const bool tiny = !(step.norm() > 1e-10 * (1 + at.parameters.norm()));
    if (std::isfinite(objective) && objective <= at.objective) {
      const double ratio = (at.objective - objective) / std::max(promised, 1e-300);
      at.converged = tiny || at.objective - objective <= 1e-12 * at.objective;
      at.parameters = tried;
      at.residuals = found;
      at.objective = objective;
      at.jacobian = jacobian_of(residuals, tried, found.size());
      damping = std::max(1e-15, damping * std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3)));
      growth = 2;
    } else {
      at.converged = tiny;
      damping *= growth;
      growth *= 2;
      if (!std::isfinite(damping))
        break;
    }
  }
  return at;
}

MatrixXd covariance(const MatrixXd& jacobian, double objective)
{
  const Index freedom = jacobian.rows() - jacobian.cols();
  if (jacobian.cols() == 0)
    return MatrixXd::Zero(0, 0);
  if (freedom <= 0)
    return MatrixXd::Constant(jacobian.cols(), jacobian.cols(),
                              std::numeric_limits<double>::infinity());
  VectorXd scale = jacobian.colwise().norm();
  for (double& each : scale)
    each = each > 0 ? each : 1.0;
  const MatrixXd unit = jacobian * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<MatrixXd> svd(unit, Eigen::ComputeThinV);
  const VectorXd values = svd.singularValues().cwiseMax(1e-10 * svd.singularValues()[0]);
  const MatrixXd half =
      scale.cwiseInverse().asDiagonal() * svd.matrixV() * values.cwiseInverse().asDiagonal();
  return objective / double(freedom) * half * half.transpose();
}

} // namespace fem
