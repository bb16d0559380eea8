#pragma once
#include "fem/elements.h"

#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <functional>

namespace fem {

/// A symmetric positive definite system over the ranks, solved by conjugate gradients with
/// algebraic multigrid (Trilinos ML) that knows the rigid motions of the body.
class LinearSolver {
public:
  /// An empty matrix for the couplings of the unknowns.
  template <int dim>
  LinearSolver(const Elements<dim>& elements, const dealii::AffineConstraints<double>& constraints);

  /// Sets the matrix to the stiffness of tangents (as in ConstitutiveAnswer).
  template <int dim>
  void assemble(const Elements<dim>& elements, const dealii::AffineConstraints<double>& constraints,
                std::span<const Mat6> tangent, std::span<const int> which);

  /// Builds the multigrid of the present matrix. It serves later matrices as well, at the cost of
  /// iterations that grow with the square root of the ratio of the stiffnesses between directions.
  void set_up();

  /// Solves to an absolute residual; `x` comes as a guess.
  /// \return the number of iterations
  /// \throws std::runtime_error if the residual does not come down
  int solve(const Vector& right, double residual, Vector& x) const;

  /// The same for another operator that is not far from the matrix, such as that of a later tangent
  /// without its matrix; the multigrid stays that of the matrix.
  /// \param apply        to = operator times from
  /// \param constraints  whose unknowns stay zero
  int solve(const std::function<void(Vector& to, const Vector& from)>& apply,
            const dealii::AffineConstraints<double>& constraints, const Vector& right,
            double residual, Vector& x) const;

  /// One cycle of the multigrid.
  void precondition(const Vector& from, Vector& to) const { multigrid_.vmult(to, from); }

  const dealii::TrilinosWrappers::SparseMatrix& matrix() const { return matrix_; }

private:
  dealii::TrilinosWrappers::SparseMatrix matrix_;
  dealii::TrilinosWrappers::PreconditionAMG multigrid_;
  Eigen::MatrixXd slow_motions_; ///< rows: unknowns of this rank
  bool higher_order_;
};

} // namespace fem
