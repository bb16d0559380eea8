#pragma once
#include "dem/network.h"

#include <vector>

namespace dem {

/// Sparse matrix of 6 x 6 blocks, row by row; columns of a row in increasing order.
struct BlockMatrix {
  std::vector<std::size_t> row_start{0}; ///< length n_rows + 1
  std::vector<Index> column;             ///< of each block
  std::vector<Mat6> block;

  Index n_rows() const { return Index(row_start.size()) - 1; }
};

/// A x, six numbers per row.
Eigen::VectorXd product(const BlockMatrix& a, const Eigen::VectorXd& x);

/// A^T x for a matrix with this many columns.
Eigen::VectorXd transposed_product(const BlockMatrix& a, const Eigen::VectorXd& x, Index n_columns);

/// Position of a block in the lists of the matrix; it must be stored.
std::size_t block_position(const BlockMatrix& a, Index row, Index column);

/// Transposed matrix without its values: rows in which each column occurs.
struct ColumnRows {
  std::vector<std::size_t> start; ///< of each column in `row`, and the end
  std::vector<Index> row;
  std::vector<std::size_t> position; ///< of the block in the lists of the matrix
};
ColumnRows column_rows(const BlockMatrix& a, Index n_columns);

/// P^T A P for a symmetric A. Each row of A P is made once and not kept.
BlockMatrix galerkin_product(const BlockMatrix& a, const BlockMatrix& p, Index n_columns);

/// Inverse of the diagonal blocks of a symmetric positive semidefinite matrix; directions without
/// stiffness are left out (pseudo-inverse).
std::vector<Mat6> inverse_diagonal(const BlockMatrix& a);
Mat6 pseudo_inverse(const Mat6& block);

/// Largest eigenvalue of D^-1 A, D the block diagonal, by a few power iterations: a little low.
double largest_eigenvalue(const BlockMatrix& a, const std::vector<Mat6>& inverse_diagonal);

} // namespace dem
