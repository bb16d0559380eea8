#include "dem/network_matrix.h"

#include <algorithm>
#include <cassert>

namespace dem {

namespace {

/// Position of an entry of the lower triangle in the list of values.
int entry(const SymmetricPattern& pattern, Index row, Index column)
{
  const auto first = pattern.row.begin() + pattern.column_start[column];
  const auto last = pattern.row.begin() + pattern.column_start[column + 1];
  const auto found = std::lower_bound(first, last, row);
  assert(found != last && *found == row);
  return int(found - pattern.row.begin());
}

} // namespace

SymmetricPattern stiffness_pattern(const ElasticNetwork& network)
{
  const auto n = Index(network.radius.size());
  const Index platen = network.platen_dof;
  std::vector<std::vector<Index>> below(n); // first dofs of neighbours with larger dofs
  std::vector<bool> touches_platen(n, false);
  for (const ElasticNetwork::Bond& bond : network.bonds)
    for (int end = 0; end < 2; ++end) {
      const Index i = bond.ends[end], j = bond.ends[1 - end];
      if (network.first_dof[j] > network.first_dof[i] && network.first_dof[i] >= 0)
        below[i].push_back(network.first_dof[j]);
      if (network.support[j] == Support::top)
        touches_platen[i] = true;
    }
  SymmetricPattern pattern;
  pattern.column_start.push_back(0);
  for (Index i = 0; i < n; ++i) {
    const Index first = network.first_dof[i];
    if (first < 0)
      continue;
    std::ranges::sort(below[i]);
    below[i].erase(std::unique(below[i].begin(), below[i].end()), below[i].end());
    for (int k = 0; k < 6; ++k) {
      for (int row = k; row < 6; ++row)
        pattern.row.push_back(first + row);
      for (const Index neighbour : below[i])
        for (int row = 0; row < 6; ++row)
          pattern.row.push_back(neighbour + row);
      if (touches_platen[i] && platen >= 0)
        pattern.row.push_back(platen);
      pattern.column_start.push_back(int(pattern.row.size()));
    }
  }
  if (platen >= 0) {
    pattern.row.push_back(platen);
    pattern.column_start.push_back(int(pattern.row.size()));
  }
  return pattern;
}

double mean_normal_stiffness(const ElasticNetwork& network)
{
  double sum = 0;
  for (const ElasticNetwork::Bond& bond : network.bonds)
    sum += bond.stiffness.normal;
  return sum > 0 ? sum / double(network.bonds.size()) : 1;
}

std::vector<double> stiffness_values(const ElasticNetwork& network, const SymmetricPattern& pattern,
                                     std::span<const BondStatus> status, const Pieces& pieces)
{
  std::vector<double> values(pattern.row.size(), 0.0);
  const auto is_loose = [&](Index i) { return pieces.of(i) == PieceHold::loose; };
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const ElasticNetwork::Bond& bond = network.bonds[b];
    if (status[b] == BondStatus::gone || is_loose(bond.ends[0]))
      continue;
    const int rows = n_modes(status[b]);
    const auto modes = mode_matrix(network, bond).topRows(rows).eval();
    const Eigen::Matrix<double, 12, 12> block = modes.transpose() * modes;
    const std::array<Index, 12> dofs = bond_dofs(network, bond);
    for (int c = 0; c < 12; ++c) {
      int position = -1; // consecutive dofs have consecutive entries
      for (int r = 0; r < 12; ++r) {
        const bool stored = dofs[c] >= 0 && dofs[r] >= dofs[c];
        if (!stored)
          position = -1;
        else {
          const bool next = position >= 0 && r % 6 != 0;
          position = next ? position + 1 : entry(pattern, dofs[r], dofs[c]);
          values[position] += block(r, c);
        }
      }
    }
  }
  const double mean = mean_normal_stiffness(network);
  for (std::size_t i = 0; i < network.radius.size(); ++i) {
    const PieceHold hold = pieces.of(Index(i));
    if (network.first_dof[i] < 0 || hold == PieceHold::held)
      continue;
    const double ground = hold == PieceHold::clamped ? relative_ground_stiffness * mean : mean;
    for (int k = 0; k < 6; ++k)
      values[pattern.column_start[network.first_dof[i] + k]] += ground;
  }
  return values;
}

} // namespace dem
