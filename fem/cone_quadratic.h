#pragma once
#include "fem/types.h"

#include <vector>

namespace fem {

/// Minimum of 1/2 sum_jk G_jk <X_j, X_k> - sum_j <F_j, X_j> over positive semidefinite X_j, with
/// <A, B> = tr(A B).
struct ConeMinimum {
  std::vector<Mat6> solution; ///< X_j, positive semidefinite to rounding
  double gap;                 ///< the value is at most so much above the minimum
  int iterations;
};

/// Solves the problem above for a symmetric positive semidefinite G of unit diagonal.
/// \param gap  the gap asked for; the result says which was reached
ConeMinimum minimize_over_cone(const Eigen::MatrixXd& gram, const std::vector<Mat6>& linear,
                               double gap, int max_iterations);

} // namespace fem
