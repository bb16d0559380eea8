#pragma once
#include "dem/link_matrix.h"

namespace dem {

/// A step of which a few bodies are looked at.
struct LocalProblem {
  const LinkStep* step;
  const BodyLinks* body_links;
  const LinkDofs* dofs;
  std::span<const double> hold;             ///< viscous hold of each body over the step [N/m]
  const Eigen::VectorXd* external;          ///< forces on the dofs
  double tolerance;                         ///< force that may stay out of balance [N]
  const Eigen::VectorXd* carried = nullptr; ///< motion that no hold acts against, if not empty
};

/// Bodies with more than a share of the largest force out of balance, and their neighbours, in
/// connected groups. Empty if they are too many for local work to pay.
std::vector<std::vector<Index>> unbalanced_groups(const LocalProblem& problem,
                                                  std::span<const LinkTangent> tangent,
                                                  const Eigen::VectorXd& residual);

/// Brings a group of bodies to equilibrium with all others held where they are.
///
/// Where a contact closes or a slip turns within a Newton step, the step is wrong for the bodies
/// next to it and right elsewhere. With all others held, theirs is a small convex problem: Newton
/// with a dense Cholesky factor and a line search of its own, so that a sphere that hangs loose
/// does not shorten the step of the whole specimen.
///
/// \param at  of all bodies; those of the group move
/// \param x   dofs, likewise
void relax_group(const LocalProblem& problem, std::span<const Index> group, Configuration& at,
                 Eigen::VectorXd& x);

} // namespace dem
