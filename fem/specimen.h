#pragma once
#include "fem/linear_solver.h"
#include "fem/material_points.h"
#include "fem/supports.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace fem {

/// A load on a boundary.
struct SurfaceLoad {
  std::string boundary;
  Vec3 traction = Vec3::Zero(); ///< [Pa]
  double pressure = 0;          ///< against the outward normal [Pa]
  bool constant = false;        ///< in full from the start, instead of times the load factor
};

/// What acts on a body, apart from its history.
struct BodyLoads {
  std::vector<Support> supports;
  std::vector<SurfaceLoad> surface;
  Vec3 weight = Vec3::Zero(); ///< force per volume [N/m^3], times the load factor
};

/// Loads at a time.
struct LoadState {
  bool drive_by_force = true;
  double drive = 0;       ///< force on the driven boundaries [N], or multiple of their displacement
  double load_factor = 0; ///< of the loads that are not constant [-]
};

/// What a step took.
struct StepReport {
  int n_evaluations = 0; ///< of all points
  int n_solves = 0, n_iterations = 0;
  bool assembled = false; ///< a new matrix with its multigrid
  double residual = 0;    ///< over the forces in play [-]
};

/// Newton's method has not converged, or forces are no numbers; thrown on all ranks alike.
struct NoEquilibrium : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A body of finite elements and its displacement. It asks one function for stress and tangent and
/// never sees a state.
template <int dim>
class Specimen {
public:
  /// \param tolerance  residual force over the forces in play (loads and reactions) [-], > 0
  /// \throws std::invalid_argument as Elements, make_supports
  Specimen(const Mesh<dim>& mesh, const Discretisation& discretisation, const BodyLoads& loads,
           double tolerance);

  const Elements<dim>& elements() const { return elements_; }
  const Supports<dim>& supports() const { return supports_; }
  const Vector& displacement() const { return displacement_; } ///< committed [m]

  /// Finds the displacement increment of a step: Newton's method on the residual of total forces;
  /// one solve where the stress is affine in the strain. Nothing is committed.
  /// \param step  of reduced time [s]
  /// \throws NoEquilibrium if it does not converge
  StepReport solve_step(const LoadState& load, double step, const ConstitutiveUpdate& update);

  /// Takes over the increment of the last step.
  void commit();

  /// Force on the driven boundaries [N] and multiple of their displacement, at the end of the last
  /// step.
  double drive_force() const { return drive_force_; }
  double drive_displacement() const { return drive_displacement_; }

  /// Passes the forces on hanging nodes to those that they hang on; zero where held.
  void condense(Vector& force) const;

  /// Force per unit of the drive that the last tangents answer with [N].
  double drive_stiffness() const { return mode_scale_ * mode_stiffness_; }

  /// Mean displacement of the body along its loads, or along its drive if it has no loads [m].
  double mean_displacement() const;

  /// Takes over a displacement, and the force on the driven boundaries, from elsewhere.
  void set_displacement(const Vector& displacement, double drive_displacement);
  void set_drive_force(double force) { drive_force_ = force; }

private:
  void prepare(const ConstitutiveAnswer& answer, StepReport& report);
  void find_drive_mode(StepReport& report);
  Vector external_force(double load_factor) const;
  void solve(const Vector& right, double residual, Vector& x, StepReport& report);
  Vector tangent_force(const Vector& displacement) const;
  void apply(Vector& to, const Vector& from) const;
  void guess(const Vector& residual, Vector& x) const;

  double tolerance_;
  Elements<dim> elements_;
  Supports<dim> supports_;
  LinearSolver solver_;
  Vector constant_load_, varying_load_;

  std::vector<Mat6> assembled_, present_; ///< tangents of the matrix, and of the step
  std::vector<int> which_;
  double matrix_scale_ = 1;   ///< present tangents over those of the matrix, if as_assembled_
  double mode_scale_ = 1;     ///< present tangents over those that the mode was found for
  bool as_assembled_ = true;  ///< whether they are those of the matrix but for a factor
  Vector mode_, mode_load_;   ///< answer to a unit of the drive; stiffness times the drive
  double mode_stiffness_ = 0; ///< force per unit of the drive [N], of that tangent

  Vector displacement_, increment_, last_increment_;
  std::vector<Vec6> strains_;
  mutable std::vector<Vec6> work_; ///< of tangent_force
  double drive_force_ = 0, drive_displacement_ = 0, drive_increment_ = 0;
};

} // namespace fem
