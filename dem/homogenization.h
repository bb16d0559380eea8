#pragma once
#include "dem/macro_network.h"

#include <array>
#include <complex>
#include <vector>

namespace dem {

/// How the surface of a volume element moves with the mean strain E. All four minimise the same
/// energy, that of all bonds with the deformation (relative motion of their ends) + E times branch,
/// each over a wider set of motions than the one before:
///   affine            no particle moves or turns on top of E x;
///   kinematic         boundary particles do not: displacement E x, no rotation;
///   periodic          all particles may, and all images move alike;
///   uniform_traction  the ends of the bonds that cross a face move apart by jumps of displacement
///                     and rotation, of which only the mean over the faces is zero.
/// Each set contains the one before (jumps = 0, boundary motion = 0, all motion = 0), so the minima
/// fall: C_affine >= C_kinematic >= C_periodic >= C_uniform_traction in Loewner order. The
/// multiplier of the mean jump is the stress: crossing bonds transmit stress times area and no
/// moment at their contact points.
///
/// Boundary particles of a periodic element are those with a bond across a face once clusters are
/// whole (`with_whole_clusters`); in a cut element they are listed, the tractions act on their
/// centres, and `periodic` is refused.
enum class BoundaryCondition : std::uint8_t { affine, kinematic, periodic, uniform_traction };

/// What a bond transmits per unit mean strain [N], [N m] or mean stress [N/Pa], [N m/Pa] in each of
/// the six components: force and moment on its first end at the contact point, in global axes.
struct BondLocalization {
  Eigen::Matrix<double, 3, 6> force, moment;
};

/// Elastic response of a volume element, under instantaneous load.
struct Homogenization {
  BoundaryCondition condition;
  Mat6 stiffness; ///< C [Pa], Mandel notation, from the mean stress 1/V sum force (x) branch
  double volume;  ///< [m^3]
  /// Motion of each particle on top of the mean strain, per unit strain: displacement [m], then
  /// rotation times radius [m]; 6 rows each. The first particle of a cluster that can move as a
  /// rigid body stands still.
  Eigen::MatrixXd fluctuation;
  std::vector<BondLocalization> per_strain; ///< of each bond
  std::vector<Index> loose; ///< particles of clusters that carry nothing, or have no bonds
  double asymmetry;         ///< of the six mean stresses over their size: round-off in equilibrium
  double hill_mandel;       ///< work of mean stress and energy of the bonds: relative difference
};

/// One factorisation and six solutions.
/// \throws std::invalid_argument if the condition does not fit the element, or, for uniform
///         traction, if the network is not one cluster that goes on in three directions
Homogenization homogenize(const VolumeElement& element,
                          BoundaryCondition condition = BoundaryCondition::periodic);

/// S = C^-1 [1/Pa].
/// \throws std::runtime_error if a mean strain meets no resistance
Mat6 compliance(const Mat6& stiffness);

/// The same bond forces per unit mean stress.
std::vector<BondLocalization> per_stress(const Homogenization& homogenization);

/// What is prescribed of the mean strain and stress: one of the two in each Mandel component.
struct MacroLoad {
  std::array<bool, 6> by_stress; ///< true: the value is a stress [Pa], false: a strain [-]
  Vec6 value;
};
struct MacroResponse {
  Vec6 strain, stress;
};

/// Strain and stress for stress = stiffness * strain + stress_before.
/// \throws std::runtime_error if a component under stress meets no resistance
MacroResponse mixed_response(const Mat6& stiffness, const MacroLoad& load,
                             const Vec6& stress_before = Vec6::Zero());

/// S(t) [1/Pa] of an element whose laws are proportional: S(0) J(t) / J(0), exact for all times.
/// \throws std::invalid_argument if the laws are not proportional
Mat6 creep_compliance(const VolumeElement& element, const Mat6& elastic_compliance, double t);

/// S*(omega) = S' - i S'' of such an element.
Eigen::Matrix<std::complex<double>, 6, 6>
complex_compliance(const VolumeElement& element, const Mat6& elastic_compliance, double omega);

} // namespace dem
