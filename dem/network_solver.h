#pragma once
#include "dem/bordered_cholesky.h"
#include "dem/column_panels.h"
#include "dem/iterative_solver.h"
#include "dem/network_matrix.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dem {

/// A bond and what it becomes.
struct BondChange {
  Index bond;
  BondStatus status;
};

/// How a network came to be what it is, in the steps in which a solver followed it. Enough to
/// build a solver that continues bit for bit.
struct Damage {
  std::vector<BondStatus> status;               ///< of each bond, now
  std::vector<BondStatus> factorised;           ///< of each bond, at the last factorisation
  std::vector<std::vector<BondChange>> updates; ///< since then
};

/// Damage of a network whose bonds are all intact.
Damage undamaged(const ElasticNetwork& network);

/// Particles up to which the matrix is factorised while bonds leave: a breakage then costs one
/// back-solve. The factor grows with the power 4/3 of the number of particles and its making with
/// the square: at 200,000 it takes 15 GiB and 140 s.
constexpr std::size_t most_factored_particles = 200'000;

/// The same if one solution is all that is asked for: at 60,000 particles a factorisation takes
/// 15 s and 2.8 GiB, the iteration 2 s and 0.3 GiB.
constexpr std::size_t most_factored_particles_once = 20'000;

/// Solves a network under its unit load while bonds leave.
///
/// Small networks (see above) are factorised, large ones solved by conjugate gradients with
/// multigrid; the answers agree as far as both fulfil the equations.
///
/// The matrix is factorised now and then; in between, the removed modes A of the bonds enter by
/// the identity of Woodbury on half-solved columns Y = L^-1 P A: K_now = L (I - Y Y^T) L^T. A new
/// breakage costs one sparse half-solve of six columns along the elimination tree, their products
/// with the columns before, and one back-solve. The Cholesky factor of I - Y^T Y grows by a border.
class NetworkSolver {
public:
  /// Analyses the pattern, factorises and follows the updates of `damage`.
  /// \param most_factored  particles from which on it iterates
  NetworkSolver(const ElasticNetwork& network, const Damage& damage,
                std::size_t most_factored = most_factored_particles);

  /// The network after further changes. May factorise anew; whether it does depends on the damage
  /// alone, not on how the solver came here.
  Damage apply(Damage damage, std::span<const BondChange> changes);

  /// Dofs under the unit load, or nothing if the network cannot carry it: `obstacle()` says why.
  /// Residual at most 1e-11 of the load, or 1e-8 after one step of refinement.
  const std::optional<Eigen::VectorXd>& response() const { return response_; }
  const std::string& obstacle() const { return obstacle_; }

  /// Forces of all bonds under the unit load, if there is a response.
  const std::vector<ForcePair>& bond_forces() const { return bond_forces_; }

  const Pieces& pieces() const { return pieces_; }

  /// Energy of the springs to ground over the energy of the network [-].
  double ground_energy_share() const { return ground_energy_share_; }

  struct Statistics {
    int n_factorisations = 0; ///< or set-ups of the multigrid
    int n_updates = 0, n_refinements = 0;
    long n_factor_nonzeros = 0;
    bool iterates = false;
    long n_iterations = 0; ///< of conjugate gradients
  };
  const Statistics& statistics() const { return statistics_; }

private:
  bool keeps_pieces(std::span<const BondStatus> before, std::span<const BondStatus> after,
                    std::span<const BondChange> changes) const;
  void factorise(std::span<const BondStatus> status);
  bool update(std::span<const BondStatus> before, std::span<const BondChange> changes);
  bool remove(const SupernodalFactor::SparseColumns& lost);
  bool respond(std::span<const BondStatus> status);
  int n_changed(const Damage& damage) const;
  Eigen::VectorXd unit_solution();
  Eigen::VectorXd correction(const Eigen::VectorXd& residual);
  Eigen::VectorXd iterated(const Eigen::VectorXd& load, double tolerance);
  Eigen::VectorXd solved(Eigen::VectorXd half_solved_load, Eigen::VectorXd reduced_load) const;
  Eigen::VectorXd reduced(const Eigen::VectorXd& half_solved_load) const;
  NetworkForces grounded(std::span<const BondStatus> status, const Eigen::VectorXd& x) const;

  const ElasticNetwork* network_;
  ParticleBonds particle_bonds_;
  SymmetricPattern pattern_;
  std::optional<SupernodalFactor> factor_;   // one of the two
  std::optional<IterativeSolver> iterative_; // made with each factorisation
  double ground_stiffness_;
  Pieces pieces_;
  Eigen::VectorXd half_solved_load_;
  ColumnPanels columns_;         // Y
  BorderedCholesky complement_;  // of I - Y^T Y
  Eigen::VectorXd reduced_load_; // complement_^-1 Y^T half_solved_load_
  std::optional<Eigen::VectorXd> response_;
  std::vector<ForcePair> bond_forces_;
  std::string obstacle_;
  double ground_energy_share_ = 0;
  Statistics statistics_;
};

} // namespace dem
