#include "apps/specimen_run.h"

#include "apps/climbing_run.h"
#include "apps/events_run.h"
#include "apps/linear_run.h"
#include "apps/load_case.h"
#include "apps/quasistatic_run.h"
#include "apps/specimen.h"
#include "apps/stopwatch.h"
#include "dem/dynamics.h"
#include "dem/events.h"
#include "dem/linear.h"
#include "dem/storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace apps {

namespace {

class DynamicRun : public SpecimenRun {
public:
  DynamicRun(const dem::DynamicModel& model, int n_threads)
      : model_(model), n_threads_(n_threads), state_(dem::start(model_))
  {
  }
  void work_towards(double time) override
  {
    const Stopwatch watch;
    while (!ended() && !reached(time) && watch.seconds() < work_slice)
      state_ = dem::advance(model_, std::move(state_), std::min(256L, steps_to(time)), n_threads_);
  }
  bool reached(double time) const override { return steps_to(time) <= 0; }
  bool ended() const override { return end() != dem::RunEnd::running; }
  dem::RunEnd end() const override
  {
    if (state_.end == dem::RunEnd::running && reached(dem::end_time(model_.loading)))
      return dem::RunEnd::finished; // the solver itself looks now and then only
    return state_.end;
  }
  std::string end_reason() const override { return {}; }
  double time() const override { return dem::real_time(model_, state_); }
  dem::Response response(double) const override { return dem::response(model_, state_); }
  Snapshot snapshot(double) const override
  {
    Snapshot snapshot{time(), {}, {}, {}, {}, {}};
    for (std::size_t i = 0; i < model_.slot.size(); ++i) {
      const dem::Motion m = dem::motion(model_, state_, dem::Index(i));
      snapshot.displacement.push_back(m.displacement);
      snapshot.rotation.push_back(m.rotation);
    }
    const std::size_t n_bonds = model_.assembly.bonds.size();
    snapshot.force.assign(n_bonds, dem::Vec3::Zero());
    snapshot.moment.assign(n_bonds, dem::Vec3::Zero());
    snapshot.state.assign(n_bonds, 0);
    for (std::size_t lane = 0; lane < state_.bonds.bond.size(); ++lane)
      if (const dem::Index b = state_.bonds.bond[lane]; b >= 0) {
        const dem::GlobalLoad load =
            dem::global_load(dem::dynamic_bond(state_.bonds, dem::Index(lane)));
        snapshot.force[b] = load.force;
        snapshot.moment[b] = load.moment;
      }
    for (const dem::Breakage& breakage : state_.breakages)
      snapshot.state[breakage.bond] = 2;
    for (const dem::FrictionContact& contact : state_.contacts.contacts)
      if (contact.bond >= 0 && contact.closed)
        snapshot.state[contact.bond] = 1;
    return snapshot;
  }
  const std::vector<dem::Breakage>& breakages() const override { return state_.breakages; }
  void save(dem::Hdf5File& file) const override { dem::write_state(file, "state", state_); }
  void load(const dem::Hdf5File& file) override
  {
    state_ = dem::read_dynamic_state(file, "state", model_);
  }
  std::string statistics() const override
  {
    return fmt::format("{} steps of {:.3g} s simulated time, first axial period {:.3g} s, load "
                       "ramp {:.3g} s (real {:.3g} s)",
                       state_.n_steps, model_.time_step, model_.axial_period, model_.ramp_time,
                       model_.ramp_time / model_.settings.viscosity_scaling);
  }
  Counts counts() const override
  {
    return {
        {"unknowns", 6.0 * double(std::ranges::count(model_.assembly.support, dem::Support::free))},
        {"steps", double(state_.n_steps)},
        {"solves", 0},
        {"factorisations", 0}};
  }
  bool work_is_even_in_time() const override { return true; }

private:
  long steps_to(double time) const
  {
    return long(std::ceil(time * model_.settings.viscosity_scaling / model_.time_step - 1e-9)) -
           state_.n_steps;
  }

  dem::DynamicModel model_;
  int n_threads_;
  dem::DynamicState state_;
};

/// The cheapest rung for a specimen whose bonds all hold.
SolverDecision intact_decision(const Scene& scene, const dem::Assembly& assembly,
                               const dem::Loading& loading, const std::string& reason)
{
  if (!dem::loaded_by_platen(assembly) ||
      assembly.particles.size() > dem::most_factored_particles) // too many to climb with
    return {SolverChoice::linear, reason};
  const dem::LinearModel model = dem::make_linear_model(assembly);
  double largest = 0;
  for (const double time : history_times(scene, loading))
    largest = std::max(largest, std::abs(dem::linear_response(model, loading, time).displacement) /
                                    model.gauge_length);
  if (largest <= scene.small_strain)
    return {SolverChoice::linear, reason};
  return {SolverChoice::events,
          fmt::format("{}, but the strain reaches {:.2g} %; above {:g} % the quasi-static solver "
                      "takes over",
                      reason, 100 * largest, 100 * scene.small_strain)};
}

/// True if a bond breaks under the load, by the event solver.
bool breaks_bonds(const Scene& scene, const dem::Assembly& assembly, const dem::Loading& loading)
{
  const dem::EventsModel model = dem::make_events_model(
      assembly, loading, scene.strength.rate_law, scene.after_breakage, scene.load.strain_limit);
  dem::EventsSolver solver(model);
  dem::EventsState state = solver.start();
  while (state.end == dem::RunEnd::running && state.breakages.empty())
    state = solver.step(std::move(state));
  return !state.breakages.empty();
}

} // namespace

std::string name_of(SolverChoice solver)
{
  switch (solver) {
  case SolverChoice::linear:
    return "linear";
  case SolverChoice::events:
    return "events";
  case SolverChoice::quasistatic:
    return "quasistatic";
  case SolverChoice::dynamic:
    return "dynamic";
  case SolverChoice::continuum:
    return "continuum";
  default:
    return "auto";
  }
}

SolverDecision choose_solver(const Scene& scene, const dem::Assembly& assembly,
                             const dem::Loading& loading)
{
  const bool proportional = dem::proportional_laws(assembly.laws).has_value();
  const std::string hold = "laws are proportional and no bond reaches its strength";
  const std::string several = "the bonds follow several laws that are not proportional, so that "
                              "their forces depend on history";
  if (scene.solver == SolverChoice::linear && !proportional)
    throw std::invalid_argument("Solver = linear: " + several + "; use quasistatic");
  if (scene.solver == SolverChoice::events && !proportional)
    throw std::invalid_argument("Solver = events: " + several + "; use quasistatic");
  if (scene.solver == SolverChoice::linear && assembly.strengths)
    return {SolverChoice::linear, "the scene asks for it (bonds are taken as unbreakable)"};
  if (scene.solver != SolverChoice::automatic)
    return {scene.solver, "the scene asks for it"};
  if (!proportional)
    return {SolverChoice::quasistatic, several};
  if (has_temperature_history(scene))
    return {SolverChoice::quasistatic, "the temperature changes"};
  if (!assembly.confinement.empty())
    return {SolverChoice::quasistatic, "the lateral surface is under stress"};
  if (scene.after_breakage == dem::AfterBreakage::friction && assembly.strengths) {
    if (!loading.true_stress && !breaks_bonds(scene, assembly, loading))
      return intact_decision(scene, assembly, loading, hold);
    return {SolverChoice::quasistatic, "bonds break and keep friction"};
  }
  if (loading.true_stress)
    return {SolverChoice::events, "laws are proportional; the force follows the strain (true "
                                  "stress)"};
  if (!assembly.strengths)
    return intact_decision(scene, assembly, loading,
                           "laws are proportional and bonds do not break");
  if (!breaks_bonds(scene, assembly, loading))
    return intact_decision(scene, assembly, loading, hold);
  return {SolverChoice::events,
          fmt::format(
              "laws are proportional, bonds break and leave no friction; above a strain of {:g} % "
              "the quasi-static solver takes over",
              100 * scene.small_strain)};
}

std::unique_ptr<SpecimenRun> make_run(SolverChoice solver, const Scene& scene,
                                      const dem::Assembly& assembly, const dem::Loading& loading,
                                      int n_threads)
{
  if (solver == SolverChoice::linear)
    return make_linear_run(assembly, loading, scene.strength.rate_law, scene.load.strain_limit);
  if (solver == SolverChoice::events && scene.solver == SolverChoice::automatic)
    return make_climbing_run(scene, assembly, loading, n_threads);
  if (solver == SolverChoice::events)
    return std::make_unique<EventsRun>(dem::make_events_model(
        assembly, loading, scene.strength.rate_law, scene.after_breakage, scene.load.strain_limit));
  if (solver == SolverChoice::quasistatic) {
    const dem::QuasistaticModel model = quasistatic_model(scene, assembly, loading);
    return std::make_unique<QuasistaticRun>(model, dem::start(model), n_threads);
  }
  dem::DynamicSettings settings = scene.dynamic;
  settings.after_breakage = scene.after_breakage;
  settings.friction = scene.friction;
  return std::make_unique<DynamicRun>(dem::make_dynamic_model(assembly, loading,
                                                              scene.strength.rate_law, settings,
                                                              scene.load.strain_limit),
                                      n_threads);
}

} // namespace apps
