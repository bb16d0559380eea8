#include "dem/multigrid.h"

#include <Eigen/QR>

#include <algorithm>

namespace dem {

namespace {

/// Rows from which on a matrix is coarsened and not factorised: 1800 unknowns, 26 MB.
constexpr Index most_coarsest_rows = 300;
/// Stiffness that directions without any get on the coarsest level, relative to the largest.
constexpr double trace_of_stiffness = 1e-13;

/// Relaxation of one row: x_i = D_i^-1 (b_i - sum_j A_ij x_j). With `only_before`, later rows are
/// known to be zero.
void relax(const BlockMatrix& a, const std::vector<Mat6>& inverse_diagonal, Index i,
           const Eigen::VectorXd& b, Eigen::VectorXd& x, bool only_before)
{
  Vec6 rest = b.segment<6>(6 * Eigen::Index(i));
  for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
    const Index j = a.column[k];
    if (only_before && j >= i)
      break;
    if (j != i)
      rest.noalias() -= a.block[k] * x.segment<6>(6 * Eigen::Index(j));
  }
  x.segment<6>(6 * Eigen::Index(i)).noalias() = inverse_diagonal[i] * rest;
}

/// Prolongator that represents the near-null space on each group, and that space on the groups.
struct Tentative {
  std::vector<Mat6> block; ///< of each row, in the column of its group
  std::vector<Mat6> near_null;
};

Tentative tentative_prolongator(const Aggregates& groups, const std::vector<Mat6>& near_null)
{
  std::vector<std::vector<Index>> members(groups.n_groups);
  for (std::size_t i = 0; i < near_null.size(); ++i)
    if (groups.of_row[i] >= 0)
      members[groups.of_row[i]].push_back(Index(i));
  Tentative result{std::vector<Mat6>(near_null.size()), {}};
  for (const std::vector<Index>& rows : members) {
    const auto n = Eigen::Index(rows.size());
    Eigen::Matrix<double, Eigen::Dynamic, 6> modes(6 * n, 6);
    for (Eigen::Index k = 0; k < n; ++k)
      modes.middleRows<6>(6 * k) = near_null[rows[k]];
    const Eigen::HouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 6>> qr(modes);
    modes.setIdentity();
    modes = qr.householderQ() * modes;
    for (Eigen::Index k = 0; k < n; ++k)
      result.block[rows[k]] = modes.middleRows<6>(6 * k);
    result.near_null.push_back(qr.matrixQR().topRows<6>().triangularView<Eigen::Upper>());
  }
  return result;
}

/// (I - omega D^-1 A) times the tentative prolongator.
BlockMatrix smoothed_prolongator(const BlockMatrix& a, const std::vector<Mat6>& inverse_diagonal,
                                 const Aggregates& groups, const std::vector<Mat6>& tentative)
{
  const double omega = 4.0 / 3.0 / largest_eigenvalue(a, inverse_diagonal);
  BlockMatrix result;
  std::vector<std::pair<Index, Mat6>> row; // by group
  for (Index i = 0; i < a.n_rows(); ++i) {
    row.clear();
    if (groups.of_row[i] >= 0)
      row.emplace_back(groups.of_row[i], tentative[i]);
    for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1] && !row.empty(); ++k) {
      const Index j = a.column[k], group = groups.of_row[j];
      auto place = std::ranges::find(row, group, &std::pair<Index, Mat6>::first);
      if (place == row.end())
        place = row.insert(row.end(), {group, Mat6::Zero()});
      place->second -= omega * (inverse_diagonal[i] * (a.block[k] * tentative[j]));
    }
    std::ranges::sort(row, {}, &std::pair<Index, Mat6>::first);
    for (const auto& [group, block] : row) {
      result.column.push_back(group);
      result.block.push_back(block);
    }
    result.row_start.push_back(result.column.size());
  }
  result.block.shrink_to_fit();
  return result;
}

Eigen::MatrixXd dense(const BlockMatrix& a)
{
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(6 * Eigen::Index(a.n_rows()), 6 * Eigen::Index(a.n_rows()));
  for (Index i = 0; i < a.n_rows(); ++i)
    for (std::size_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      result.block<6, 6>(6 * Eigen::Index(i), 6 * Eigen::Index(a.column[k])) = a.block[k];
  return result;
}

Eigen::LLT<Eigen::MatrixXd> factor(const BlockMatrix& a)
{
  const Eigen::MatrixXd matrix = dense(a);
  Eigen::LLT<Eigen::MatrixXd> result(matrix);
  double trace = trace_of_stiffness * matrix.diagonal().cwiseAbs().maxCoeff();
  for (; result.info() != Eigen::Success && trace > 0; trace *= 10)
    result.compute(matrix + trace * Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  return result;
}

} // namespace

Aggregates make_aggregates(const BlockMatrix& matrix)
{
  constexpr Index none = -1;
  const Index n = matrix.n_rows();
  Aggregates groups{std::vector<Index>(n, none), 0};
  const auto neighbours = [&](Index i) {
    return std::span(matrix.column)
        .subspan(matrix.row_start[i], matrix.row_start[i + 1] - matrix.row_start[i]);
  };
  const auto is_free = [&](Index i) { return groups.of_row[i] == none; };
  const auto is_alone = [&](Index i) { return neighbours(i).size() == 1; };
  for (Index i = 0; i < n; ++i) // a row and all its neighbours, if none is taken yet
    if (!is_alone(i) && std::ranges::all_of(neighbours(i), is_free)) {
      for (const Index j : neighbours(i))
        groups.of_row[j] = groups.n_groups;
      ++groups.n_groups;
    }
  const std::vector<Index> roots = groups.of_row;
  for (Index i = 0; i < n; ++i) // what is left joins the group it is held by most
    if (is_free(i)) {
      double strongest = 0;
      for (std::size_t k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k)
        if (const Index group = roots[matrix.column[k]]; group != none) {
          const double strength = matrix.block[k].squaredNorm();
          if (strength >= strongest) {
            strongest = strength;
            groups.of_row[i] = group;
          }
        }
    }
  for (Index i = 0; i < n; ++i) // or makes one with its neighbours
    if (is_free(i) && !is_alone(i)) {
      for (const Index j : neighbours(i))
        if (is_free(j))
          groups.of_row[j] = groups.n_groups;
      ++groups.n_groups;
    }
  return groups;
}

Multigrid::Multigrid(BlockMatrix matrix, std::vector<Mat6> near_null)
{
  levels_.push_back({std::move(matrix), {}, {}});
  while (levels_.back().matrix.n_rows() > most_coarsest_rows) {
    Level& fine = levels_.back();
    const Aggregates groups = make_aggregates(fine.matrix);
    fine.inverse_diagonal = inverse_diagonal(fine.matrix);
    Tentative tentative = tentative_prolongator(groups, near_null);
    fine.prolongator =
        smoothed_prolongator(fine.matrix, fine.inverse_diagonal, groups, tentative.block);
    near_null = std::move(tentative.near_null);
    tentative.block = {};
    BlockMatrix coarse = galerkin_product(fine.matrix, fine.prolongator, groups.n_groups);
    levels_.push_back({std::move(coarse), {}, {}});
  }
  if (levels_.back().matrix.n_rows() > 0)
    coarsest_ = factor(levels_.back().matrix);
}

Eigen::VectorXd Multigrid::cycle(const Eigen::VectorXd& b) const
{
  return cycle(0, b);
}

Eigen::VectorXd Multigrid::cycle(std::size_t level, const Eigen::VectorXd& b) const
{
  if (level + 1 == levels_.size())
    return b.size() == 0 ? b : coarsest_.solve(b).eval();
  const auto& [matrix, inverse_diagonal, prolongator] = levels_[level];
  const Index n = matrix.n_rows(), n_coarse = levels_[level + 1].matrix.n_rows();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  for (Index i = 0; i < n; ++i)
    relax(matrix, inverse_diagonal, i, b, x, true);
  const Eigen::VectorXd residual = b - product(matrix, x);
  x += product(prolongator, cycle(level + 1, transposed_product(prolongator, residual, n_coarse)));
  for (Index i = n - 1; i >= 0; --i)
    relax(matrix, inverse_diagonal, i, b, x, false);
  return x;
}

void Multigrid::replace(Index row, Index column, const Mat6& block)
{
  Level& finest = levels_.front();
  finest.matrix.block[block_position(finest.matrix, row, column)] = block;
  if (row == column && levels_.size() > 1)
    finest.inverse_diagonal[row] = pseudo_inverse(block);
}

double Multigrid::complexity() const
{
  std::size_t n_blocks = 0;
  for (const Level& level : levels_)
    n_blocks += level.matrix.block.size();
  return double(n_blocks) / double(matrix().block.size());
}

} // namespace dem
