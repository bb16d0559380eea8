#include "fem/linear_solver.h"

#include "fem/supports.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/sparsity_tools.h>

#include <Epetra_MultiVector.h>
#include <Teuchos_ParameterList.hpp>
#include <fmt/format.h>
#include <ml_MultiLevelPreconditioner.h>

#include <stdexcept>

namespace fem {

namespace {

/// Motions that cost little energy: the rigid ones; in a meridian section the two translations.
template <int dim>
Eigen::MatrixXd slow_motions(const Elements<dim>& elements)
{
  const Eigen::MatrixXd rigid = rigid_motions(elements);
  if (dim == 3)
    return rigid;
  Eigen::MatrixXd motions(rigid.rows(), 2);
  motions << Eigen::MatrixXd::Ones(rigid.rows(), 1) - rigid, rigid;
  return motions;
}

} // namespace

template <int dim>
LinearSolver::LinearSolver(const Elements<dim>& elements,
                           const dealii::AffineConstraints<double>& constraints)
    : higher_order_(elements.discretisation().order > 1)
{
  const auto owned = elements.dofs().locally_owned_dofs();
  dealii::IndexSet relevant;
  dealii::DoFTools::extract_locally_relevant_dofs(elements.dofs(), relevant);
  dealii::DynamicSparsityPattern pattern(relevant);
  dealii::DoFTools::make_sparsity_pattern(elements.dofs(), pattern, constraints, false);
  dealii::SparsityTools::distribute_sparsity_pattern(pattern, owned, elements.ranks(), relevant);
  matrix_.reinit(owned, owned, pattern, elements.ranks());
  slow_motions_ = slow_motions(elements);
}

template <int dim>
void LinearSolver::assemble(const Elements<dim>& elements,
                            const dealii::AffineConstraints<double>& constraints,
                            std::span<const Mat6> tangent, std::span<const int> which)
{
  matrix_ = 0;
  dealii::FullMatrix<double> stiffness;
  for (std::size_t cell = 0; cell < elements.n_cells(); ++cell) {
    elements.cell_stiffness(cell, tangent, which, stiffness);
    constraints.distribute_local_to_global(stiffness, elements.cell_dofs(cell), matrix_);
  }
  matrix_.compress(dealii::VectorOperation::add);
}

void LinearSolver::set_up()
{
  Teuchos::ParameterList list;
  ML_Epetra::SetDefaults("SA", list);
  list.set("ML output", 0);
  list.set("smoother: type", "Chebyshev");
  list.set("smoother: sweeps", 3);
  list.set("smoother: Chebyshev alpha", 20.);
  list.set("smoother: pre or post", "both");
  list.set("coarse: type", "Amesos-KLU");
  list.set("coarse: max size", 1000);
  list.set("aggregation: type", "Uncoupled");
  list.set("aggregation: threshold", higher_order_ ? 1e-3 : 1e-2);
  const Epetra_CrsMatrix& matrix = matrix_.trilinos_matrix();
  Eigen::MatrixXd& modes = slow_motions_;
  list.set("PDE equations", modes.cols() == 6 ? 3 : 2);
  list.set("null space: type", "pre-computed");
  list.set("null space: dimension", int(modes.cols()));
  list.set("null space: vectors", modes.data());
  multigrid_.initialize(matrix, list);
}

namespace {

/// Conjugate gradients. \return the number of iterations
template <typename Operator, typename Preconditioner>
int conjugate_gradients(const Operator& system, const Preconditioner& preconditioner,
                        const Vector& right, double residual, Vector& x)
{
  dealii::SolverControl control(1000, residual);
  dealii::SolverCG<Vector> solver(control);
  try {
    solver.solve(system, x, right, preconditioner);
  } catch (const dealii::SolverControl::NoConvergence& failure) {
    throw std::runtime_error(
        fmt::format("the linear system was not solved in {} iterations: residual {:.3g} N, wanted "
                    "{:.3g} N",
                    failure.last_step, failure.last_residual, residual));
  }
  return int(control.last_step());
}

struct Applied {
  const std::function<void(Vector&, const Vector&)>& apply;
  void vmult(Vector& to, const Vector& from) const { apply(to, from); }
};

/// A cycle of the multigrid that leaves what is constrained at zero.
struct Held {
  const dealii::TrilinosWrappers::PreconditionAMG& multigrid;
  const dealii::AffineConstraints<double>& constraints;
  void vmult(Vector& to, const Vector& from) const
  {
    multigrid.vmult(to, from);
    constraints.set_zero(to);
  }
};

} // namespace

int LinearSolver::solve(const Vector& right, double residual, Vector& x) const
{
  return conjugate_gradients(matrix_, multigrid_, right, residual, x);
}

int LinearSolver::solve(const std::function<void(Vector&, const Vector&)>& apply,
                        const dealii::AffineConstraints<double>& constraints, const Vector& right,
                        double residual, Vector& x) const
{
  return conjugate_gradients(Applied{apply}, Held{multigrid_, constraints}, right, residual, x);
}

template LinearSolver::LinearSolver(const Elements<2>&, const dealii::AffineConstraints<double>&);
template LinearSolver::LinearSolver(const Elements<3>&, const dealii::AffineConstraints<double>&);
template void LinearSolver::assemble(const Elements<2>&, const dealii::AffineConstraints<double>&,
                                     std::span<const Mat6>, std::span<const int>);
template void LinearSolver::assemble(const Elements<3>&, const dealii::AffineConstraints<double>&,
                                     std::span<const Mat6>, std::span<const int>);

} // namespace fem
