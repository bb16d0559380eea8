#pragma once
#include <Eigen/Core>

#include <functional>

/// Small dense least-squares problems of the fits.
namespace fem {

/// Solution x >= 0 that makes |A x - b| least (active-set method of Lawson and Hanson, Solving
/// Least Squares Problems, 1974, chapter 23). Columns are scaled to unit norm first; columns of
/// zeros get 0. At the end no gradient component is more negative than 1e-13 |b|. \throws
/// std::runtime_error if the active set does not settle in 30 changes per column
Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// Residuals as a function of the parameters; always as many.
using ResidualFunction = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Minimum found by `levenberg_marquardt`.
struct LeastSquaresResult {
  Eigen::VectorXd parameters;
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian; ///< of the residuals, by central differences
  double objective = 0;     ///< sum of squared residuals
  int iterations = 0;
  bool converged = false;
};

/// Local minimum of the sum of squares by Levenberg's and Marquardt's method with Nielsen's damping
/// and a Jacobian by central differences of step 1e-6; parameters should be of order one
/// (logarithms of what is positive). Residuals that are not finite make a step fail. Ends when a
/// step is below 1e-10 of the parameters or changes the objective by less than 1e-12. \throws
/// std::invalid_argument if the residuals at the start are not finite
LeastSquaresResult levenberg_marquardt(const ResidualFunction& residuals,
                                       const Eigen::VectorXd& start, int max_iterations = 200);

/// Covariance (J^T J)^-1 times the residual variance objective / (rows - columns) [parameter
/// squared]; directions that the residuals do not see (singular value below 1e-10 of the largest)
/// get the variance that this threshold allows. Zero residual degrees of freedom give infinity.
Eigen::MatrixXd covariance(const Eigen::MatrixXd& jacobian, double objective);

} // namespace fem
