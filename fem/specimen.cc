#include "fem/specimen.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace fem {

namespace {

constexpr int most_newton_steps = 25;
constexpr double same_tangent = 1e-13; ///< relative
constexpr double worn_multigrid = 2;   ///< ratio of stiffnesses between directions
constexpr double mode_sharpness = 1e-5;

/// The factor between two lists of tangents that are the same up to it.
std::optional<double> proportion(std::span<const Mat6> a, std::span<const Mat6> b)
{
  if (a.size() != b.size() || a.empty())
    return std::nullopt;
  const double factor = a[0].norm() / b[0].norm();
  for (std::size_t k = 0; k < a.size(); ++k)
    if ((a[k] - factor * b[k]).norm() > same_tangent * a[k].norm())
      return std::nullopt;
  return factor;
}

/// How much the ratio of the stiffnesses of two lists differs between directions and places.
double distortion(std::span<const Mat6> a, std::span<const Mat6> b)
{
  if (a.size() != b.size())
    return std::numeric_limits<double>::infinity();
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (const double factor = a[k].norm() / b[k].norm();
        (a[k] - factor * b[k]).norm() <= same_tangent * a[k].norm()) {
      least = std::min(least, factor);
      most = std::max(most, factor);
      continue;
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Mat6> solver(a[k], b[k], Eigen::EigenvaluesOnly);
    least = std::min(least, solver.eigenvalues()[0]);
    most = std::max(most, solver.eigenvalues()[5]);
  }
  return most / least;
}

} // namespace

template <int dim>
Specimen<dim>::Specimen(const Mesh<dim>& mesh, const Discretisation& discretisation,
                        const BodyLoads& loads, double tolerance)
    : tolerance_(tolerance), elements_(mesh, discretisation),
      supports_(make_supports(mesh, elements_, loads.supports)),
      solver_(elements_, supports_.constraints)
{
  for (Vector* each : {&constant_load_, &varying_load_, &mode_, &mode_load_, &displacement_,
                       &increment_, &last_increment_})
    *each = elements_.zero();
  for (const SurfaceLoad& load : loads.surface)
    elements_.add_surface_load(boundary_id(mesh, load.boundary), load.traction, load.pressure,
                               load.constant ? constant_load_ : varying_load_);
  if (!loads.weight.isZero(0))
    elements_.add_body_force(loads.weight, varying_load_);
  strains_.resize(elements_.n_points());
}

template <int dim>
Vector Specimen<dim>::external_force(double load_factor) const
{
  Vector force = constant_load_;
  force.add(load_factor, varying_load_);
  return force;
}

template <int dim>
void Specimen<dim>::condense(Vector& force) const
{
  const auto owned = elements_.dofs().locally_owned_dofs();
  force.zero_out_ghost_values();
  for (const auto& line : supports_.constraints.get_lines())
    if (owned.is_element(line.index)) {
      const double value = force(line.index);
      force(line.index) = 0;
      for (const auto& [master, weight] : line.entries)
        force(master) += weight * value;
    }
  force.compress(dealii::VectorOperation::add);
}

/// Solves with the present tangent; zero where held. The guess is that of the present tangent, too.
template <int dim>
void Specimen<dim>::solve(const Vector& right, double residual, Vector& x, StepReport& report)
{
  x.zero_out_ghost_values();
  if (as_assembled_) {
    x *= matrix_scale_;
    report.n_iterations += solver_.solve(right, residual, x);
    x /= matrix_scale_;
  } else
    report.n_iterations +=
        solver_.solve([this](Vector& to, const Vector& from) { apply(to, from); },
                      supports_.constraints, right, residual, x);
  ++report.n_solves;
  supports_.constraints.distribute(x);
  x.update_ghost_values();
}

/// Stiffness of the present tangents times a vector, without a matrix.
template <int dim>
void Specimen<dim>::apply(Vector& to, const Vector& from) const
{
  Vector displacement = from;
  supports_.constraints.distribute(displacement);
  displacement.update_ghost_values();
  to = tangent_force(displacement);
  condense(to);
}

/// Forces of the present tangents under a displacement.
template <int dim>
Vector Specimen<dim>::tangent_force(const Vector& displacement) const
{
  work_.resize(elements_.n_points());
  elements_.strains(displacement, work_);
  for (std::size_t q = 0; q < work_.size(); ++q) {
    const std::size_t k = present_.size() == 1 ? 0 : which_.empty() ? q : std::size_t(which_[q]);
    work_[q] = (present_[k] * work_[q]).eval();
  }
  return elements_.internal_force(work_);
}

/// Matrix, multigrid and drive mode for the tangents of an answer. What still stands is kept: the
/// matrix serves proportional tangents; the multigrid serves tangents that differ a little, whose
/// stiffness is then applied without a matrix.
template <int dim>
void Specimen<dim>::prepare(const ConstitutiveAnswer& answer, StepReport& report)
{
  const MPI_Comm ranks = elements_.ranks();
  const auto all = [&](bool mine) { return dealii::Utilities::MPI::min(int(mine), ranks) == 1; };
  const std::optional<double> same = proportion(answer.tangent, present_);
  if (all(same.has_value())) {
    matrix_scale_ *= *same;
    mode_scale_ *= *same;
    present_.assign(answer.tangent.begin(), answer.tangent.end());
    return;
  }
  present_.assign(answer.tangent.begin(), answer.tangent.end());
  which_.assign(answer.which.begin(), answer.which.end());
  mode_scale_ = matrix_scale_ = 1;
  const std::optional<double> as_matrix = proportion(present_, assembled_);
  as_assembled_ = all(as_matrix.has_value());
  if (as_assembled_)
    matrix_scale_ = *as_matrix;
  else if (const double distorted =
               dealii::Utilities::MPI::max(distortion(present_, assembled_), ranks);
           !(distorted < worn_multigrid)) {
    assembled_ = present_;
    solver_.assemble(elements_, supports_.constraints, assembled_, which_);
    solver_.set_up();
    as_assembled_ = true;
    report.assembled = true;
  }
  if (supports_.driven)
    find_drive_mode(report);
}

/// The mode need not be sharp: what it leaves is a residual of the next Newton step.
template <int dim>
void Specimen<dim>::find_drive_mode(StepReport& report)
{
  mode_load_ = tangent_force(supports_.drive);
  const double from_drive = supports_.drive * mode_load_, largest = mode_load_.l2_norm();
  condense(mode_load_);
  mode_load_ *= -1;
  mode_.zero_out_ghost_values();
  mode_ -= supports_.drive; // the mode before is the guess
  supports_.constraints.set_zero(mode_);
  const double sharpness = report.assembled ? 0.1 * tolerance_ : mode_sharpness;
  solve(mode_load_, sharpness * largest, mode_, report);
  mode_stiffness_ = from_drive - mode_ * mode_load_;
  mode_.zero_out_ghost_values();
  mode_ += supports_.drive;
  mode_.update_ghost_values();
}

/// Adds to a start at zero the best multiples of what the body has done before.
template <int dim>
void Specimen<dim>::guess(const Vector& residual, Vector& x) const
{
  Vector rest = residual, force = elements_.zero();
  for (const Vector* each : {&last_increment_, &displacement_}) {
    Vector direction = *each;
    direction.zero_out_ghost_values();
    supports_.constraints.set_zero(direction);
    apply(force, direction);
    const double energy = direction * force;
    if (!(energy > 0))
      continue;
    const double share = (direction * rest) / energy;
    x.add(share, direction);
    rest.add(-share, force);
  }
}

template <int dim>
StepReport Specimen<dim>::solve_step(const LoadState& load, double step,
                                     const ConstitutiveUpdate& update)
{
  StepReport report;
  const Vector external = external_force(load.load_factor);
  increment_ = 0;
  drive_increment_ = 0;
  Vector correction = elements_.zero();
  double in_play = 0; // the largest while solving: a body that is unloaded has none at the end
  for (int newton = 0; newton < most_newton_steps; ++newton) {
    increment_.update_ghost_values();
    elements_.strains(increment_, strains_);
    const ConstitutiveAnswer answer = update(strains_, step);
    ++report.n_evaluations;
    prepare(answer, report);
    const Vector internal = elements_.internal_force(answer.stress);
    in_play = std::max({in_play, internal.l2_norm(), external.l2_norm()});
    if (supports_.driven && !load.drive_by_force && newton == 0) {
      drive_increment_ = load.drive - drive_displacement_;
      if (drive_increment_ != 0) { // the way of the boundaries first
        increment_.zero_out_ghost_values();
        increment_.add(drive_increment_, mode_);
        continue;
      }
    }
    Vector residual = external;
    residual -= internal;
    drive_force_ = -(supports_.drive * residual);
    double drive_residual = 0;
    if (supports_.driven && load.drive_by_force) {
      drive_residual = load.drive - drive_force_;
      in_play = std::max(in_play, std::abs(load.drive) / supports_.drive.l2_norm());
    }
    condense(residual);
    const double size = std::hypot(
        residual.l2_norm(), supports_.driven ? drive_residual / supports_.drive.l2_norm() : 0.);
    if (!std::isfinite(size))
      throw NoEquilibrium("forces are no numbers any more");
    report.residual = in_play > 0 ? size / in_play : 0;
    if (report.residual <= tolerance_)
      return report;
    correction = 0;
    double along = 0;
    if (residual.l2_norm() > 0.3 * tolerance_ * in_play) {
      guess(residual, correction);
      solve(residual, 0.1 * tolerance_ * in_play, correction, report);
      along = -mode_scale_ * (mode_load_ * correction);
    }
    increment_.zero_out_ghost_values();
    correction.zero_out_ghost_values();
    increment_ += correction;
    if (supports_.driven && load.drive_by_force) {
      const double further = (drive_residual - along) / (mode_scale_ * mode_stiffness_);
      drive_increment_ += further;
      increment_.add(further, mode_);
    }
  }
  throw NoEquilibrium(fmt::format("no equilibrium in {} Newton steps: residual {:.3g} of the "
                                  "forces in play, wanted {:.3g}",
                                  most_newton_steps, report.residual, tolerance_));
}

template <int dim>
void Specimen<dim>::commit()
{
  displacement_.zero_out_ghost_values();
  increment_.zero_out_ghost_values();
  displacement_ += increment_;
  last_increment_ = increment_;
  drive_displacement_ += drive_increment_;
  displacement_.update_ghost_values();
}

template <int dim>
double Specimen<dim>::mean_displacement() const
{
  const Vector& along = varying_load_.l1_norm() > 0    ? varying_load_
                        : constant_load_.l1_norm() > 0 ? constant_load_
                                                       : supports_.drive;
  return along * displacement_ / along.l1_norm();
}

template <int dim>
void Specimen<dim>::set_displacement(const Vector& displacement, double drive_displacement)
{
  displacement_ = displacement;
  displacement_.update_ghost_values();
  drive_displacement_ = drive_displacement;
}

template class Specimen<2>;
template class Specimen<3>;

} // namespace fem
