#include "dem/link_assembly.h"

#include "dem/network_matrix.h"

#include <algorithm>

namespace dem {

namespace {

constexpr int outside = -2;

LinkAssembly::Ends in_order(const LinkAssembly::Ends& ends)
{
  return {std::min(ends[0], ends[1]), std::max(ends[0], ends[1])};
}

SymmetricPattern pattern_of(std::span<const LinkAssembly::Ends> pairs, const LinkDofs& dofs)
{
  ElasticNetwork network;
  network.radius = dofs.radius;
  network.first_dof = dofs.first_dof;
  network.support = dofs.support;
  network.platen_dof = dofs.platen_dof;
  network.n_dofs = dofs.n_dofs;
  for (const auto& each : pairs) {
    ElasticNetwork::Bond bond{};
    bond.ends = each;
    network.bonds.push_back(bond);
  }
  return stiffness_pattern(network);
}

} // namespace

LinkAssembly::LinkAssembly(std::vector<Ends> pairs, const LinkDofs& dofs)
    : dofs_(dofs), pairs_(std::move(pairs))
{
  for (Ends& each : pairs_)
    each = in_order(each);
  std::ranges::sort(pairs_);
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  pattern_ = pattern_of(pairs_, dofs_);
  find_pairs();
}

void LinkAssembly::find_pairs()
{
  for (const auto& [a, b] : pairs_) {
    const auto [column, row] = std::minmax(dofs_.first_dof[a], dofs_.first_dof[b]);
    if (column < 0 || column == row) {
      below_.push_back(-1);
      continue;
    }
    const auto first = pattern_.row.begin() + pattern_.column_start[column];
    const auto last = pattern_.row.begin() + pattern_.column_start[column + 1];
    below_.push_back(int(std::lower_bound(first, last, row) - first));
  }
}

void LinkAssembly::find_links(const std::vector<Ends>& ends)
{
  if (ends == found_)
    return;
  found_ = ends;
  below_of_link_.clear();
  for (const Ends& each : ends) {
    const Ends pair = in_order(each);
    const auto found = std::ranges::lower_bound(pairs_, pair);
    const bool is_pair = found != pairs_.end() && *found == pair;
    below_of_link_.push_back(is_pair ? below_[found - pairs_.begin()] : outside);
  }
}

std::size_t LinkAssembly::n_outside(const LinkMatrix& matrix)
{
  find_links(matrix.ends);
  std::size_t n = 0;
  for (std::size_t k = 0; k < matrix.tangent.size(); ++k)
    n += below_of_link_[k] == outside && matrix.tangent[k].carries() ? 1 : 0;
  return n;
}

std::vector<double> LinkAssembly::values(const LinkMatrix& matrix)
{
  find_links(matrix.ends);
  std::vector<double> values(pattern_.row.size(), 0.0);
  std::vector<Mat6> own(dofs_.first_dof.size(), Mat6::Zero());
  for (std::size_t k = 0; k < matrix.tangent.size(); ++k) {
    const auto [a, b] = matrix.ends[k];
    const bool free = dofs_.first_dof[a] >= 0 && dofs_.first_dof[b] >= 0;
    const bool together = dofs_.first_dof[a] < 0 && dofs_.support[a] == dofs_.support[b];
    const int below = below_of_link_[k];
    if (!matrix.tangent[k].carries() || together || (free && below == outside))
      continue;
    const LinkStiffness block = link_stiffness(matrix.tangent[k], dofs_.radius[a], dofs_.radius[b]);
    own[a] += block.topLeftCorner<6, 6>();
    own[b] += block.bottomRightCorner<6, 6>();
    if (below >= 0)
      add_between(block, matrix.ends[k], below, values);
    else
      add_platen(block, matrix.ends[k], values);
  }
  add_bodies(own, matrix.hold, values);
  return values;
}

void LinkAssembly::add_between(const LinkStiffness& block, const Ends& ends, int below,
                               std::span<double> values) const
{
  const int end = dofs_.first_dof[ends[0]] < dofs_.first_dof[ends[1]] ? 0 : 1;
  const int* start = pattern_.column_start.data() + dofs_.first_dof[ends[end]];
  for (int c = 0; c < 6; ++c) { // each column has one row less before it
    double* to = values.data() + start[c] + below - c;
    const double* from = block.data() + 12 * (6 * end + c) + 6 * (1 - end);
    for (int r = 0; r < 6; ++r)
      to[r] += from[r];
  }
}

/// The platen's row comes last in the columns of a body that touches it.
void LinkAssembly::add_platen(const LinkStiffness& block, const Ends& ends,
                              std::span<double> values) const
{
  for (int end = 0; end < 2; ++end) {
    const Index platen = platen_of(ends[1 - end]), dof = dofs_.first_dof[ends[end]];
    for (int c = 0; c < 6 && platen >= 0 && dof >= 0; ++c)
      if (const int last = pattern_.column_start[dof + c + 1] - 1; pattern_.row[last] == platen)
        values[last] += block(6 * (1 - end) + 2, 6 * end + c);
    if (platen >= 0)
      values[pattern_.column_start[platen]] += block(6 * (1 - end) + 2, 6 * (1 - end) + 2);
  }
}

void LinkAssembly::add_bodies(std::span<const Mat6> own, std::span<const double> hold,
                              std::span<double> values) const
{
  for (std::size_t i = 0; i < own.size(); ++i)
    for (int c = 0; c < 6 && dofs_.first_dof[i] >= 0; ++c) {
      double* column = values.data() + pattern_.column_start[dofs_.first_dof[i] + c];
      for (int r = c; r < 6; ++r)
        column[r - c] = own[i](r, c);
      column[0] += hold[i];
    }
}

} // namespace dem
