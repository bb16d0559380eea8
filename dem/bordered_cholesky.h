#pragma once
#include "dem/lanes.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace dem {

/// Cholesky factor C of a dense symmetric matrix that grows by rows and columns at its end.
/// The lower triangle is stored row by row, so that growing appends.
class BorderedCholesky {
public:
  int size() const { return size_; }
  void clear();

  /// C^-1 B in place, for eight right-hand sides.
  void solve(std::span<Lanes> b) const;

  /// C^-1 b and C^-T b in place.
  void solve(Eigen::VectorXd& b) const;
  void solve_transposed(Eigen::VectorXd& b) const;

  /// Adds n rows: the first n lanes of `border` (as left by `solve`), transposed, and the lower
  /// triangle of `corner`, n x n, already factorised.
  void append(std::span<const Lanes> border, const Eigen::MatrixXd& corner);

private:
  const double* row(int i) const { return rows_.data() + std::size_t(i) * (i + 1) / 2; }

  std::vector<double> rows_;
  int size_ = 0;
};

} // namespace dem
