#pragma once
#include "dem/equilibrium.h"
#include "dem/loading.h"
#include "dem/quasistatic_settings.h"
#include "dem/reduced_time.h"
#include "dem/strain_path.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace dem {

/// A specimen for the quasi-static solver: does not change during a run.
///
/// Neither inertia nor viscosity scaling. Finite motion and rotation, any creep laws, contacts that
/// close, open and slide, breakage.
struct QuasistaticModel {
  Assembly assembly;
  Loading loading;
  RateLaw rate_law;
  QuasistaticSettings settings;
  double strain_limit = std::numeric_limits<double>::infinity();
  Bodies bodies;
  LinkDofs dofs;
  Eigen::VectorXd unit_load;            ///< on the dofs, per unit of the load factor
  Eigen::VectorXd confinement;          ///< dead forces on the dofs [N]
  std::optional<ReducedTime> clock;     ///< temperature over time; absent: the laws as they are
  StepScheme scheme;                    ///< force_linear under prescribed force
  std::vector<double> initial_distance; ///< of the ends of each bond [m]
  double skin;                          ///< gap up to which pairs are linked [m]
};

/// \throws std::invalid_argument for settings out of range or a loading that does not fit
QuasistaticModel make_quasistatic_model(const Assembly& assembly, const Loading& loading,
                                        const RateLaw& rate_law,
                                        const QuasistaticSettings& settings, double strain_limit,
                                        std::optional<ReducedTime> clock = {});

/// The dead forces on the bodies that the specimen carries: with a bond, or with contacts on three
/// sides. A sphere that hangs on less has left the surface, and would fly off.
Eigen::VectorXd carried_confinement(const QuasistaticModel& model, const Links& links);

/// What has happened so far. A value: copying it and going on gives the same future, bit for bit.
struct QuasistaticState {
  std::vector<Vec3> centre;   ///< of all bodies [m]
  std::vector<Vec3> rotation; ///< sum of the turns of each body [rad]
  Links links;
  StrainPath path;          ///< all that the specimen showed; the last point is now
  double next_step = 0;     ///< proposed duration [s]; 0: not known yet
  Eigen::VectorXd velocity; ///< of the dofs in the last step [m/s], as a first guess
  bool settled = false;     ///< false while forces jump: equilibrium at this instant comes first
  int pass = 0;             ///< batches that broke at this instant
  std::vector<Breakage> breakages;
  StaleFactor::Wear wear;
  long n_steps = 0, n_rejected = 0, n_passages = 0;
  int passages_in_a_row = 0;
  double passage_hold = 0;   ///< of the last passage, over the stiffness of contacts; 0: none
  bool in_avalanche = false; ///< more breakages are likely: equilibrium need not be tight
  std::optional<double> passage_start; ///< displacement at the first passage since a step [m]
  RunEnd end = RunEnd::running;
  std::string end_reason;

  double time() const { return path.back().time; }
};

/// The specimen at rest, before the load.
QuasistaticState start(const QuasistaticModel& model);

/// Implicit steps from one equilibrium to the next.
class QuasistaticSolver {
public:
  /// The model must outlive the solver.
  QuasistaticSolver(const QuasistaticModel& model, int n_threads);

  /// Prepares the solver to go on from a state of another solver.
  void resume(const QuasistaticState& state);

  /// The state after one more step in time, or after one more batch of breakages at this instant.
  QuasistaticState step(QuasistaticState state);

  /// Response at a time that was reached.
  Response response(const QuasistaticState& state, double time) const;

  const EquilibriumFinder& finder() const { return finder_; }

private:
  struct Trial;
  Trial attempt(const QuasistaticState& state, double duration, double hold_everything,
                double residual_tolerance);
  void settle(QuasistaticState& state);
  void step_in_time(QuasistaticState& state);
  void take(QuasistaticState& state, Trial&& trial, bool is_jump);
  void break_bonds(QuasistaticState& state);
  void break_or_go_on(QuasistaticState& state);
  void end_if_ruptured(QuasistaticState& state) const;
  void pass_through(QuasistaticState& state, double duration, const Equilibrium& failed);
  std::vector<double> holds(const QuasistaticState& state, double everything,
                            double stiffness) const;
  double rate_now(const QuasistaticState& state, double fallback) const;
  double strength_factor_now(const QuasistaticState& state) const;
  double largest_duration(const QuasistaticState& state) const;
  double first_duration(const QuasistaticState& state) const;

  const QuasistaticModel* model_;
  EquilibriumFinder finder_;
  ElasticNetwork bond_network_;
};

/// Displacement and rotation of a particle so far.
struct BodyMotion {
  Vec3 displacement, rotation;
};
BodyMotion motion(const QuasistaticModel& model, const QuasistaticState& state, Index particle);

/// Force and moment on the first end of a bond, in global axes.
BondLoad link_load(const Links& links, std::size_t k);

} // namespace dem
