#include "fem/cone_quadratic.h"

#include "fem/compliance_law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fem {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using Matrices = std::vector<Mat6>;

constexpr Index size = 21; // entries of a symmetric matrix

/// Entries of a symmetric matrix with the scalar product of matrices.
Eigen::Matrix<double, 21, 1> packed(const Mat6& matrix)
{
  Eigen::Matrix<double, 21, 1> result;
  Index at = 0;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i; j < 6; ++j)
      result[at++] = (i == j ? 1 : std::numbers::sqrt2) * matrix(i, j);
  return result;
}

Mat6 unpacked(const VectorXd& entries)
{
  Mat6 result;
  Index at = 0;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i; j < 6; ++j)
      result(i, j) = result(j, i) = entries[at++] / (i == j ? 1 : std::numbers::sqrt2);
  return result;
}

/// The map X -> M X M on packed entries.
MatrixXd congruence(const Mat6& matrix)
{
  MatrixXd result(size, size);
  for (Index k = 0; k < size; ++k) {
    const Mat6 unit = unpacked(VectorXd::Unit(size, k));
    result.col(k) = packed(matrix * unit * matrix);
  }
  return result;
}

/// Inverse of the matrix W with W Z W = X (scaling of Nesterov and Todd).
Mat6 inverse_scaling(const Mat6& x, const Mat6& z)
{
  // With X = L L^T: W^-1 = L^-T (L^T Z L)^(1/2) L^-1.
  const Mat6 lower = x.llt().matrixL();
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(lower.transpose() * z * lower);
  const Mat6 root = solver.eigenvectors() *
                    solver.eigenvalues().cwiseMax(1e-300).cwiseSqrt().asDiagonal() *
                    solver.eigenvectors().transpose();
  const Mat6 half = lower.transpose().triangularView<Eigen::Upper>().solve(root);
  const Mat6 whole =
      lower.transpose().triangularView<Eigen::Upper>().solve(half.transpose()).transpose();
  return 0.5 * (whole + whole.transpose());
}

/// Longest step at which X + step D is still positive semidefinite.
double reach(const Mat6& x, const Mat6& direction)
{
  const Eigen::LLT<Mat6> cholesky(x);
  const Mat6 half = cholesky.matrixL().solve(direction);
  const Mat6 whole = cholesky.matrixL().solve(half.transpose());
  const double least = smallest_eigenvalue(0.5 * (whole + whole.transpose()));
  return least < 0 ? -1 / least : 1e30;
}

Matrices gradient(const MatrixXd& gram, const Matrices& linear, const Matrices& x)
{
  Matrices result(x.size());
  for (std::size_t j = 0; j < x.size(); ++j) {
    result[j] = -linear[j];
    for (std::size_t k = 0; k < x.size(); ++k)
      result[j] += gram(Index(j), Index(k)) * x[k];
  }
  return result;
}

double product(const Matrices& a, const Matrices& b)
{
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j)
    sum += a[j].cwiseProduct(b[j]).sum();
  return sum;
}

/// Bound on the value above the minimum, by convexity: <X, Z> + lift tr(Y) for the gradient Z, the
/// lift that brings Z into the cone, and the solution Y, whose trace is taken as that of X.
double gap_at(const MatrixXd& gram, const Matrices& linear, const Matrices& x)
{
  const Matrices z = gradient(gram, linear, x);
  double trace = 0, lift = 0;
  for (std::size_t j = 0; j < x.size(); ++j) {
    trace += x[j].trace();
    lift = std::max(lift, -smallest_eigenvalue(z[j]));
  }
  return std::abs(product(x, z)) + lift * trace;
}

/// Interior point: X and Z inside the cone, going together to the optimum.
struct Interior {
  Matrices x, z;

  double mean_product() const { return product(x, z) / (6.0 * double(x.size())); }
};

struct Direction {
  Matrices x, z;
};

/// Newton directions of X Z = mu at an interior point, for several mu with one factorisation.
class Newton {
public:
  Newton(const MatrixXd& gram, const Matrices& linear, const Interior& at)
      : gram_(gram), at_(at), gradient_(gradient(gram, linear, at.x))
  {
    const Index n = gram.rows();
    MatrixXd system = MatrixXd::Zero(size * n, size * n);
    for (Index j = 0; j < n; ++j) {
      for (Index k = 0; k < n; ++k)
        system.block<size, size>(size * j, size * k).diagonal().setConstant(gram(j, k));
      scaling_.push_back(inverse_scaling(at.x[std::size_t(j)], at.z[std::size_t(j)]));
      system.block<size, size>(size * j, size * j) += congruence(scaling_.back());
    }
    factor_.compute(system);
  }

  Direction towards(double mu) const
  {
    const std::size_t n = at_.x.size();
    VectorXd right(size * Index(n));
    for (std::size_t j = 0; j < n; ++j)
      right.segment<size>(size * Index(j)) =
          packed(mu * at_.x[j].llt().solve(Mat6::Identity()) - gradient_[j]);
    const VectorXd step = factor_.solve(right);
    Direction result;
    for (std::size_t j = 0; j < n; ++j)
      result.x.push_back(unpacked(step.segment<size>(size * Index(j))));
    for (std::size_t j = 0; j < n; ++j) {
      Mat6 change = gradient_[j] - at_.z[j];
      for (std::size_t k = 0; k < n; ++k)
        change += gram_(Index(j), Index(k)) * result.x[k];
      result.z.push_back(change);
    }
    return result;
  }

private:
  const MatrixXd& gram_;
  const Interior& at_;
  Matrices gradient_;
  Matrices scaling_;
  Eigen::LLT<MatrixXd> factor_;
};

double reach(const Interior& at, const Direction& direction)
{
  double step = 1 / 0.99;
  for (std::size_t j = 0; j < at.x.size(); ++j)
    step = std::min({step, reach(at.x[j], direction.x[j]), reach(at.z[j], direction.z[j])});
  return std::min(1.0, 0.99 * step);
}

Interior moved(Interior at, const Direction& direction, double step)
{
  for (std::size_t j = 0; j < at.x.size(); ++j) {
    at.x[j] += step * direction.x[j];
    at.z[j] += step * direction.z[j];
  }
  return at;
}

bool inside(const Interior& at)
{
  const auto positive = [](const Mat6& each) { return smallest_eigenvalue(each) > 0; };
  return std::all_of(at.x.begin(), at.x.end(), positive) &&
         std::all_of(at.z.begin(), at.z.end(), positive);
}

/// Each matrix in turn to its minimum in the cone, which is a projection: the value cannot rise.
void sweep(const MatrixXd& gram, const Matrices& linear, Matrices& x)
{
  for (std::size_t j = 0; j < x.size(); ++j) {
    Mat6 rest = linear[j];
    for (std::size_t k = 0; k < x.size(); ++k)
      if (k != j)
        rest -= gram(Index(j), Index(k)) * x[k];
    x[j] = nearest_positive_semidefinite(rest / gram(Index(j), Index(j)));
  }
}

} // namespace

ConeMinimum minimize_over_cone(const MatrixXd& gram, const Matrices& linear, double gap,
                               int max_iterations)
{
  double scale = 0;
  for (const Mat6& each : linear)
    scale = std::max(scale, each.norm());
  if (scale == 0)
    return {Matrices(linear.size(), Mat6::Zero()), 0.0, 0};
  const Matrices start(linear.size(), scale * Mat6::Identity());
  Interior at{start, start};
  ConeMinimum best{start, gap_at(gram, linear, start), 0};
  while (best.iterations < max_iterations && best.gap > 0.1 * gap) {
    ++best.iterations;
    const double mu = at.mean_product();
    const Newton newton(gram, linear, at);
    const Direction affine = newton.towards(0);
    const Interior there = moved(at, affine, reach(at, affine));
    const double centring = std::pow(std::max(there.mean_product(), 0.0) / mu, 3);
    const Direction direction = newton.towards(std::clamp(centring, 1e-8, 1.0) * mu);
    const double step = reach(at, direction);
    const Interior next = moved(at, direction, step);
    if (!(step > 1e-10) || !inside(next))
      break; // at the limit of rounding
    at = next;
    if (const double found = gap_at(gram, linear, at.x); found < best.gap) {
      best.gap = found;
      best.solution = at.x;
    } else if (found < 1e3 * gap && step < 1e-3)
      break;
  }
  for (int polish = 0; polish < 20; ++polish)
    sweep(gram, linear, best.solution);
  best.gap = std::min(best.gap, gap_at(gram, linear, best.solution)); // no sweep raises the value
  return best;
}

} // namespace fem
