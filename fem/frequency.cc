#include "fem/frequency.h"

#include <deal.II/lac/la_parallel_block_vector.h>
#include <deal.II/lac/solver_gmres.h>

#include <fmt/format.h>

#include <stdexcept>

namespace fem {

namespace {

using Pair = dealii::LinearAlgebra::distributed::BlockVector<double>; ///< real, imaginary

/// Storage and loss stiffness as a real system of twice the size.
struct ComplexMatrix {
  const LinearSolver& storage;
  const LinearSolver& loss;

  void vmult(Pair& to, const Pair& from) const
  {
    Vector part = from.block(0);
    for (int k = 0; k < 2; ++k) {
      storage.matrix().vmult(to.block(unsigned(k)), from.block(unsigned(k)));
      loss.matrix().vmult(part, from.block(unsigned(1 - k)));
      to.block(unsigned(k)).add(k == 0 ? -1 : 1, part);
    }
  }
};

struct BothParts {
  const LinearSolver& sum;

  void vmult(Pair& to, const Pair& from) const
  {
    for (unsigned k = 0; k < 2; ++k)
      sum.precondition(from.block(k), to.block(k));
  }
};

/// Work of a stress C eps(u) on the strain of the drive.
template <int dim>
Vector force(const Elements<dim>& elements, const Vector& displacement,
             std::span<const Mat6> tangent, std::span<const int> law_of_point)
{
  std::vector<Vec6> strain(elements.n_points());
  elements.strains(displacement, strain);
  for (std::size_t q = 0; q < strain.size(); ++q)
    strain[q] = (tangent[std::size_t(law_of_point[q])] * strain[q]).eval();
  return elements.internal_force(strain);
}

} // namespace

template <int dim>
std::vector<ComplexStiffness>
drive_stiffness(const Specimen<dim>& specimen, std::span<const ComplianceLaw> laws,
                std::span<const int> law_of_point, std::span<const double> omegas, double tolerance)
{
  const Elements<dim>& elements = specimen.elements();
  const auto& constraints = specimen.supports().constraints;
  const Vector& drive = specimen.supports().drive;
  if (!specimen.supports().driven)
    throw std::invalid_argument("a complex stiffness needs a boundary that is moved");
  LinearSolver storage(elements, constraints), loss(elements, constraints),
      sum(elements, constraints);
  Pair answer(2), right(2);
  for (unsigned k = 0; k < 2; ++k) {
    answer.block(k) = elements.zero();
    right.block(k) = elements.zero();
  }
  answer.collect_sizes();
  right.collect_sizes();
  std::vector<ComplexStiffness> result;
  for (const double omega : omegas) {
    std::vector<Mat6> parts[3]; // storage, loss, sum
    for (const ComplianceLaw& law : laws) {
      const ComplexMat6 c = complex_stiffness(law, omega);
      parts[0].push_back(c.real());
      parts[1].push_back(c.imag());
      parts[2].push_back(c.real() + c.imag());
    }
    storage.assemble(elements, constraints, parts[0], law_of_point);
    loss.assemble(elements, constraints, parts[1], law_of_point);
    sum.assemble(elements, constraints, parts[2], law_of_point);
    sum.set_up();
    std::complex<double> from_drive;
    double size = 0;
    for (unsigned k = 0; k < 2; ++k) {
      Vector load = force(elements, drive, parts[k], law_of_point);
      (k == 0 ? from_drive.real(drive * load) : from_drive.imag(drive * load));
      size = std::hypot(size, load.l2_norm());
      specimen.condense(load);
      load *= -1;
      right.block(k) = load;
    }
    dealii::SolverControl control(500, tolerance * size);
    dealii::SolverGMRES<Pair> solver(control, dealii::SolverGMRES<Pair>::AdditionalData(102, true));
    try {
      solver.solve(ComplexMatrix{storage, loss}, answer, right, BothParts{sum});
    } catch (const dealii::SolverControl::NoConvergence& failure) {
      throw std::runtime_error(fmt::format("the system at {:.4g} rad/s was not solved in {} "
                                           "iterations",
                                           omega, failure.last_step));
    }
    // (v + x)^T C* (v + x) with C* symmetric: from the drive alone, less what the answer gives
    const std::complex<double> mixed(
        answer.block(0) * right.block(0) - answer.block(1) * right.block(1),
        answer.block(0) * right.block(1) + answer.block(1) * right.block(0));
    result.push_back({omega, from_drive - mixed, int(control.last_step())});
  }
  return result;
}

template std::vector<ComplexStiffness> drive_stiffness(const Specimen<2>&,
                                                       std::span<const ComplianceLaw>,
                                                       std::span<const int>,
                                                       std::span<const double>, double);
template std::vector<ComplexStiffness> drive_stiffness(const Specimen<3>&,
                                                       std::span<const ComplianceLaw>,
                                                       std::span<const int>,
                                                       std::span<const double>, double);

} // namespace fem
