#pragma once
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <concepts>

namespace dem {

/// How an iterative solution ended.
enum class IterationEnd {
  converged,
  no_stiffness, ///< zero or negative curvature: the matrix is not positive definite
  too_many      ///< iterations
};

/// What conjugate gradients know about a solution x that began at zero.
struct IterationProgress {
  double residual; ///< |b - A x|
  double work;     ///< b . x
};

/// Solution of A x = b.
struct IterativeSolution {
  Eigen::VectorXd x;
  IterationEnd end;
  int n_iterations = 0;
};

/// Conjugate gradients for a symmetric positive definite matrix, from x = 0.
///
/// \param matrix          v -> A v
/// \param preconditioner  v -> M v, M near to the inverse of A, symmetric and positive definite
/// \param is_precise      whether this progress is enough
template <typename Matrix, typename Preconditioner, std::predicate<IterationProgress> Precise>
IterativeSolution conjugate_gradients(Matrix&& matrix, const Eigen::VectorXd& b,
                                      Preconditioner&& preconditioner, Precise&& is_precise,
                                      int most_iterations)
{
  constexpr double rounding = 1e-15; // curvature relative to the largest met that counts as none
  IterativeSolution result{Eigen::VectorXd::Zero(b.size()), IterationEnd::converged};
  Eigen::VectorXd residual = b, direction;
  double work = 0, before = 0, largest_curvature = 0;
  for (; !is_precise({residual.norm(), work}); ++result.n_iterations) {
    if (result.n_iterations == most_iterations) {
      result.end = IterationEnd::too_many;
      return result;
    }
    const Eigen::VectorXd preconditioned = preconditioner(residual);
    const double product = residual.dot(preconditioned);
    if (result.n_iterations == 0)
      direction = preconditioned;
    else
      direction = preconditioned + product / before * direction;
    const Eigen::VectorXd image = matrix(direction);
    const double energy = direction.dot(image);
    const double curvature = energy / direction.squaredNorm();
    largest_curvature = std::max(largest_curvature, std::abs(curvature));
    if (!(product > 0) || !(curvature > rounding * largest_curvature)) { // nor if not a number
      result.end = IterationEnd::no_stiffness;
      return result;
    }
    const double step = product / energy;
    result.x += step * direction;
    residual -= step * image;
    work += step * product;
    before = product;
  }
  return result;
}

} // namespace dem
