#pragma once
#include "dem/conjugate_gradients.h"
#include "dem/connectivity.h"
#include "dem/multigrid.h"
#include "dem/network.h"

#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace dem {

/// Residual over the load at which an iteration ends: below what is asked of a solution (1e-11), so
/// that the displacements come nearer to those of a factor.
constexpr double iteration_tolerance = 1e-12;

/// Solves a network by conjugate gradients with a multigrid cycle: for packings too large to
/// factorise. Memory and time grow in proportion to the number of bonds.
///
/// The near-null space is that of the rigid motions of the particles where they are. The platen is
/// kept out of the iteration: the particles are solved for with the platen held, and displaced by
/// one; its equilibrium is then one equation.
class IterativeSolver {
public:
  /// Assembles the matrix of the particles that are held or clamped and sets the multigrid up.
  /// The network must outlive the solver.
  IterativeSolver(const ElasticNetwork& network, std::span<const BondStatus> status,
                  const Pieces& pieces);

  /// Takes over a bond that breaks; the same particles must stay held, clamped and loose. The
  /// coarse levels stay as they are: they need not be precise.
  void change(Index bond, BondStatus status);

  /// Displacements under a load on all dofs; loose particles stay where they are.
  /// \param tolerance  of the residual over the load [-]
  IterativeSolution solve(const Eigen::VectorXd& load, double tolerance) const;

  /// Rows of blocks, levels and relative size of the multigrid.
  const Multigrid& multigrid() const { return *multigrid_; }

private:
  BlockMatrix matrix() const;
  std::vector<Mat6> near_null() const;
  Index other_end(Index bond, Index particle) const;
  Mat6 coupling(Index bond, Index particle) const;
  Mat6 diagonal_block(Index particle) const;
  IterativeSolution
  solve_particles(const Eigen::VectorXd& load,
                  const std::function<bool(const IterationProgress&)>& is_precise) const;

  const ElasticNetwork* network_;
  ParticleBonds particle_bonds_;
  std::vector<Index> particle_; ///< of each row, in breadth-first order
  std::vector<Index> row_;      ///< of each particle, or -1
  std::vector<double> ground_;  ///< stiffness of the springs to ground of each row [N/m]
  std::vector<BondStatus> status_;
  std::optional<Multigrid> multigrid_;
};

} // namespace dem
