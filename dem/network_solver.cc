#include "dem/network_solver.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dem {

namespace {

/// Columns after which a factorisation is cheaper than ever longer updates (6 per bond).
constexpr int most_columns = 900;
/// Bonds that change together from which on a factorisation is cheaper than updates.
constexpr int most_changes = 60;
/// Pivot of I - Y^T Y below which a change leaves (nearly) no stiffness in some direction.
constexpr double smallest_pivot = 1e-10;
/// Residual over load at which a solution is refined, and that it may have then.
constexpr double residual_tolerance = 1e-11, refined_tolerance = 1e-8;
/// Accuracy of an iterated refinement.
constexpr double correction_tolerance = 1e-3;

/// Modes that a bond loses, as columns over its free dofs.
struct LostModes {
  std::vector<Index> dofs;
  Eigen::MatrixXd entries;
};

LostModes lost_modes(const ElasticNetwork& network, Index bond, BondStatus before, BondStatus after)
{
  const ElasticNetwork::Bond& b = network.bonds[bond];
  const Mat6x12 modes = mode_matrix(network, b);
  const std::array<Index, 12> dofs = bond_dofs(network, b);
  const int first = n_modes(after), n = n_modes(before) - first;
  LostModes lost;
  for (const Index dof : dofs)
    if (dof >= 0)
      lost.dofs.push_back(dof);
  lost.entries.resize(Eigen::Index(lost.dofs.size()), n);
  for (int k = 0, row = 0; k < 12; ++k)
    if (dofs[k] >= 0)
      lost.entries.row(row++) = modes.block(first, k, n, 1).transpose();
  return lost;
}

} // namespace

Damage undamaged(const ElasticNetwork& network)
{
  const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
  return {intact, intact, {}};
}

NetworkSolver::NetworkSolver(const ElasticNetwork& network, const Damage& damage,
                             std::size_t most_factored)
    : network_(&network), particle_bonds_(particle_bonds(network)),
      ground_stiffness_(relative_ground_stiffness * mean_normal_stiffness(network)),
      columns_(std::vector<int>{0})
{
  statistics_.iterates = network.radius.size() > most_factored;
  if (!statistics_.iterates) {
    pattern_ = stiffness_pattern(network);
    factor_.emplace(pattern_);
    columns_ = ColumnPanels(factor_->supernode_starts());
  }
  factorise(damage.factorised);
  std::vector<BondStatus> status = damage.factorised;
  for (const std::vector<BondChange>& changes : damage.updates) {
    update(status, changes);
    for (const BondChange& change : changes)
      status[change.bond] = change.status;
  }
  pieces_ = find_pieces(network, status);
  if (!respond(status) && obstacle_.empty())
    obstacle_ = "the remaining bonds and contacts are nearly a mechanism";
}

Damage NetworkSolver::apply(Damage damage, std::span<const BondChange> changes)
{
  const std::vector<BondStatus> before = damage.status;
  for (const BondChange& change : changes)
    damage.status[change.bond] = change.status;
  const Pieces pieces = keeps_pieces(before, damage.status, changes)
                            ? pieces_
                            : find_pieces(*network_, damage.status);
  const bool same_holds = std::ranges::equal(
      pieces.piece, pieces_.piece, {}, [&](int k) { return pieces.hold[k]; },
      [&](int k) { return pieces_.hold[k]; });
  if (std::ssize(changes) <= most_changes &&
      n_changed(damage) + 6 * std::ssize(changes) <= most_columns && same_holds &&
      (network_->platen_dof < 0 || pieces.platens_connected) && update(before, changes)) {
    damage.updates.emplace_back(changes.begin(), changes.end());
    pieces_ = pieces;
    if (respond(damage.status))
      return damage;
  }
  damage.factorised = damage.status;
  damage.updates.clear();
  factorise(damage.status);
  if (!respond(damage.status) && obstacle_.empty())
    obstacle_ = "the remaining bonds and contacts are nearly a mechanism";
  return damage;
}

/// Columns that the updates since the last factorisation take, or would take.
int NetworkSolver::n_changed(const Damage& damage) const
{
  if (!statistics_.iterates)
    return int(columns_.size());
  int n = 0;
  for (const std::vector<BondChange>& changes : damage.updates)
    n += 6 * int(changes.size());
  return n;
}

/// True if the changes surely leave the pieces and what holds them as they are.
bool NetworkSolver::keeps_pieces(std::span<const BondStatus> before,
                                 std::span<const BondStatus> after,
                                 std::span<const BondChange> changes) const
{
  return std::ranges::all_of(changes, [&](const BondChange& change) {
    const auto [a, b] = network_->bonds[change.bond].ends;
    if (before[change.bond] == BondStatus::intact)
      return pieces_.of(a) == PieceHold::held &&
             connected_nearby(*network_, particle_bonds_, after, a, b);
    return pieces_.piece[a] == pieces_.piece[b] && pieces_.of(a) == PieceHold::held;
  });
}

void NetworkSolver::factorise(std::span<const BondStatus> status)
{
  pieces_ = find_pieces(*network_, status);
  columns_.clear();
  complement_.clear();
  reduced_load_.resize(0);
  obstacle_ = equilibrium_obstacle(*network_, pieces_);
  ++statistics_.n_factorisations;
  if (statistics_.iterates) {
    iterative_.reset();
    if (obstacle_.empty())
      iterative_.emplace(*network_, status, pieces_);
    return;
  }
  if (obstacle_.empty() &&
      !factor_->factorise(stiffness_values(*network_, pattern_, status, pieces_)))
    obstacle_ = "the remaining bonds and contacts are a mechanism";
  statistics_.n_factor_nonzeros = factor_->n_nonzeros();
  if (obstacle_.empty())
    half_solved_load_ = factor_->half_solve(network_->unit_load);
}

bool NetworkSolver::update(std::span<const BondStatus> before, std::span<const BondChange> changes)
{
  if (!obstacle_.empty())
    return false;
  for (const BondChange& change : changes) {
    if (iterative_) {
      iterative_->change(change.bond, change.status);
      ++statistics_.n_updates;
      continue;
    }
    const LostModes lost = lost_modes(*network_, change.bond, before[change.bond], change.status);
    if (lost.entries.cols() == 0 || lost.dofs.empty())
      continue;
    if (!remove(factor_->half_solve(lost.dofs, lost.entries)))
      return false;
    ++statistics_.n_updates;
  }
  return true;
}

/// Borders the factor of I - Y^T Y by new columns; false if next to nothing would be left in some
/// direction.
bool NetworkSolver::remove(const SupernodalFactor::SparseColumns& lost)
{
  const int n = lost.n_columns;
  std::vector<Lanes> border = columns_.products(lost); // Y^T Y_new, then -C^-1 of it
  complement_.solve(border);
  std::array<Lanes, n_lanes> gram{}; // Y_new^T (I + Y (I - Y^T Y)^-1 Y^T) Y_new
  const auto add_squares = [&](const std::vector<Lanes>& rows) {
    for (const Lanes& x : rows)
      for (int k = 0; k < n; ++k)
        gram[k] += x[k] * x;
  };
  add_squares(lost.row);
  add_squares(border);
  Eigen::MatrixXd corner = Eigen::MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      corner(i, j) -= gram[i][j];
  const Eigen::LLT<Eigen::MatrixXd> pivots(corner);
  if (pivots.info() != Eigen::Success ||
      pivots.matrixLLT().diagonal().minCoeff() < std::sqrt(smallest_pivot))
    return false;
  Lanes load = no_lanes();
  const std::span<const int> starts = factor_->supernode_starts();
  for (std::size_t p = 0; p < lost.supernode.size(); ++p) {
    const int s = lost.supernode[p];
    for (int i = starts[s]; i < starts[s + 1]; ++i)
      load += lost.row[lost.first_row[p] + i - starts[s]] * half_solved_load_[i];
  }
  for (std::size_t k = 0; k < border.size(); ++k) {
    load += border[k] * reduced_load_[Eigen::Index(k)];
    border[k] = -border[k];
  }
  Eigen::VectorXd fresh(n);
  for (int k = 0; k < n; ++k)
    fresh[k] = load[k];
  pivots.matrixL().solveInPlace(fresh);
  reduced_load_.conservativeResize(reduced_load_.size() + n);
  reduced_load_.tail(n) = fresh;
  complement_.append(border, pivots.matrixLLT());
  columns_.append(lost);
  return true;
}

Eigen::VectorXd NetworkSolver::reduced(const Eigen::VectorXd& half_solved_load) const
{
  Eigen::VectorXd result = columns_.products(half_solved_load);
  complement_.solve(result);
  return result;
}

Eigen::VectorXd NetworkSolver::solved(Eigen::VectorXd half_solved_load,
                                      Eigen::VectorXd reduced_load) const
{
  complement_.solve_transposed(reduced_load);
  columns_.add(reduced_load, half_solved_load);
  return factor_->back_solve(std::move(half_solved_load));
}

NetworkForces NetworkSolver::grounded(std::span<const BondStatus> status,
                                      const Eigen::VectorXd& x) const
{
  NetworkForces forces = network_forces(*network_, status, x);
  for (std::size_t i = 0; i < network_->radius.size(); ++i)
    if (const Index dof = network_->first_dof[i];
        dof >= 0 && pieces_.of(Index(i)) == PieceHold::clamped)
      forces.nodal.segment<6>(dof) += ground_stiffness_ * x.segment<6>(dof);
  return forces;
}

Eigen::VectorXd NetworkSolver::unit_solution()
{
  return iterative_ ? iterated(network_->unit_load, iteration_tolerance)
                    : solved(half_solved_load_, reduced_load_);
}

Eigen::VectorXd NetworkSolver::correction(const Eigen::VectorXd& residual)
{
  if (iterative_)
    return iterated(residual, correction_tolerance);
  const Eigen::VectorXd y = factor_->half_solve(residual);
  return solved(y, reduced(y));
}

Eigen::VectorXd NetworkSolver::iterated(const Eigen::VectorXd& load, double tolerance)
{
  IterativeSolution solution = iterative_->solve(load, tolerance);
  statistics_.n_iterations += solution.n_iterations;
  if (solution.end == IterationEnd::no_stiffness)
    obstacle_ = "the remaining bonds and contacts are a mechanism";
  else if (solution.end == IterationEnd::too_many)
    obstacle_ = fmt::format("the iteration for the displacements did not converge in {} steps",
                            solution.n_iterations);
  return std::move(solution.x);
}

/// False if there is no response, or none that fulfils the equations.
bool NetworkSolver::respond(std::span<const BondStatus> status)
{
  response_.reset();
  if (!obstacle_.empty())
    return false;
  Eigen::VectorXd x = unit_solution();
  if (!obstacle_.empty())
    return false;
  NetworkForces forces = grounded(status, x);
  const double load = network_->unit_load.norm();
  if (const Eigen::VectorXd residual = network_->unit_load - forces.nodal;
      !(residual.norm() <= residual_tolerance * load)) {
    x += correction(residual);
    forces = grounded(status, x);
    ++statistics_.n_refinements;
    if (!((network_->unit_load - forces.nodal).norm() <= refined_tolerance * load))
      return false;
  }
  const double work = network_->unit_load.dot(x);
  double ground_work = 0;
  for (std::size_t i = 0; i < network_->radius.size(); ++i)
    if (const Index dof = network_->first_dof[i];
        dof >= 0 && pieces_.of(Index(i)) == PieceHold::clamped)
      ground_work += ground_stiffness_ * x.segment<6>(dof).squaredNorm();
  ground_energy_share_ = work > 0 ? ground_work / work : 0;
  bond_forces_ = std::move(forces.bond);
  response_ = std::move(x);
  return true;
}

} // namespace dem
