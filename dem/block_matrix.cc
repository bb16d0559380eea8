#include "dem/block_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace dem {

namespace {

/// Blocks of one row under construction, found by their column.
class RowUnderConstruction {
public:
  explicit RowUnderConstruction(Index n_columns) : place_(n_columns, -1) {}

  Mat6& at(Index column)
  {
    Index& place = place_[column];
    if (place < 0) {
      place = Index(column_.size());
      column_.push_back(column);
      block_.push_back(Mat6::Zero());
    }
    return block_[place];
  }
  const std::vector<Index>& columns() const { return column_; }
  const Mat6& block(std::size_t k) const { return block_[k]; }
  void clear()
  {
    for (const Index column : column_)
      place_[column] = -1;
    column_.clear();
    block_.clear();
  }

private:
  std::vector<Index> place_; ///< of each column in the lists below, or -1
  std::vector<Index> column_;
  std::vector<Mat6> block_;
};

/// Pattern of the upper triangle of P^T A P with zero blocks.
BlockMatrix upper_pattern(const BlockMatrix& a, const BlockMatrix& p, Index n_columns)
{
  const ColumnRows rows_of = column_rows(p, n_columns);
  std::vector<Index> seen_by(n_columns, -1); // row that met this column last
  BlockMatrix result;
  for (Index row = 0; row < n_columns; ++row) {
    const auto first = std::ptrdiff_t(result.column.size());
    for (std::size_t t = rows_of.start[row]; t < rows_of.start[row + 1]; ++t) {
      const Index i = rows_of.row[t];
      for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
        const Index j = a.column[k];
        for (std::size_t m = p.row_start[j]; m < p.row_start[j + 1]; ++m)
          if (const Index column = p.column[m]; column >= row && seen_by[column] != row) {
            seen_by[column] = row;
            result.column.push_back(column);
          }
      }
    }
    std::sort(result.column.begin() + first, result.column.end());
    result.row_start.push_back(result.column.size());
  }
  result.block.assign(result.column.size(), Mat6::Zero());
  return result;
}

/// The whole of a symmetric matrix whose upper triangle is given.
BlockMatrix symmetric(const BlockMatrix& upper)
{
  const Index n = upper.n_rows();
  const ColumnRows lower = column_rows(upper, n);
  BlockMatrix result;
  result.column.reserve(2 * upper.column.size() - n);
  result.block.reserve(2 * upper.column.size() - n);
  for (Index i = 0; i < n; ++i) {
    for (std::size_t t = lower.start[i]; t < lower.start[i + 1]; ++t)
      if (lower.row[t] != i) {
        result.column.push_back(lower.row[t]);
        result.block.push_back(upper.block[lower.position[t]].transpose());
      }
    for (std::size_t k = upper.row_start[i]; k < upper.row_start[i + 1]; ++k) {
      result.column.push_back(upper.column[k]);
      result.block.push_back(upper.block[k]);
    }
    result.row_start.push_back(result.column.size());
  }
  return result;
}

} // namespace

Eigen::VectorXd product(const BlockMatrix& a, const Eigen::VectorXd& x)
{
  Eigen::VectorXd y(6 * Eigen::Index(a.n_rows()));
  for (Index i = 0; i < a.n_rows(); ++i) {
    Vec6 sum = Vec6::Zero();
    for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      sum.noalias() += a.block[k] * x.segment<6>(6 * Eigen::Index(a.column[k]));
    y.segment<6>(6 * Eigen::Index(i)) = sum;
  }
  return y;
}

Eigen::VectorXd transposed_product(const BlockMatrix& a, const Eigen::VectorXd& x, Index n_columns)
{
  Eigen::VectorXd y = Eigen::VectorXd::Zero(6 * Eigen::Index(n_columns));
  for (Index i = 0; i < a.n_rows(); ++i) {
    const Vec6 part = x.segment<6>(6 * Eigen::Index(i));
    for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      y.segment<6>(6 * Eigen::Index(a.column[k])).noalias() += a.block[k].transpose() * part;
  }
  return y;
}

std::size_t block_position(const BlockMatrix& a, Index row, Index column)
{
  const auto first = a.column.begin() + std::ptrdiff_t(a.row_start[row]);
  const auto last = a.column.begin() + std::ptrdiff_t(a.row_start[row + 1]);
  const auto found = std::lower_bound(first, last, column);
  assert(found != last && *found == column);
  return std::size_t(found - a.column.begin());
}

ColumnRows column_rows(const BlockMatrix& a, Index n_columns)
{
  ColumnRows result{std::vector<std::size_t>(n_columns + 1, 0), {}, {}};
  for (const Index column : a.column)
    ++result.start[column + 1];
  std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
  result.row.resize(a.column.size());
  result.position.resize(a.column.size());
  std::vector<std::size_t> next = result.start;
  for (Index i = 0; i < a.n_rows(); ++i)
    for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const std::size_t place = next[a.column[k]]++;
      result.row[place] = i;
      result.position[place] = k;
    }
  return result;
}

BlockMatrix galerkin_product(const BlockMatrix& a, const BlockMatrix& p, Index n_columns)
{
  BlockMatrix upper = upper_pattern(a, p, n_columns);
  RowUnderConstruction row_of_ap(n_columns);
  for (Index i = 0; i < a.n_rows(); ++i) {
    row_of_ap.clear();
    for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const Index j = a.column[k];
      for (std::size_t m = p.row_start[j]; m < p.row_start[j + 1]; ++m)
        row_of_ap.at(p.column[m]).noalias() += a.block[k] * p.block[m];
    }
    for (std::size_t m = p.row_start[i]; m < p.row_start[i + 1]; ++m)
      for (std::size_t k = 0; k < row_of_ap.columns().size(); ++k)
        if (const Index row = p.column[m], column = row_of_ap.columns()[k]; column >= row)
          upper.block[block_position(upper, row, column)].noalias() +=
              p.block[m].transpose() * row_of_ap.block(k);
  }
  return symmetric(upper);
}

Mat6 pseudo_inverse(const Mat6& block)
{
  constexpr double smallest_pivot = 1e-13; // relative: below, a direction counts as not held
  const Eigen::LLT<Mat6> factor(block);
  const double smallest = factor.matrixLLT().diagonal().minCoeff();
  if (factor.info() == Eigen::Success &&
      smallest * smallest > smallest_pivot * block.diagonal().maxCoeff())
    return factor.solve(Mat6::Identity());
  const Eigen::SelfAdjointEigenSolver<Mat6> modes(block);
  const Vec6 values = modes.eigenvalues();
  Vec6 inverse = Vec6::Zero();
  for (int k = 0; k < 6; ++k)
    if (values[k] > smallest_pivot * values[5])
      inverse[k] = 1 / values[k];
  return modes.eigenvectors() * inverse.asDiagonal() * modes.eigenvectors().transpose();
}

std::vector<Mat6> inverse_diagonal(const BlockMatrix& a)
{
  std::vector<Mat6> inverse;
  inverse.reserve(a.n_rows());
  for (Index i = 0; i < a.n_rows(); ++i)
    inverse.push_back(pseudo_inverse(a.block[block_position(a, i, i)]));
  return inverse;
}

double largest_eigenvalue(const BlockMatrix& a, const std::vector<Mat6>& inverse_diagonal)
{
  constexpr int n_iterations = 12;
  Eigen::VectorXd x(6 * Eigen::Index(a.n_rows()));
  for (Eigen::Index k = 0; k < x.size(); ++k)
    x[k] = std::sin(double(k * k % 10007) + 0.5); // rough, and the same every time
  double eigenvalue = 1;
  for (int iteration = 0; iteration < n_iterations; ++iteration) {
    x /= x.norm();
    Eigen::VectorXd y = product(a, x);
    for (Index i = 0; i < a.n_rows(); ++i) {
      auto part = y.segment<6>(6 * Eigen::Index(i));
      part = (inverse_diagonal[i] * part).eval();
    }
    eigenvalue = y.norm();
    x = std::move(y);
  }
  return eigenvalue;
}

} // namespace dem
