#pragma once
#include "dem/stale_factor.h"

#include <functional>
#include <string>

namespace dem {

/// What a step asks for.
struct EquilibriumProblem {
  LinkStep step;
  const BodyLinks* body_links;
  std::vector<double> hold; ///< viscous hold of each body over the step [N/m]
  Eigen::VectorXd external; ///< forces on the dofs at the end, without that of the platen
  std::function<double(double)> platen_force; ///< [N], of the platen's displacement in the step
  double platen_moved = 0;         ///< displacement of a held upper platen in the step [m]
  double tolerance;                ///< out-of-balance force over the largest link force
  double stiffness;                ///< mean algorithmic stiffness of the links [N/m]
  Mat3 cell_strain = Mat3::Zero(); ///< change of the strain of the periodic cell in the step [-]
  Eigen::VectorXd carried = {};    ///< what the strain of the cell moves: no hold acts against it
  double least_force = 0;          ///< forces below are as nothing: where all has come apart [N]
};

/// An equilibrium, or why there is none.
struct Equilibrium {
  bool found = false;
  Eigen::VectorXd x; ///< dofs gained in the step
  Configuration at;
  double platen_force = 0;  ///< on the upper platen from outside, tension positive [N]
  double largest_force = 0; ///< of a link [N]
  double residual = 0;      ///< largest force out of balance [N]
  Index worst_body = -1;    ///< where
  int n_iterations = 0;
};

/// Finds equilibria: semi-smooth Newton with the consistent tangent of contact and slip.
///
/// The friction limits are those at the start; with them held, a step is the minimum of a convex
/// potential up to the change of geometry, so that full steps converge in a few iterations. Where
/// few bodies are left out of balance, they are brought to rest with all others held; where a step
/// overshoots still, a line search shortens it. The residual is that of total forces on the new
/// geometry: nothing drifts.
class EquilibriumFinder {
public:
  EquilibriumFinder(LinkDofs dofs, int n_threads) : dofs_(std::move(dofs)), n_threads_(n_threads) {}

  Equilibrium find(const EquilibriumProblem& problem, const Eigen::VectorXd& guess);

  const LinkDofs& dofs() const { return dofs_; }
  StaleFactor& factor() { return factor_; }
  const StaleFactor& factor() const { return factor_; }
  long n_evaluations() const { return n_evaluations_; }

private:
  struct Residual {
    Eigen::VectorXd force;
    double largest = 0;
  };
  Configuration configuration(const EquilibriumProblem& problem, const Eigen::VectorXd& x) const;
  Residual evaluate(const EquilibriumProblem& problem, const Eigen::VectorXd& x,
                    Equilibrium& result);
  void evaluate_near(const EquilibriumProblem& problem, std::span<const Index> moved,
                     Equilibrium& result, Residual& residual);
  void evaluate_link(const EquilibriumProblem& problem, Index k, const Configuration& at);
  void evaluate_body(const EquilibriumProblem& problem, Index i, const Eigen::VectorXd& x,
                     Eigen::VectorXd& residual);
  void sum_up(const EquilibriumProblem& problem, Equilibrium& result, Residual& residual) const;
  void relax(const EquilibriumProblem& problem, double wanted, Equilibrium& result,
             Residual& residual);
  void advance(const EquilibriumProblem& problem, const Eigen::VectorXd& direction, double wanted,
               Equilibrium& result, Residual& residual);

  LinkDofs dofs_;
  int n_threads_;
  StaleFactor factor_;
  LinkMatrix matrix_;
  std::vector<Vec3> force_, moment_;
  std::vector<double> on_top_; ///< force of each body that is part of the upper platen [N]
  long n_evaluations_ = 0;
};

} // namespace dem
