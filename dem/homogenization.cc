#include "dem/homogenization.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

using Mat3x6 = Eigen::Matrix<double, 3, 6>;
using Mat9x6 = Eigen::Matrix<double, 9, 6>;

/// Force and moment of a bond in global axes from the loads of its modes.
BondLocalization global_load(const MacroNetwork& macro, std::size_t b, const Mat6& modal)
{
  const Mat3 frame = macro.bonds[b].motion.block<3, 3>(0, 6);
  return {frame.transpose() * modal.topRows<3>(), frame.transpose() * modal.bottomRows<3>()};
}

Vec3 branch(const MacroNetwork& macro, std::size_t b)
{
  return macro.network.bonds[b].arm_a - macro.network.bonds[b].arm_b;
}

/// Stress, energy and their checks, from the loads of the bonds.
void measure(const MacroNetwork& macro, Homogenization& result)
{
  Mat9x6 stress = Mat9x6::Zero();
  Mat6 energy = Mat6::Zero();
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    const auto& [force, moment] = result.per_strain[b];
    const Vec3 between = branch(macro, b);
    for (int k = 0; k < 6; ++k)
      Eigen::Map<Mat3>(stress.col(k).data()) += force.col(k) * between.transpose() / result.volume;
    const Mat3 frame = macro.bonds[b].motion.block<3, 3>(0, 6);
    Mat6 modal;
    modal << frame * force, frame * moment;
    const Vec6 stiffness = modal_stiffness(macro, b, macro.law_stiffness);
    energy += modal.transpose() * stiffness.cwiseInverse().asDiagonal() * modal / result.volume;
  }
  double skew = 0;
  for (int k = 0; k < 6; ++k) {
    const Mat3 sigma = Eigen::Map<const Mat3>(stress.col(k).data());
    result.stiffness.col(k) = to_mandel(sigma);
    skew = std::max(skew, (sigma - sigma.transpose()).norm());
  }
  const double size = result.stiffness.norm();
  result.asymmetry = size > 0 ? skew / size : 0;
  result.hill_mandel = size > 0 ? (energy - result.stiffness).norm() / size : 0;
  result.stiffness = (0.5 * (result.stiffness + result.stiffness.transpose())).eval();
}

std::vector<BondStatus> all_intact(const VolumeElement& element)
{
  return std::vector<BondStatus>(element.bonds.size(), BondStatus::intact);
}

/// Clusters of the element as if the given bonds were cut.
Clusters clusters_of(const VolumeElement& element, const MacroNetwork& macro)
{
  return find_clusters(element, macro.status);
}

std::vector<Index> loose_particles(const VolumeElement& element)
{
  std::vector<Index> loose;
  for (const Cluster& cluster : find_clusters(element, all_intact(element)).cluster)
    if (element.is_periodic ? cluster.direction.empty() : cluster.particles.size() == 1)
      loose.insert(loose.end(), cluster.particles.begin(), cluster.particles.end());
  std::ranges::sort(loose);
  return loose;
}

void hold(ElasticNetwork& network, const std::vector<bool>& is_held)
{
  network.n_dofs = 0;
  for (std::size_t i = 0; i < is_held.size(); ++i) {
    network.first_dof[i] = is_held[i] ? -1 : network.n_dofs;
    network.n_dofs += is_held[i] ? 0 : 6;
    network.support[i] = is_held[i] ? Support::bottom : Support::free;
  }
  network.unit_load = Eigen::VectorXd::Zero(network.n_dofs);
}

std::vector<bool> boundary_particles(const VolumeElement& element)
{
  std::vector<bool> result(element.particles.size(), false);
  for (const BoundaryParticle& each : element.boundary)
    result[each.particle] = true;
  for (std::size_t b = 0; b < element.bonds.size(); ++b)
    if (!element.shift[b].isZero())
      for (const Index end : element.bonds.ends[b])
        result[end] = true;
  return result;
}

Homogenization by_displacement(const VolumeElement& element, BoundaryCondition condition)
{
  MacroNetwork macro = make_macro_network(element);
  const std::size_t n = element.particles.size();
  if (condition != BoundaryCondition::periodic)
    hold(macro.network, condition == BoundaryCondition::affine ? std::vector<bool>(n, true)
                                                               : boundary_particles(element));
  Eigen::MatrixXd dofs(macro.n_dofs(), 6);
  if (macro.n_dofs() > 0) {
    const auto pins = rigid_motion_pins(clusters_of(element, macro), macro.network);
    const MacroSolver solver(macro, pins, macro.law_stiffness);
    dofs = -solver.solve(strain_loads(macro, macro.law_stiffness));
  }
  Homogenization result{};
  result.condition = condition;
  result.volume = macro.volume;
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    const Mat6 deformation =
        macro.bonds[b].strain + macro.bonds[b].motion * end_motion(macro, b, dofs);
    result.per_strain.push_back(global_load(
        macro, b, modal_stiffness(macro, b, macro.law_stiffness).asDiagonal() * deformation));
  }
  measure(macro, result);
  result.fluctuation = Eigen::MatrixXd::Zero(6 * Eigen::Index(n), 6);
  for (std::size_t i = 0; i < n; ++i)
    if (const Index first = macro.network.first_dof[i]; first >= 0)
      result.fluctuation.middleRows<6>(6 * Eigen::Index(i)) = dofs.middleRows<6>(first);
  return result;
}

/// Area vectors [m^2] through which a uniform stress acts: on the bonds across faces (from their
/// first end outwards), or on the boundary particles of a cut element. Shares go by the square of
/// the radii and are then corrected by one matrix such that sum area (x) distance = V 1: only then
/// the mean stress is the applied one.
struct TractionAreas {
  std::vector<Vec3> bond;     ///< of each bond, zero inside
  std::vector<Vec3> particle; ///< of each particle
};

void require_spanning(const Mat3& moment)
{
  const Eigen::JacobiSVD<Mat3> svd(moment);
  if (!(svd.singularValues()[2] > 1e-9 * svd.singularValues()[0]))
    throw std::invalid_argument("uniform traction: bonds must cross the faces in three directions");
}

TractionAreas traction_areas(const VolumeElement& element)
{
  const auto& radius = element.particles.radius;
  TractionAreas areas{std::vector<Vec3>(element.bonds.size(), Vec3::Zero()),
                      std::vector<Vec3>(radius.size(), Vec3::Zero())};
  Mat3 moment = Mat3::Zero();
  const Mat3 faces = face_areas(element.cell);
  for (std::size_t b = 0; b < element.bonds.size(); ++b) {
    const auto [i, j] = element.bonds.ends[b];
    const Vec3 across = element.shift[b].cast<double>();
    areas.bond[b] = radius[i] * radius[j] * across;
    moment += areas.bond[b] * across.transpose();
  }
  if (element.is_periodic) {
    require_spanning(moment);
    for (Vec3& area : areas.bond)
      area = faces * moment.inverse() * area;
    return areas;
  }
  Eigen::Matrix<double, 3, 2> share = Eigen::Matrix<double, 3, 2>::Zero(); // of each face
  for (const auto& [i, side] : element.boundary)
    for (int k = 0; k < 3; ++k)
      if (side[k] != 0)
        share(k, side[k] > 0) += radius[i] * radius[i];
  for (const auto& [i, side] : element.boundary) {
    for (int k = 0; k < 3; ++k)
      if (side[k] != 0)
        areas.particle[i] += side[k] * radius[i] * radius[i] / share(k, side[k] > 0) * faces.col(k);
    moment += areas.particle[i] * element.particles.centre[i].transpose();
  }
  require_spanning(moment);
  for (Vec3& area : areas.particle)
    area = element.cell.volume() * moment.inverse() * area;
  return areas;
}

/// Force per unit stress through an area.
Mat3x6 traction(const Vec3& area)
{
  Mat3x6 result;
  for (int k = 0; k < 6; ++k)
    result.col(k) = from_mandel(Vec6::Unit(k)) * area;
  return result;
}

void require_one_cluster(const VolumeElement& element)
{
  int n = 0;
  for (const Cluster& cluster : find_clusters(element, all_intact(element)).cluster)
    n += element.is_periodic ? !cluster.direction.empty() : cluster.particles.size() > 1;
  if (n != 1)
    throw std::invalid_argument(
        "uniform traction: the bonds must connect the particles to one network");
}

/// Load on each mode of a bond that transmits a force and no moment.
Mat6 modal_force(const MacroNetwork& macro, std::size_t b, const Mat3x6& force)
{
  Mat6 result = Mat6::Zero();
  result.topRows<3>() = macro.bonds[b].motion.block<3, 3>(0, 6) * force;
  return result;
}

Homogenization by_traction(const VolumeElement& element)
{
  require_one_cluster(element);
  MacroNetwork macro = make_macro_network(element);
  const TractionAreas areas = traction_areas(element);
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(macro.n_dofs(), 6);
  for (std::size_t i = 0; i < areas.particle.size(); ++i)
    forces.middleRows<3>(macro.network.first_dof[i]) += traction(areas.particle[i]);
  for (std::size_t b = 0; b < macro.bonds.size(); ++b)
    if (!element.shift[b].isZero()) {
      macro.status[b] = BondStatus::gone;
      const Mat6 modal = modal_force(macro, b, traction(areas.bond[b]));
      add_end_forces(macro, b, -macro.bonds[b].motion.transpose() * modal, forces);
    }
  const auto pins = rigid_motion_pins(clusters_of(element, macro), macro.network);
  const Eigen::MatrixXd dofs = MacroSolver(macro, pins, macro.law_stiffness).solve(forces);

  std::vector<Mat6> modal;
  Mat6 compliance_energy = Mat6::Zero();
  for (std::size_t b = 0; b < macro.bonds.size(); ++b) {
    const Vec6 stiffness = modal_stiffness(macro, b, macro.law_stiffness);
    modal.push_back(macro.status[b] == BondStatus::gone
                        ? modal_force(macro, b, traction(areas.bond[b]))
                        : Mat6(stiffness.asDiagonal() *
                               (macro.bonds[b].motion * end_motion(macro, b, dofs)).eval()));
    compliance_energy += modal[b].transpose() * stiffness.cwiseInverse().asDiagonal() * modal[b];
  }
  Homogenization result{};
  result.condition = BoundaryCondition::uniform_traction;
  result.volume = macro.volume;
  const Mat6 stiffness = compliance(compliance_energy / macro.volume);
  for (std::size_t b = 0; b < macro.bonds.size(); ++b)
    result.per_strain.push_back(global_load(macro, b, modal[b] * stiffness));
  measure(macro, result);
  result.fluctuation = dofs * stiffness;
  for (std::size_t i = 0; i < element.particles.size(); ++i)
    for (int k = 0; k < 6; ++k)
      result.fluctuation.block<3, 1>(6 * Eigen::Index(i), k) -=
          from_mandel(Vec6::Unit(k)) * element.particles.centre[i];
  return result;
}

ProportionalLaws required_proportional_laws(const VolumeElement& element)
{
  if (element.laws.empty())
    throw std::invalid_argument("the volume element has no bond laws");
  if (auto laws = proportional_laws(element.laws))
    return *std::move(laws);
  throw std::invalid_argument("the laws of the volume element are not proportional: its compliance "
                              "needs time steps or one solution per frequency");
}

} // namespace

Homogenization homogenize(const VolumeElement& element, BoundaryCondition condition)
{
  if (condition == BoundaryCondition::periodic && !element.is_periodic)
    throw std::invalid_argument("a volume element cut out of a packing is not periodic");
  const bool by_faces = element.is_periodic && (condition == BoundaryCondition::kinematic ||
                                                condition == BoundaryCondition::uniform_traction);
  const VolumeElement& whole = by_faces ? with_whole_clusters(element) : element;
  Homogenization result = condition == BoundaryCondition::uniform_traction
                              ? by_traction(whole)
                              : by_displacement(whole, condition);
  result.loose = loose_particles(element);
  return result;
}

Mat6 compliance(const Mat6& stiffness)
{
  const Eigen::SelfAdjointEigenSolver<Mat6> eigen(0.5 * (stiffness + stiffness.transpose()));
  if (!(eigen.eigenvalues()[0] > 1e-12 * eigen.eigenvalues()[5]))
    throw std::runtime_error("the volume element does not resist every mean strain: its bonds do "
                             "not connect it in three directions");
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
         eigen.eigenvectors().transpose();
}

std::vector<BondLocalization> per_stress(const Homogenization& homogenization)
{
  const Mat6 inverse = compliance(homogenization.stiffness);
  std::vector<BondLocalization> result;
  for (const auto& [force, moment] : homogenization.per_strain)
    result.push_back({force * inverse, moment * inverse});
  return result;
}

MacroResponse mixed_response(const Mat6& stiffness, const MacroLoad& load,
                             const Vec6& stress_before)
{
  Mat6 matrix = Mat6::Zero();
  Vec6 known;
  const double scale = stiffness.diagonal().cwiseAbs().maxCoeff();
  for (int k = 0; k < 6; ++k) {
    if (load.by_stress[k])
      matrix.row(k) = stiffness.row(k);
    else
      matrix(k, k) = scale;
    known[k] = load.by_stress[k] ? load.value[k] - stress_before[k] : scale * load.value[k];
  }
  const Eigen::FullPivLU<Mat6> lu(matrix);
  if (!(lu.rcond() > 1e-13) && !known.isZero(0))
    throw std::runtime_error(
        "a mean stress is prescribed where the volume element does not resist");
  const Vec6 strain = lu.solve(known);
  return {strain, stiffness * strain + stress_before};
}

Mat6 creep_compliance(const VolumeElement& element, const Mat6& elastic_compliance, double t)
{
  const CreepLaw creep = required_proportional_laws(element).creep;
  return elastic_compliance * (creep_compliance(creep, t) * creep.maxwell_stiffness);
}

Eigen::Matrix<std::complex<double>, 6, 6>
complex_compliance(const VolumeElement& element, const Mat6& elastic_compliance, double omega)
{
  const CreepLaw creep = required_proportional_laws(element).creep;
  return elastic_compliance * (complex_compliance(creep, omega) * creep.maxwell_stiffness);
}

} // namespace dem
