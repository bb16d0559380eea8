#pragma once
#include "dem/block_matrix.h"

#include <Eigen/Cholesky>

#include <span>
#include <vector>

namespace dem {

/// Algebraic multigrid by smoothed aggregation for a symmetric positive definite matrix of 6 x 6
/// blocks: a preconditioner for conjugate gradients.
///
/// Rows are grouped with their neighbours (a row without any needs no group: relaxation solves it);
/// on each group the near-null space (here: rigid motions)
/// is represented exactly and becomes the six unknowns of one row of the next coarser level. One
/// step of damped block Jacobi smooths the prolongator. A cycle relaxes by block Gauss-Seidel,
/// forwards on the way down and backwards on the way up, which keeps it symmetric and positive.
///
/// Vanek, Mandel, Brezina, Computing 56 (1996) 179.
class Multigrid {
public:
  /// \param near_null  of each row: six columns of the near-null space, of full rank
  Multigrid(BlockMatrix matrix, std::vector<Mat6> near_null);

  /// Approximate solution of A x = b: one cycle.
  Eigen::VectorXd cycle(const Eigen::VectorXd& b) const;

  /// The matrix on the finest level.
  const BlockMatrix& matrix() const { return levels_.front().matrix; }

  /// Replaces blocks of the finest matrix, whose pattern stays; coarser levels stay as they were.
  /// The cycle remains symmetric and positive, and precise as long as the change is small.
  void replace(Index row, Index column, const Mat6& block);

  int n_levels() const { return int(levels_.size()); }

  /// Blocks of the matrices on all levels over those on the finest.
  double complexity() const;

private:
  struct Level {
    BlockMatrix matrix;
    std::vector<Mat6> inverse_diagonal; ///< empty on the coarsest level
    BlockMatrix prolongator;            ///< to this level from the next coarser one
  };

  Eigen::VectorXd cycle(std::size_t level, const Eigen::VectorXd& b) const;

  std::vector<Level> levels_;
  Eigen::LLT<Eigen::MatrixXd> coarsest_;
};

/// Groups the rows of a matrix with their neighbours.
struct Aggregates {
  std::vector<Index> of_row; ///< number of the group of each row; -1: no neighbour, no group
  Index n_groups;
};
Aggregates make_aggregates(const BlockMatrix& matrix);

} // namespace dem
