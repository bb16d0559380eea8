#include "dem/connectivity.h"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace dem {

namespace {

/// Disjoint sets with path halving.
class DisjointSets {
public:
  explicit DisjointSets(std::size_t n) : parent_(n)
  {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int i)
  {
    while (parent_[i] != i)
      i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(int i, int j) { parent_[find(i)] = find(j); }

private:
  std::vector<int> parent_;
};

/// Particles, then the lower and the upper platen.
DisjointSets glued_sets(const ElasticNetwork& network)
{
  const std::size_t n = network.radius.size();
  DisjointSets sets(n + 2);
  for (std::size_t i = 0; i < n; ++i)
    if (network.support[i] != Support::free)
      sets.unite(int(i), int(n) + (network.support[i] == Support::top));
  return sets;
}

bool is_loaded(const ElasticNetwork& network, Index particle)
{
  const Index dof = network.first_dof[particle];
  return dof >= 0 && !network.unit_load.segment<6>(dof).isZero(0);
}

} // namespace

Pieces find_pieces(const ElasticNetwork& network, std::span<const BondStatus> status)
{
  const auto n = Index(network.radius.size());
  DisjointSets firm = glued_sets(network), touching = glued_sets(network);
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const auto [i, j] = network.bonds[b].ends;
    if (status[b] == BondStatus::intact)
      firm.unite(i, j);
    if (status[b] != BondStatus::gone)
      touching.unite(i, j);
  }
  std::vector<int> number(n + 2, -1);
  Pieces pieces;
  for (Index i = 0; i < n; ++i) {
    int& k = number[firm.find(i)];
    if (k < 0) {
      k = int(pieces.hold.size());
      pieces.hold.push_back(PieceHold::loose);
    }
    pieces.piece.push_back(k);
  }
  for (std::size_t b = 0; b < network.bonds.size(); ++b)
    if (status[b] == BondStatus::pressed)
      for (const Index end : network.bonds[b].ends)
        pieces.hold[pieces.piece[end]] = PieceHold::clamped;
  for (Index i = 0; i < n; ++i)
    if (is_loaded(network, i) && pieces.of(i) == PieceHold::loose)
      pieces.hold[pieces.piece[i]] = PieceHold::dropped;
  for (Index i = 0; i < n; ++i)
    if (network.support[i] != Support::free)
      pieces.hold[pieces.piece[i]] = PieceHold::held;
  pieces.platens_connected = touching.find(n) == touching.find(n + 1);
  return pieces;
}

ParticleBonds particle_bonds(const ElasticNetwork& network)
{
  ParticleBonds result{std::vector<Index>(network.radius.size() + 1, 0), {}};
  for (const ElasticNetwork::Bond& bond : network.bonds)
    for (const Index end : bond.ends)
      ++result.start[end + 1];
  std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
  result.bond.resize(result.start.back());
  std::vector<Index> next = result.start;
  for (std::size_t b = 0; b < network.bonds.size(); ++b)
    for (const Index end : network.bonds[b].ends)
      result.bond[next[end]++] = Index(b);
  return result;
}

bool connected_nearby(const ElasticNetwork& network, const ParticleBonds& bonds,
                      std::span<const BondStatus> status, Index from, Index to)
{
  constexpr std::size_t most_visited = 200;
  std::vector<Index> visited{from};
  for (std::size_t k = 0; k < visited.size() && visited.size() < most_visited; ++k)
    for (const Index b : bonds.of(visited[k])) {
      if (status[b] != BondStatus::intact)
        continue;
      const auto& ends = network.bonds[b].ends;
      const Index other = ends[0] == visited[k] ? ends[1] : ends[0];
      if (other == to)
        return true;
      if (std::find(visited.begin(), visited.end(), other) == visited.end())
        visited.push_back(other);
    }
  return false;
}

std::string equilibrium_obstacle(const ElasticNetwork& network, const Pieces& pieces)
{
  if (network.platen_dof >= 0 && !pieces.platens_connected)
    return "no chain of bonds connects the platens any more";
  if (network.n_dofs == 0)
    return "all particles are held: there is nothing to move";
  for (std::size_t i = 0; i < pieces.piece.size(); ++i)
    if (pieces.of(Index(i)) == PieceHold::dropped)
      return fmt::format("particle {} is part of a piece that is loaded, but nothing holds it", i);
  return {};
}

int n_free_modes(const ElasticNetwork& network, std::span<const BondStatus> status, Index particle)
{
  std::vector<Vec6> rows;
  for (std::size_t b = 0; b < network.bonds.size(); ++b)
    for (int end = 0; end < 2; ++end)
      if (network.bonds[b].ends[end] == particle) {
        const Mat6x12 modes = mode_matrix(network, network.bonds[b]);
        for (int m = 0; m < n_modes(status[b]); ++m)
          if (const Vec6 row = modes.block<1, 6>(m, 6 * end); row.norm() > 0)
            rows.push_back(row.normalized());
      }
  if (rows.empty())
    return 6;
  Eigen::MatrixXd matrix(rows.size(), 6);
  for (std::size_t r = 0; r < rows.size(); ++r)
    matrix.row(Eigen::Index(r)) = rows[r];
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  qr.setThreshold(1e-10);
  return 6 - int(qr.rank());
}

} // namespace dem
