#pragma once
#include "dem/assembly.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace dem {

using Mat6x12 = Eigen::Matrix<double, 6, 12>;

/// What a bond still carries.
enum class BondStatus : std::uint8_t {
  intact,  ///< all six modes
  pressed, ///< broken, still pressed: normal mode only, no friction
  gone     ///< nothing
};

/// Elastic network of the bonds for small displacements: what the structure is, not how it is
/// damaged.
///
/// Unknowns ("dofs") are, for each free particle, the displacement u [m] and the rotation times
/// the particle's radius, R theta [m], so that all have one unit and the matrix is well scaled;
/// the last one is the displacement of the upper platen along z, if the platen is loaded.
/// Stiffnesses are those under instantaneous load.
struct ElasticNetwork {
  struct Bond {
    std::array<Index, 2> ends;
    Vec3 normal;       ///< from the first end to the second
    Vec3 arm_a, arm_b; ///< from the centres to the contact point [m]
    ModeStiffness stiffness;
  };

  std::vector<Bond> bonds;
  std::vector<Vec3> centre;     ///< of each particle [m]
  std::vector<double> radius;   ///< of each particle [m]
  std::vector<Index> first_dof; ///< of each particle, or -1 if it is held
  std::vector<Support> support;
  Index platen_dof = -1; ///< -1: no platen is loaded
  Index n_dofs = 0;
  Eigen::VectorXd unit_load; ///< force per unit of the load factor (1 N on the platen)
};

/// The network of an assembly. Stiffness of law i is that of its own spring.
ElasticNetwork make_network(const Assembly& assembly);

/// Displacement and rotation of one particle for a vector of dofs: u [m], theta [rad].
struct ParticleMotion {
  Vec3 displacement, rotation;
};
ParticleMotion motion(const ElasticNetwork& network, const Eigen::VectorXd& dofs, Index particle);

/// Relative motion of two spheres at their contact point: delta [m] and phi [rad].
struct BondDeformation {
  Vec3 delta, phi;
};
BondDeformation deformation(const ElasticNetwork& network, const ElasticNetwork::Bond& bond,
                            const Eigen::VectorXd& dofs);

/// What a bond transmits: force and moment on its first end at the contact point, in global axes.
/// The second end receives the opposite.
struct BondLoad {
  Vec3 force;  ///< [N]
  Vec3 moment; ///< [N m]
};
BondLoad bond_load(const ElasticNetwork::Bond& bond, BondStatus status,
                   const BondDeformation& deformation);

/// Normal force (tension positive) and magnitude of the shear force of a bond [N].
struct ForcePair {
  double normal, shear;
};
ForcePair bond_force(const ElasticNetwork::Bond& bond, BondStatus status,
                     const BondDeformation& deformation);

/// What a displacement does to a network.
struct NetworkForces {
  std::vector<ForcePair> bond; ///< of each bond
  Eigen::VectorXd nodal;       ///< forces that hold the displacement, K x
};
NetworkForces network_forces(const ElasticNetwork& network, std::span<const BondStatus> status,
                             const Eigen::VectorXd& dofs);

/// Dofs of the two ends of a bond, 6 each; -1 where the end is held.
std::array<Index, 12> bond_dofs(const ElasticNetwork& network, const ElasticNetwork::Bond& bond);

/// Rows: the six modes of a bond (normal, two shear, torsion, two bending), each times the square
/// root of its stiffness; columns: the dofs of its ends. The stiffness matrix of the bond is A^T A.
Mat6x12 mode_matrix(const ElasticNetwork& network, const ElasticNetwork::Bond& bond);

/// Modes that a status leaves to carry load, as a range of rows of `mode_matrix`.
constexpr int n_modes(BondStatus status)
{
  return status == BondStatus::intact ? 6 : status == BondStatus::pressed ? 1 : 0;
}

} // namespace dem
