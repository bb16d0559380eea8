#pragma once
#include "dem/connectivity.h"
#include "dem/mandel.h"
#include "dem/supernodal_factor.h"
#include "dem/volume_element.h"

#include <Eigen/SparseCore>

#include <span>
#include <vector>

namespace dem {

/// What deforms a bond, in its own axes: normal, two shear, torsion, two bending.
struct BondModes {
  Mat6x12 motion; ///< deformation of the modes per dof of the two ends [-], [1/m]
  Mat6 strain;    ///< the same per mean strain, in Mandel notation [m]; zero rows of rotation
  Vec6 weight;    ///< stiffness of the modes over that of the law's spring: 1, 1/(N/S), ...
};

/// The network of a volume element under mean strain: the relative motion of the two ends of a bond
/// is that of the particles' dofs plus strain times branch.
struct MacroNetwork {
  ElasticNetwork network; ///< bonds with the stiffness of each law's own spring
  std::vector<BondModes> bonds;
  std::vector<int> law;              ///< of each bond
  std::vector<double> law_stiffness; ///< K_m of each law [N/m]
  std::vector<BondStatus> status;    ///< `gone` for bonds whose force is prescribed
  double volume;                     ///< [m^3]

  Index n_dofs() const { return network.n_dofs; }
};
MacroNetwork make_macro_network(const VolumeElement& element);

/// Rows of a matrix of dofs that belong to the two ends of a bond; zero where they are held.
Eigen::Matrix<double, 12, Eigen::Dynamic> end_motion(const MacroNetwork& macro, std::size_t bond,
                                                     const Eigen::MatrixXd& dofs);

/// Adds forces that work with the motion of the two ends to forces that work with all dofs.
void add_end_forces(const MacroNetwork& macro, std::size_t bond,
                    const Eigen::Ref<const Eigen::Matrix<double, 12, Eigen::Dynamic>>& forces,
                    Eigen::MatrixXd& nodal);

/// Stiffness of the six modes of a bond if the spring of its law had this stiffness [N/m].
inline Vec6 modal_stiffness(const MacroNetwork& macro, std::size_t bond,
                            std::span<const double> law_stiffness)
{
  return law_stiffness[macro.law[bond]] * macro.bonds[bond].weight;
}

/// The same for what the status of the bond leaves of its modes.
Vec6 carried_stiffness(const MacroNetwork& macro, std::size_t bond,
                       std::span<const double> law_stiffness);

/// Nodal forces that hold the particles still under six unit mean strains; n_dofs x 6 [N].
Eigen::MatrixXd strain_loads(const MacroNetwork& macro, std::span<const double> law_stiffness);

/// Sum of stiffness over the bonds if all particles follow the mean strain: 6 x 6 [J].
Mat6 affine_energy(const MacroNetwork& macro, std::span<const double> law_stiffness);

/// Stiffness matrix, lower triangle [N/m].
Eigen::SparseMatrix<double> stiffness_matrix(const MacroNetwork& macro,
                                             std::span<const double> law_stiffness);

/// A spring to ground on one particle, without force in equilibrium: it removes the rigid motions
/// of a cluster without changing what is strained. Rotations are those times the radius.
struct Pin {
  Index particle;
  Mat3 rotation; ///< projector on the axes about which the cluster can turn
};

/// One pin for each cluster that can move as a rigid body, on its first particle: displacement
/// held, and rotation about the axes that its endless directions leave free (all of them for a
/// cluster that ends, one for an endless chain).
std::vector<Pin> rigid_motion_pins(const Clusters& clusters, const ElasticNetwork& network);

/// Factorised stiffness matrix of a macroscopic network.
class MacroSolver {
public:
  /// Symbolic analysis only: it serves the network however it is damaged.
  explicit MacroSolver(const MacroNetwork& macro);

  /// Numeric factorisation for the network's present status.
  /// \param pieces  loose pieces stand still, clamped ones get weak springs to ground
  /// \return false if the matrix is not positive definite
  bool factorise(const MacroNetwork& macro, std::span<const Pin> pins, const Pieces& pieces,
                 std::span<const double> law_stiffness);

  /// \throws std::runtime_error if the matrix is not positive definite
  MacroSolver(const MacroNetwork& macro, std::span<const Pin> pins,
              std::span<const double> law_stiffness);

  /// Dofs under nodal forces, one column each, with one step of refinement. The forces on each
  /// cluster must balance as far as it can move.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& forces) const;

  /// Forces that hold the dofs.
  Eigen::MatrixXd product(const Eigen::MatrixXd& dofs) const;

  /// The same without refinement, in half the time.
  Eigen::MatrixXd solve_once(const Eigen::MatrixXd& forces) const;

private:
  SymmetricPattern pattern_;
  std::vector<double> values_;
  SupernodalFactor factor_;
};

} // namespace dem
