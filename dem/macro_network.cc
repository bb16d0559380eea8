#include "dem/macro_network.h"

#include "dem/network_matrix.h"

#include <stdexcept>

namespace dem {

namespace {

/// Nothing is loose: pins are added here.
Pieces one_held_piece(std::size_t n_particles)
{
  return {std::vector<int>(n_particles, 0), {PieceHold::held}, true};
}

BondModes bond_modes(const ElasticNetwork& network, ElasticNetwork::Bond bond, double law_stiffness)
{
  const auto [normal, shear, torsion, bending] = bond.stiffness;
  Vec6 weight;
  weight << normal, shear, shear, torsion, bending, bending;
  bond.stiffness = {1, 1, 1, 1};
  BondModes modes{mode_matrix(network, bond), Mat6::Zero(), weight / law_stiffness};
  const Mat3 frame = modes.motion.block<3, 3>(0, 6);
  const Vec3 branch = bond.arm_a - bond.arm_b;
  for (int k = 0; k < 6; ++k)
    modes.strain.block<3, 1>(0, k) = frame * (from_mandel(Vec6::Unit(k)) * branch);
  return modes;
}

/// The network if the springs of the laws had these stiffnesses.
ElasticNetwork with_stiffness(const MacroNetwork& macro, std::span<const double> law_stiffness)
{
  ElasticNetwork network = macro.network;
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const Vec6 modal = modal_stiffness(macro, b, law_stiffness);
    network.bonds[b].stiffness = {modal[0], modal[1], modal[3], modal[4]};
  }
  return network;
}

/// Axes about which a cluster that is endless in these directions can turn.
Mat3 free_axes(std::span<const Vec3> direction)
{
  if (direction.empty())
    return Mat3::Identity();
  if (direction.size() > 1)
    return Mat3::Zero();
  const Vec3 axis = direction.front().normalized();
  return axis * axis.transpose();
}

} // namespace

MacroNetwork make_macro_network(const VolumeElement& element)
{
  MacroNetwork macro{make_network(element), {}, element.bonds.law, {}, {}, element.cell.volume()};
  for (const BondLaw& law : element.laws)
    macro.law_stiffness.push_back(law.creep.maxwell_stiffness);
  for (std::size_t b = 0; b < element.bonds.size(); ++b)
    macro.bonds.push_back(
        bond_modes(macro.network, macro.network.bonds[b], macro.law_stiffness[macro.law[b]]));
  macro.status.assign(element.bonds.size(), BondStatus::intact);
  return macro;
}

Eigen::Matrix<double, 12, Eigen::Dynamic> end_motion(const MacroNetwork& macro, std::size_t bond,
                                                     const Eigen::MatrixXd& dofs)
{
  Eigen::Matrix<double, 12, Eigen::Dynamic> result(12, dofs.cols());
  for (int end = 0; end < 2; ++end) {
    const Index first = macro.network.first_dof[macro.network.bonds[bond].ends[end]];
    if (first < 0)
      result.middleRows<6>(6 * end).setZero();
    else
      result.middleRows<6>(6 * end) = dofs.middleRows<6>(first);
  }
  return result;
}

void add_end_forces(const MacroNetwork& macro, std::size_t bond,
                    const Eigen::Ref<const Eigen::Matrix<double, 12, Eigen::Dynamic>>& forces,
                    Eigen::MatrixXd& nodal)
{
  for (int end = 0; end < 2; ++end) {
    const Index first = macro.network.first_dof[macro.network.bonds[bond].ends[end]];
    if (first >= 0)
      nodal.middleRows<6>(first) += forces.middleRows<6>(6 * end);
  }
}

Vec6 carried_stiffness(const MacroNetwork& macro, std::size_t bond,
                       std::span<const double> law_stiffness)
{
  Vec6 stiffness = modal_stiffness(macro, bond, law_stiffness);
  stiffness.tail(6 - n_modes(macro.status[bond])).setZero();
  return stiffness;
}

Eigen::MatrixXd strain_loads(const MacroNetwork& macro, std::span<const double> law_stiffness)
{
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(macro.n_dofs(), 6);
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    if (macro.status[b] == BondStatus::gone)
      continue;
    const BondModes& modes = macro.bonds[b];
    const Mat6 force = carried_stiffness(macro, b, law_stiffness).asDiagonal() * modes.strain;
    add_end_forces(macro, b, modes.motion.transpose() * force, loads);
  }
  return loads;
}

Mat6 affine_energy(const MacroNetwork& macro, std::span<const double> law_stiffness)
{
  Mat6 sum = Mat6::Zero();
  for (std::size_t b = 0; b < macro.bonds.size(); ++b)
    sum += macro.bonds[b].strain.transpose() *
           carried_stiffness(macro, b, law_stiffness).asDiagonal() * macro.bonds[b].strain;
  return sum;
}

Eigen::SparseMatrix<double> stiffness_matrix(const MacroNetwork& macro,
                                             std::span<const double> law_stiffness)
{
  const ElasticNetwork network = with_stiffness(macro, law_stiffness);
  const SymmetricPattern pattern = stiffness_pattern(network);
  const std::vector<double> values =
      stiffness_values(network, pattern, macro.status, one_held_piece(network.radius.size()));
  const int n = pattern.size();
  return Eigen::Map<const Eigen::SparseMatrix<double>>(n, n, Eigen::Index(values.size()),
                                                       pattern.column_start.data(),
                                                       pattern.row.data(), values.data());
}

std::vector<Pin> rigid_motion_pins(const Clusters& clusters, const ElasticNetwork& network)
{
  std::vector<Pin> pins;
  for (const Cluster& cluster : clusters.cluster) {
    bool is_held = false;
    for (const Index i : cluster.particles)
      is_held |= network.first_dof[i] < 0;
    if (!is_held)
      pins.push_back({cluster.particles.front(), free_axes(cluster.direction)});
  }
  return pins;
}

MacroSolver::MacroSolver(const MacroNetwork& macro)
    : pattern_(stiffness_pattern(macro.network)), factor_(pattern_)
{
}

MacroSolver::MacroSolver(const MacroNetwork& macro, std::span<const Pin> pins,
                         std::span<const double> law_stiffness)
    : MacroSolver(macro)
{
  if (!factorise(macro, pins, one_held_piece(macro.network.radius.size()), law_stiffness))
    throw std::runtime_error("the stiffness matrix of the volume element is not positive definite");
}

bool MacroSolver::factorise(const MacroNetwork& macro, std::span<const Pin> pins,
                            const Pieces& pieces, std::span<const double> law_stiffness)
{
  const ElasticNetwork network = with_stiffness(macro, law_stiffness);
  values_ = stiffness_values(network, pattern_, macro.status, pieces);
  const double spring = mean_normal_stiffness(network);
  for (const auto& [particle, rotation] : pins)
    for (int k = 0; k < 3; ++k) {
      const Index first = network.first_dof[particle];
      values_[pattern_.column_start[first + k]] += spring;
      for (int row = k; row < 3; ++row) // a column holds its rows from the diagonal on
        values_[pattern_.column_start[first + 3 + k] + row - k] += spring * rotation(row, k);
    }
  return pattern_.size() == 0 || factor_.factorise(values_);
}

Eigen::MatrixXd MacroSolver::product(const Eigen::MatrixXd& dofs) const
{
  const int n = pattern_.size();
  const Eigen::Map<const Eigen::SparseMatrix<double>> matrix(n, n, Eigen::Index(values_.size()),
                                                             pattern_.column_start.data(),
                                                             pattern_.row.data(), values_.data());
  return matrix.selfadjointView<Eigen::Lower>() * dofs;
}

Eigen::MatrixXd MacroSolver::solve_once(const Eigen::MatrixXd& forces) const
{
  Eigen::MatrixXd result(forces.rows(), forces.cols());
  for (Eigen::Index c = 0; c < forces.cols(); ++c)
    result.col(c) = factor_.back_solve(factor_.half_solve(forces.col(c)));
  return result;
}

Eigen::MatrixXd MacroSolver::solve(const Eigen::MatrixXd& forces) const
{
  if (pattern_.size() == 0)
    return Eigen::MatrixXd::Zero(0, forces.cols());
  const Eigen::MatrixXd first = solve_once(forces);
  return first + solve_once(forces - product(first));
}

} // namespace dem
