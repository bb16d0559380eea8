#include "dem/iterative_solver.h"

#include "dem/network_matrix.h"

#include <algorithm>
#include <limits>

namespace dem {

namespace {

/// Iterations at which a solution is given up; 30 is usual.
constexpr int most_iterations = 1000;

/// Modes of a bond that its status leaves, others zero, by the dofs of its two ends.
struct BondModes {
  Mat6x12 rows;

  auto of(int end) const { return rows.middleCols<6>(6 * end); }
};

BondModes bond_modes(const ElasticNetwork& network, Index bond, BondStatus status)
{
  BondModes modes{mode_matrix(network, network.bonds[bond])};
  modes.rows.bottomRows(6 - n_modes(status)).setZero();
  return modes;
}

/// What the particles and the platen feel when the platen is displaced by one.
struct PlatenColumn {
  Eigen::VectorXd particles;
  double platen = 0; ///< [N/m]
};

PlatenColumn platen_column(const ElasticNetwork& network, std::span<const BondStatus> status,
                           std::span<const Index> row, Index n_rows)
{
  PlatenColumn column{Eigen::VectorXd::Zero(6 * Eigen::Index(n_rows))};
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const auto& ends = network.bonds[b].ends;
    const auto is_top = [&](int end) { return network.support[ends[end]] == Support::top; };
    if (is_top(0) == is_top(1) || status[b] == BondStatus::gone)
      continue;
    const int top = is_top(0) ? 0 : 1;
    const BondModes modes = bond_modes(network, Index(b), status[b]);
    const Vec6 strained = modes.of(top).col(2);
    column.platen += strained.squaredNorm();
    if (const Index other = row[ends[1 - top]]; other >= 0)
      column.particles.segment<6>(6 * Eigen::Index(other)) +=
          modes.of(1 - top).transpose() * strained;
  }
  return column;
}

/// Rigid motions of a particle, displacement and radius times rotation, as six columns.
Mat6 rigid_motions(const Vec3& centre, double radius, double size)
{
  Mat6 motions = Mat6::Identity();
  for (int k = 0; k < 3; ++k)
    motions.block<3, 1>(0, 3 + k) = Vec3::Unit(k).cross(centre) / size;
  motions.diagonal().tail<3>().setConstant(radius / size);
  return motions;
}

/// Particles that have equations, neighbours near each other: breadth-first by their bonds.
std::vector<Index> ordered_particles(const ElasticNetwork& network, const ParticleBonds& bonds,
                                     const Pieces& pieces)
{
  std::vector<bool> waits(network.radius.size());
  for (std::size_t i = 0; i < waits.size(); ++i)
    waits[i] = network.first_dof[i] >= 0 && pieces.of(Index(i)) != PieceHold::loose;
  std::vector<Index> order;
  const auto take = [&](Index i) {
    if (waits[i])
      order.push_back(i);
    waits[i] = false;
  };
  std::size_t next = 0;
  for (std::size_t first = 0; first < waits.size(); ++first) {
    take(Index(first));
    for (; next < order.size(); ++next)
      for (const Index b : bonds.of(order[next]))
        for (const Index end : network.bonds[b].ends)
          take(end);
  }
  return order;
}

} // namespace

IterativeSolver::IterativeSolver(const ElasticNetwork& network, std::span<const BondStatus> status,
                                 const Pieces& pieces)
    : network_(&network), particle_bonds_(particle_bonds(network)),
      particle_(ordered_particles(network, particle_bonds_, pieces)),
      row_(network.radius.size(), -1), status_(status.begin(), status.end())
{
  const double weak = relative_ground_stiffness * mean_normal_stiffness(network);
  for (std::size_t k = 0; k < particle_.size(); ++k) {
    row_[particle_[k]] = Index(k);
    ground_.push_back(pieces.of(particle_[k]) == PieceHold::clamped ? weak : 0.0);
  }
  multigrid_.emplace(matrix(), near_null());
}

BlockMatrix IterativeSolver::matrix() const
{
  BlockMatrix result;
  const std::size_t most_blocks = particle_.size() + particle_bonds_.bond.size();
  result.column.reserve(most_blocks);
  result.block.reserve(most_blocks);
  for (const Index particle : particle_) {
    const std::size_t first = result.column.size();
    result.column.push_back(row_[particle]);
    for (const Index b : particle_bonds_.of(particle))
      if (const Index other = row_[other_end(b, particle)];
          other >= 0 && status_[b] != BondStatus::gone)
        result.column.push_back(other);
    std::sort(result.column.begin() + std::ptrdiff_t(first), result.column.end());
    result.block.resize(result.column.size());
    result.row_start.push_back(result.column.size());
    result.block[block_position(result, row_[particle], row_[particle])] = diagonal_block(particle);
    for (const Index b : particle_bonds_.of(particle))
      if (const Index other = row_[other_end(b, particle)];
          other >= 0 && status_[b] != BondStatus::gone)
        result.block[block_position(result, row_[particle], other)] = coupling(b, particle);
  }
  return result;
}

std::vector<Mat6> IterativeSolver::near_null() const
{
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec3& centre : network_->centre) {
    low = low.cwiseMin(centre);
    high = high.cwiseMax(centre);
  }
  const double size = std::max((high - low).norm(), network_->radius.front());
  std::vector<Mat6> result;
  result.reserve(particle_.size());
  for (const Index i : particle_)
    result.push_back(
        rigid_motions(network_->centre[i] - 0.5 * (low + high), network_->radius[i], size));
  return result;
}

Index IterativeSolver::other_end(Index bond, Index particle) const
{
  const auto& ends = network_->bonds[bond].ends;
  return ends[0] == particle ? ends[1] : ends[0];
}

Mat6 IterativeSolver::coupling(Index bond, Index particle) const
{
  const int end = network_->bonds[bond].ends[0] == particle ? 0 : 1;
  const BondModes modes = bond_modes(*network_, bond, status_[bond]);
  return modes.of(end).transpose() * modes.of(1 - end);
}

Mat6 IterativeSolver::diagonal_block(Index particle) const
{
  Mat6 sum = ground_[row_[particle]] * Mat6::Identity();
  for (const Index b : particle_bonds_.of(particle)) {
    const int end = network_->bonds[b].ends[0] == particle ? 0 : 1;
    const BondModes modes = bond_modes(*network_, b, status_[b]);
    sum.noalias() += modes.of(end).transpose() * modes.of(end);
  }
  return sum;
}

void IterativeSolver::change(Index bond, BondStatus status)
{
  status_[bond] = status;
  for (const Index end : network_->bonds[bond].ends) {
    if (row_[end] < 0)
      continue;
    multigrid_->replace(row_[end], row_[end], diagonal_block(end));
    if (const Index other = row_[other_end(bond, end)]; other >= 0)
      multigrid_->replace(row_[end], other, coupling(bond, end));
  }
}

IterativeSolution IterativeSolver::solve_particles(
    const Eigen::VectorXd& load,
    const std::function<bool(const IterationProgress&)>& is_precise) const
{
  return conjugate_gradients([&](const auto& x) { return product(multigrid_->matrix(), x); }, load,
                             [&](const auto& r) { return multigrid_->cycle(r); }, is_precise,
                             most_iterations);
}

IterativeSolution IterativeSolver::solve(const Eigen::VectorXd& load, double tolerance) const
{
  const auto n_rows = Index(particle_.size());
  Eigen::VectorXd on_particles(6 * Eigen::Index(n_rows));
  for (Index k = 0; k < n_rows; ++k)
    on_particles.segment<6>(6 * Eigen::Index(k)) =
        load.segment<6>(network_->first_dof[particle_[k]]);
  const double allowed = tolerance * load.norm();
  IterativeSolution solution = solve_particles(
      on_particles, [&](const IterationProgress& p) { return p.residual <= allowed; });
  double platen = 0;
  if (network_->platen_dof >= 0 && solution.end == IterationEnd::converged) {
    const auto [column, stiffness] = platen_column(*network_, status_, row_, n_rows);
    // with the platen displaced by one, its force falls from that of bonds to particles at rest
    IterativeSolution lifted = solve_particles(-column, [&](const IterationProgress& p) {
      return p.residual <= tolerance * (stiffness - p.work);
    });
    const double force = load[network_->platen_dof] - column.dot(solution.x);
    platen = force / (stiffness + column.dot(lifted.x));
    solution.x += platen * lifted.x;
    solution.end = lifted.end;
    solution.n_iterations += lifted.n_iterations;
  }
  Eigen::VectorXd dofs = Eigen::VectorXd::Zero(network_->n_dofs);
  for (Index k = 0; k < n_rows; ++k)
    dofs.segment<6>(network_->first_dof[particle_[k]]) = solution.x.segment<6>(6 * Eigen::Index(k));
  if (network_->platen_dof >= 0)
    dofs[network_->platen_dof] = platen;
  solution.x = std::move(dofs);
  return solution;
}

} // namespace dem
