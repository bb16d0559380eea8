#pragma once
#include "dem/link_assembly.h"

#include <memory>
#include <optional>

namespace dem {

/// The matrix that was factorised last: enough to have the same factor again.
struct FactorisedMatrix {
  std::vector<std::array<Index, 2>> ends; ///< links of the pattern
  std::vector<double> values;
  double stiffness = 0; ///< mean algorithmic stiffness then [N/m]
};

/// Conjugate gradients preconditioned with the Cholesky factor of an earlier tangent.
///
/// Between two factorisations bonds break, contacts close and slide, and the step changes: the
/// tangent differs by a few ranks and a factor, so that a few iterations do. When their extra cost
/// since the last factorisation exceeds that of a new one, it is factorised anew, and so it is for
/// some solutions after one for which a stale factor was too far off, for more of them the more
/// often that happened in a row: in an avalanche it will be so again.
/// With a stale factor the residual is driven down only as far as that pays within a Newton search.
/// The pattern is that of the links that carry or nearly do, and analysed anew when others carry.
class StaleFactor {
public:
  struct Statistics {
    long n_factorisations = 0, n_analyses = 0, n_iterations = 0, n_solves = 0;
    long n_factor_nonzeros = 0;
  };

  /// What has been saved so far decides when to factorise anew: part of the state of a run.
  struct Wear {
    std::shared_ptr<const FactorisedMatrix> factorised;
    long extra_iterations = 0;
    long n_failures = 0; ///< in a row: the factor was too far off
    long n_fresh = 0;    ///< solutions that begin with a factorisation before it is tried again
  };

  /// Takes over the factor of another run.
  void restore(const Wear& wear, const LinkDofs& dofs);
  const Wear& wear() const { return wear_; }

  /// The next solution begins with a factorisation, whatever came before: that of another volume.
  void begin_anew();

  /// Solves K x = b to a relative residual, or with a stale factor to what pays.
  /// \return nothing if K is not positive definite along a search direction, or without convergence
  std::optional<Eigen::VectorXd> solve(const LinkMatrix& matrix, const BodyLinks& body_links,
                                       const LinkDofs& dofs, const Eigen::VectorXd& b,
                                       double tolerance, double stiffness, int n_threads);

  const Statistics& statistics() const { return statistics_; }

private:
  std::optional<Eigen::VectorXd> iterate(const LinkMatrix& matrix, const BodyLinks& body_links,
                                         const LinkDofs& dofs, const Eigen::VectorXd& b,
                                         double tolerance, double stiffness, int n_threads,
                                         bool stale);
  void factorise(const LinkMatrix& matrix, const LinkDofs& dofs, double stiffness);
  void analyse(std::vector<std::array<Index, 2>> ends, const LinkDofs& dofs);

  Wear wear_;
  std::unique_ptr<LinkAssembly> assembly_;
  std::optional<SupernodalFactor> factor_;
  Statistics statistics_;
};

} // namespace dem
