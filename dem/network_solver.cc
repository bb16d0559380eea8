#include "dem/network_solver.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

/// Columns after which a factorisation is cheaper than ever longer updates (6 per bond).
constexpr int most_columns = 1200;
/// Bonds that change together from which on a factorisation is cheaper than updates.
constexpr int most_changes = 60;
/// Pivot of I - Y^T Y below which a change leaves (nearly) no stiffness in some direction.
constexpr double smallest_pivot = 1e-10;
constexpr double residual_tolerance = 1e-11;

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

NetworkSolver::NetworkSolver(const ElasticNetwork& network, const Damage& damage)
    : network_(&network), pattern_(stiffness_pattern(network)), factor_(pattern_)
{
  factorise(damage.factorised);
  std::vector<BondStatus> status = damage.factorised;
  for (const std::vector<BondChange>& changes : damage.updates) {
    update(status, changes);
    for (const BondChange& change : changes)
      status[change.bond] = change.status;
  }
  respond(status);
}

Damage NetworkSolver::apply(Damage damage, std::span<const BondChange> changes)
{
  const std::vector<BondStatus> before = damage.status;
  for (const BondChange& change : changes)
    damage.status[change.bond] = change.status;
  const Pieces pieces = find_pieces(*network_, damage.status);
  const bool same_holds = std::ranges::equal(
      pieces.piece, pieces_.piece, {}, [&](int k) { return pieces.hold[k]; },
      [&](int k) { return pieces_.hold[k]; });
  if (std::ssize(changes) <= most_changes && n_columns_ + 6 * std::ssize(changes) <= most_columns &&
      same_holds && update(before, changes)) {
    damage.updates.emplace_back(changes.begin(), changes.end());
    pieces_ = pieces;
  } else {
    damage.factorised = damage.status;
    damage.updates.clear();
    factorise(damage.status);
  }
  respond(damage.status);
  return damage;
}

void NetworkSolver::factorise(std::span<const BondStatus> status)
{
  pieces_ = find_pieces(*network_, status);
  columns_.clear();
  first_column_.clear();
  n_columns_ = 0;
  cholesky_.resize(0, 0);
  reduced_load_.resize(0);
  obstacle_ = equilibrium_obstacle(*network_, pieces_);
  ++statistics_.n_factorisations;
  if (obstacle_.empty() &&
      !factor_.factorise(stiffness_values(*network_, pattern_, status, pieces_)))
    obstacle_ = "the remaining bonds and contacts are a mechanism";
  statistics_.n_factor_nonzeros = factor_.n_nonzeros();
  if (obstacle_.empty())
    half_solved_load_ = factor_.half_solve(network_->unit_load);
}

bool NetworkSolver::update(std::span<const BondStatus> before, std::span<const BondChange> changes)
{
  if (!obstacle_.empty())
    return false;
  for (const BondChange& change : changes) {
    const LostModes lost = lost_modes(*network_, change.bond, before[change.bond], change.status);
    const Eigen::Index n = lost.entries.cols(), n_before = n_columns_;
    if (n == 0 || lost.dofs.empty())
      continue;
    SupernodalFactor::SparseColumns block = factor_.half_solve(lost.dofs, lost.entries);
    Eigen::MatrixXd border(n_before, n); // cholesky_^-1 (-Y_before^T Y_new)
    for (std::size_t k = 0; k < columns_.size(); ++k)
      border.middleRows(first_column_[k], columns_[k].values.cols()) =
          -factor_.gram(columns_[k], block);
    const auto lower = cholesky_.topLeftCorner(n_before, n_before).triangularView<Eigen::Lower>();
    lower.solveInPlace(border);
    Eigen::MatrixXd corner = Eigen::MatrixXd::Identity(n, n) - factor_.gram(block, block);
    corner.noalias() -= border.transpose() * border;
    const Eigen::LLT<Eigen::MatrixXd> pivots(corner);
    if (pivots.info() != Eigen::Success ||
        pivots.matrixLLT().diagonal().minCoeff() < std::sqrt(smallest_pivot))
      return false;
    if (n_before + n > cholesky_.rows()) {
      const Eigen::Index size = std::max<Eigen::Index>(2 * cholesky_.rows(), n_before + n + 60);
      Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(size, size);
      larger.topLeftCorner(n_before, n_before) = cholesky_.topLeftCorner(n_before, n_before);
      cholesky_ = std::move(larger);
    }
    cholesky_.block(n_before, 0, n, n_before) = border.transpose();
    cholesky_.block(n_before, n_before, n, n) = pivots.matrixL();
    Eigen::VectorXd load = factor_.gram(block, half_solved_load_);
    load.noalias() -= border.transpose() * reduced_load_;
    pivots.matrixL().solveInPlace(load);
    reduced_load_.conservativeResize(n_before + n);
    reduced_load_.tail(n) = load;
    first_column_.push_back(n_columns_);
    columns_.push_back(std::move(block));
    n_columns_ += int(n);
    ++statistics_.n_updates;
  }
  return true;
}

Eigen::VectorXd NetworkSolver::reduced(const Eigen::VectorXd& half_solved_load) const
{
  Eigen::VectorXd result(n_columns_);
  for (std::size_t k = 0; k < columns_.size(); ++k)
    result.segment(first_column_[k], columns_[k].values.cols()) =
        factor_.gram(columns_[k], half_solved_load);
  cholesky_.topLeftCorner(n_columns_, n_columns_)
      .triangularView<Eigen::Lower>()
      .solveInPlace(result);
  return result;
}

Eigen::VectorXd NetworkSolver::solved(const Eigen::VectorXd& half_solved_load,
                                      const Eigen::VectorXd& reduced_load) const
{
  Eigen::VectorXd weights = reduced_load;
  cholesky_.topLeftCorner(n_columns_, n_columns_)
      .triangularView<Eigen::Lower>()
      .transpose()
      .solveInPlace(weights);
  Eigen::VectorXd y = half_solved_load;
  for (std::size_t k = 0; k < columns_.size(); ++k)
    factor_.add(columns_[k], weights.segment(first_column_[k], columns_[k].values.cols()), y);
  return factor_.back_solve(std::move(y));
}

Eigen::VectorXd NetworkSolver::grounded(std::span<const BondStatus> status,
                                        const Eigen::VectorXd& x) const
{
  Eigen::VectorXd force = stiffness_times(*network_, status, x);
  const double ground = relative_ground_stiffness * mean_normal_stiffness(*network_);
  for (std::size_t i = 0; i < network_->radius.size(); ++i)
    if (const Index dof = network_->first_dof[i];
        dof >= 0 && pieces_.of(Index(i)) == PieceHold::clamped)
      force.segment<6>(dof) += ground * x.segment<6>(dof);
  return force;
}

void NetworkSolver::respond(std::span<const BondStatus> status)
{
  response_.reset();
  if (!obstacle_.empty())
    return;
  Eigen::VectorXd x = solved(half_solved_load_, reduced_load_);
  const double load = network_->unit_load.norm();
  const Eigen::VectorXd residual = network_->unit_load - grounded(status, x);
  if (residual.norm() > residual_tolerance * load) {
    const Eigen::VectorXd y = factor_.half_solve(residual);
    x += solved(y, reduced(y));
    ++statistics_.n_refinements;
  }
  const double work = network_->unit_load.dot(x);
  const double ground = relative_ground_stiffness * mean_normal_stiffness(*network_);
  double ground_work = 0;
  for (std::size_t i = 0; i < network_->radius.size(); ++i)
    if (const Index dof = network_->first_dof[i];
        dof >= 0 && pieces_.of(Index(i)) == PieceHold::clamped)
      ground_work += ground * x.segment<6>(dof).squaredNorm();
  ground_energy_share_ = work > 0 ? ground_work / work : 0;
  response_ = std::move(x);
}

} // namespace dem
