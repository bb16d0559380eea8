#include "dem/network.h"

#include <cmath>

namespace dem {

namespace {

Mat3 cross_matrix(const Vec3& v)
{
  Mat3 matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

Vec3 any_normal_to(const Vec3& n)
{
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  return n.cross(Vec3::Unit(smallest)).normalized();
}

ElasticNetwork::Bond network_bond(const Assembly& assembly, std::size_t b)
{
  const auto [i, j] = assembly.bonds.ends[b];
  const Vec3 branch = assembly.particles.centre[j] - assembly.particles.centre[i];
  const double length = branch.norm(), offset = assembly.bonds.contact_offset[b];
  const Vec3 normal = branch / length;
  return {{i, j},
          normal,
          (0.5 * length + offset) * normal,
          (offset - 0.5 * length) * normal,
          mode_stiffness(assembly.laws[assembly.bonds.law[b]], assembly.bonds.section_radius[b])};
}

BondDeformation relative_motion(const ElasticNetwork::Bond& bond, const ParticleMotion& a,
                                const ParticleMotion& b)
{
  return {b.displacement + b.rotation.cross(bond.arm_b) -
              (a.displacement + a.rotation.cross(bond.arm_a)),
          b.rotation - a.rotation};
}

} // namespace

ElasticNetwork make_network(const Assembly& assembly)
{
  ElasticNetwork network;
  network.bonds.reserve(assembly.bonds.size());
  for (std::size_t b = 0; b < assembly.bonds.size(); ++b)
    network.bonds.push_back(network_bond(assembly, b));
  network.centre = assembly.particles.centre;
  network.radius = assembly.particles.radius;
  network.support = assembly.support;
  for (const Support support : assembly.support) {
    network.first_dof.push_back(support == Support::free ? network.n_dofs : -1);
    network.n_dofs += support == Support::free ? 6 : 0;
  }
  if (loaded_by_platen(assembly))
    network.platen_dof = network.n_dofs++;
  network.unit_load = Eigen::VectorXd::Zero(network.n_dofs);
  if (loaded_by_platen(assembly))
    network.unit_load[network.platen_dof] = 1;
  for (const ParticleLoad& load : assembly.loads)
    if (const Index dof = network.first_dof[load.particle]; dof >= 0) {
      network.unit_load.segment<3>(dof) += load.force;
      network.unit_load.segment<3>(dof + 3) += load.moment / network.radius[load.particle];
    }
  return network;
}

ParticleMotion motion(const ElasticNetwork& network, const Eigen::VectorXd& dofs, Index particle)
{
  if (const Index dof = network.first_dof[particle]; dof >= 0)
    return {dofs.segment<3>(dof), dofs.segment<3>(dof + 3) / network.radius[particle]};
  if (network.support[particle] == Support::top && network.platen_dof >= 0)
    return {Vec3(0, 0, dofs[network.platen_dof]), Vec3::Zero()};
  return {Vec3::Zero(), Vec3::Zero()};
}

BondDeformation deformation(const ElasticNetwork& network, const ElasticNetwork::Bond& bond,
                            const Eigen::VectorXd& dofs)
{
  return relative_motion(bond, motion(network, dofs, bond.ends[0]),
                         motion(network, dofs, bond.ends[1]));
}

BondLoad bond_load(const ElasticNetwork::Bond& bond, BondStatus status,
                   const BondDeformation& deformation)
{
  if (status == BondStatus::gone)
    return {Vec3::Zero(), Vec3::Zero()};
  const auto& [normal, shear, torsion, bending] = bond.stiffness;
  const Vec3 axial = bond.normal * bond.normal.dot(deformation.delta);
  if (status == BondStatus::pressed)
    return {normal * axial, Vec3::Zero()};
  const Vec3 twist = bond.normal * bond.normal.dot(deformation.phi);
  return {normal * axial + shear * (deformation.delta - axial),
          torsion * twist + bending * (deformation.phi - twist)};
}

ForcePair bond_force(const ElasticNetwork::Bond& bond, BondStatus status,
                     const BondDeformation& deformation)
{
  if (status == BondStatus::gone)
    return {0, 0};
  const double opening = bond.normal.dot(deformation.delta);
  if (status == BondStatus::pressed)
    return {bond.stiffness.normal * opening, 0};
  return {bond.stiffness.normal * opening,
          bond.stiffness.shear * (deformation.delta - opening * bond.normal).norm()};
}

NetworkForces network_forces(const ElasticNetwork& network, std::span<const BondStatus> status,
                             const Eigen::VectorXd& dofs)
{
  const std::size_t n = network.radius.size();
  std::vector<ParticleMotion> moved(n);
  std::vector<BondLoad> held(n, {Vec3::Zero(), Vec3::Zero()}); // at the centre of each particle
  for (std::size_t i = 0; i < n; ++i)
    moved[i] = motion(network, dofs, Index(i));
  NetworkForces result{std::vector<ForcePair>(network.bonds.size(), {0, 0}),
                       Eigen::VectorXd::Zero(network.n_dofs)};
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    if (status[b] == BondStatus::gone)
      continue;
    const ElasticNetwork::Bond& bond = network.bonds[b];
    const BondDeformation strained =
        relative_motion(bond, moved[bond.ends[0]], moved[bond.ends[1]]);
    const BondLoad load = bond_load(bond, status[b], strained);
    result.bond[b] = bond_force(bond, status[b], strained);
    BondLoad& first = held[bond.ends[0]];
    BondLoad& second = held[bond.ends[1]];
    first.force -= load.force;
    first.moment -= load.moment + bond.arm_a.cross(load.force);
    second.force += load.force;
    second.moment += load.moment + bond.arm_b.cross(load.force);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (const Index dof = network.first_dof[i]; dof >= 0) {
      result.nodal.segment<3>(dof) = held[i].force;
      result.nodal.segment<3>(dof + 3) = held[i].moment / network.radius[i];
    } else if (network.support[i] == Support::top && network.platen_dof >= 0)
      result.nodal[network.platen_dof] += held[i].force.z();
  }
  return result;
}

std::array<Index, 12> bond_dofs(const ElasticNetwork& network, const ElasticNetwork::Bond& bond)
{
  std::array<Index, 12> dofs;
  dofs.fill(-1);
  for (int end = 0; end < 2; ++end) {
    const Index particle = bond.ends[end], first = network.first_dof[particle];
    for (int k = 0; k < 6; ++k)
      if (first >= 0)
        dofs[6 * end + k] = first + k;
    if (network.support[particle] == Support::top)
      dofs[6 * end + 2] = network.platen_dof;
  }
  return dofs;
}

Mat6x12 mode_matrix(const ElasticNetwork& network, const ElasticNetwork::Bond& bond)
{
  const Vec3 tangent = any_normal_to(bond.normal);
  Mat3 frame; // rows: normal, two tangents
  frame << bond.normal.transpose(), tangent.transpose(), bond.normal.cross(tangent).transpose();
  const double radius_a = network.radius[bond.ends[0]], radius_b = network.radius[bond.ends[1]];
  Mat6x12 modes = Mat6x12::Zero();
  modes.block<3, 3>(0, 0) = -frame;
  modes.block<3, 3>(0, 3) = frame * cross_matrix(bond.arm_a) / radius_a;
  modes.block<3, 3>(0, 6) = frame;
  modes.block<3, 3>(0, 9) = -frame * cross_matrix(bond.arm_b) / radius_b;
  modes.block<3, 3>(3, 3) = -frame / radius_a;
  modes.block<3, 3>(3, 9) = frame / radius_b;
  const auto& [normal, shear, torsion, bending] = bond.stiffness;
  Vec6 root;
  root << normal, shear, shear, torsion, bending, bending;
  return root.cwiseSqrt().asDiagonal() * modes;
}

} // namespace dem
