#pragma once
#include "dem/load_history.h"
#include "dem/loading.h"
#include "dem/network_solver.h"
#include "dem/records.h"

#include <limits>
#include <string>
#include <vector>

namespace dem {

/// A specimen under load for the event solver: does not change during a run.
///
/// Assumes small displacements and proportional laws: bond forces are then the elastic forces of
/// the present network under the present load.
struct EventsModel {
  ElasticNetwork network;
  NetworkCreep creep;
  Strengths strengths;
  RateLaw rate_law;
  Loading loading;
  AfterBreakage after_breakage = AfterBreakage::leave;
  double gauge_length; ///< [m]
  double strain_limit = std::numeric_limits<double>::infinity();
};

/// Without strengths the bonds are unbreakable.
/// \throws std::invalid_argument if the laws are not proportional, friction is asked for, or the
///         loading does not fit the assembly
EventsModel make_events_model(const Assembly& assembly, const Loading& loading,
                              const RateLaw& rate_law, AfterBreakage after_breakage,
                              double strain_limit);

/// What has happened so far. A value: copying it and going on gives the same future, bit for bit.
struct EventsState {
  LoadHistory history; ///< the last segment begins at the last change
  double segment_end;  ///< latest end of the last segment [s]
  Damage damage;
  Eigen::VectorXd viscous;             ///< dashpot part of the displacements at the last change
  std::vector<Eigen::VectorXd> kelvin; ///< Kelvin parts
  std::vector<Breakage> breakages;     ///< with those that ended the equilibrium, if it was lost
  long n_opened = 0;                   ///< pressed contacts that left
  double largest_ground_share = 0;     ///< of energy in the springs to ground, so far
  RunEnd end = RunEnd::running;
  std::string end_reason;
};

/// Exact solution from one breakage to the next.
///
/// Between two breakages everything is known in closed form: no time step is taken. A bond breaks
/// when its force reaches its strength, by growing load or by falling strength; the network is
/// solved again; at the same instant further bonds may follow (an avalanche). Bonds whose ratios of
/// force to strength agree with the largest to 1e-12 break together.
class EventsSolver {
public:
  /// The model must outlive the solver.
  /// \param most_factored  particles from which on the network is solved by iteration
  explicit EventsSolver(const EventsModel& model,
                        std::size_t most_factored = most_factored_particles);

  /// The specimen at the first instant, the load applied.
  EventsState start();

  /// Prepares the solver to go on from a state of another solver.
  void resume(const EventsState& state);

  /// Time of the next change: a breakage, or a break in the load history.
  double next_change(const EventsState& state) const;

  /// The state after the next change (one batch of bonds, or a new slope of the load).
  EventsState step(EventsState state);

  /// The state after bonds were changed from outside at a time between the last change and the
  /// next.
  EventsState with_changes(EventsState state, double time, std::span<const BondChange> changes);

  /// Response at a time between the last change and the next.
  Response response(const EventsState& state, double time) const;

  /// Displacements of all dofs at such a time.
  Eigen::VectorXd displacements(const EventsState& state, double time) const;

  /// Elastic displacements at such a time: they give the bond forces.
  Eigen::VectorXd elastic_displacements(const EventsState& state, double time) const;

  const NetworkSolver& network_solver() const { return network_solver_; }

private:
  void refresh(const Damage& damage);
  void begin_segment(EventsState& state, double time) const;
  void limit_segment(EventsState& state) const;
  void find_breakage(const EventsState& state);
  void break_bonds(EventsState& state, double time);
  bool apply(EventsState& state, double time, std::span<const BondChange> changes);
  void open_contacts(EventsState& state, double time);
  std::vector<BondChange> contacts_to_open(const EventsState& state, double time) const;

  const EventsModel* model_;
  std::size_t most_factored_;
  NetworkSolver network_solver_;
  Eigen::VectorXd unit_response_; ///< dofs per unit of the load factor
  double compliance_ = 0;         ///< elastic displacement at the load per force [m/N]
  BondRatios ratios_;
  double next_breakage_ = std::numeric_limits<double>::infinity();
};

} // namespace dem
