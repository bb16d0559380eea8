#include "dem/events.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Of a strain at the end of a segment against that at the start of the next.
constexpr double rounding = 1e-12;
/// Share of the energy in springs to ground from which on contacts do not hold a piece.
constexpr double most_ground_share = 1e-8;
/// Change of strain over which the force under constant true stress is taken as linear in time.
constexpr double true_stress_strain_step = 1e-4;
/// Contact force that counts as tension, relative to the largest bond force.
constexpr double contact_noise = 1e-10;

/// Brings the viscous and Kelvin fields from the start of the last segment to a time.
void creep_fields(EventsState& state, const NetworkCreep& creep, const Eigen::VectorXd& response,
                  double time)
{
  const LoadMemory gained = memory(state.history.segments.back(), creep, time);
  state.viscous += gained.viscous * response;
  for (std::size_t k = 0; k < state.kelvin.size(); ++k)
    state.kelvin[k] = gained.decay[k] * state.kelvin[k] + gained.kelvin[k] * response;
}

/// Segment that begins at a time with the prescribed force and this compliance.
ForceSegment force_segment(const EventsModel& model, const CreepState<double>& before,
                           double jumps_before, double time, double compliance)
{
  const double value = load_value(model.loading, time);
  ForceSegment next{time, value, load_rate(model.loading, time), compliance, before, 0};
  if (model.loading.true_stress)
    for (int k = 0; k < 60; ++k) { // converges like the strain to the power k
      const double length = displacement(before) - before.elastic + compliance * next.load;
      next.load = value / (1 + length / model.gauge_length);
    }
  next.state.elastic = compliance * next.load;
  next.jumps = jumps_before + next.state.elastic - before.elastic;
  return next;
}

/// Makes the force of a segment follow the area of the specimen; returns how far that is accurate.
double follow_area(ForceSegment& segment, const EventsModel& model, double latest_end)
{
  const double length_before = displacement(segment.state);
  for (double dt = latest_end - segment.start; segment.start + dt > segment.start; dt *= 0.5) {
    const double value =
        load_value(model.loading, segment.start) + load_rate(model.loading, segment.start) * dt;
    double length = length_before;
    for (int k = 0; k < 60; ++k) {
      segment.load_rate = (value / (1 + length / model.gauge_length) - segment.load) / dt;
      const double step = segment.compliance * segment.load_rate * dt;
      length = displacement(creep_step(model.creep.law, segment.state, step, dt));
    }
    if (std::abs(length - length_before) <= true_stress_strain_step * model.gauge_length)
      return segment.start + dt;
  }
  return latest_end;
}

/// The same for a prescribed displacement.
DisplacementSegment displacement_segment(const EventsModel& model,
                                         const DisplacementSegment& before, double time)
{
  const double dt = time - before.start;
  DisplacementSegment next{
      time,
      load_value(model.loading, time),
      load_rate(model.loading, time),
      relaxation_step(model.creep.spectrum, before.modes, before.rate * dt, dt),
      0,
      before.jumps};
  const double jump = next.displacement - (before.displacement + before.rate * dt);
  for (std::size_t i = 0; i < next.modes.size(); ++i)
    next.modes[i] += model.creep.spectrum[i].stiffness * jump;
  next.jumps += jump;
  return next;
}

} // namespace

EventsModel make_events_model(const Assembly& assembly, const Loading& loading,
                              const RateLaw& rate_law, AfterBreakage after_breakage,
                              double strain_limit)
{
  validate(assembly);
  validate(loading);
  refuse_confinement(assembly, "events");
  const std::optional<ProportionalLaws> laws = proportional_laws(assembly.laws);
  if (!laws)
    throw std::invalid_argument("the event solver needs bond laws that are proportional to each "
                                "other: one function of time for all bonds");
  if (!loaded_by_platen(assembly) &&
      (loading.control == Loading::Control::displacement || loading.true_stress))
    throw std::invalid_argument("loads on particles have a history of their factor only, no "
                                "displacement or true stress");
  const std::vector<double> endless(assembly.bonds.size(), infinity);
  return {make_network(assembly),
          network_creep(laws->creep),
          assembly.strengths.value_or(Strengths{endless, endless, 0}),
          rate_law,
          loading,
          after_breakage,
          assembly.gauge_length,
          strain_limit};
}

EventsSolver::EventsSolver(const EventsModel& model, std::size_t most_factored)
    : model_(&model), most_factored_(most_factored),
      network_solver_(model.network, undamaged(model.network), most_factored)
{
  refresh(undamaged(model.network));
}

EventsState EventsSolver::start()
{
  EventsState state;
  state.damage = undamaged(model_->network);
  state.history = {model_->creep, {}, model_->gauge_length};
  state.viscous = Eigen::VectorXd::Zero(model_->network.n_dofs);
  state.kelvin.assign(model_->creep.law.branches.size(), state.viscous);
  if (!network_solver_.response()) {
    state.end = RunEnd::lost_equilibrium;
    state.end_reason = network_solver_.obstacle();
  }
  begin_segment(state, model_->loading.points.front().time);
  limit_segment(state);
  find_breakage(state);
  return state;
}

void EventsSolver::resume(const EventsState& state)
{
  network_solver_ = NetworkSolver(model_->network, state.damage, most_factored_);
  refresh(state.damage);
  find_breakage(state);
}

void EventsSolver::refresh(const Damage& damage)
{
  const Eigen::VectorXd& load = model_->network.unit_load;
  unit_response_ = Eigen::VectorXd::Zero(model_->network.n_dofs);
  compliance_ = 0;
  double scale = 0; // of the response that is used over that of the solver
  if (network_solver_.response() && !load.isZero(0)) {
    unit_response_ = *network_solver_.response();
    compliance_ = load.dot(unit_response_) / load.norm();
    scale = model_->loading.control == Loading::Control::displacement ? 1 / compliance_ : 1;
    unit_response_ *= scale;
  }
  std::vector<ForcePair> force(damage.status.size(), {0, 0});
  if (scale > 0)
    std::ranges::transform(network_solver_.bond_forces(), force.begin(), [&](ForcePair f) {
      return ForcePair{scale * f.normal, scale * f.shear};
    });
  ratios_ = bond_ratios(damage.status, model_->strengths, std::move(force));
}

void EventsSolver::begin_segment(EventsState& state, double time) const
{
  std::vector<LoadSegment>& segments = state.history.segments;
  if (model_->loading.control == Loading::Control::force) {
    CreepState<double> before = virgin_state(model_->creep.law);
    double jumps = 0;
    if (!segments.empty()) {
      const auto& last = std::get<ForceSegment>(segments.back());
      const double dt = time - last.start;
      before = creep_step(model_->creep.law, last.state, last.compliance * last.load_rate * dt, dt);
      jumps = last.jumps;
    }
    segments.push_back(force_segment(*model_, before, jumps, time, compliance_));
  } else {
    const RelaxationState at_rest(model_->creep.spectrum.size(), 0.0);
    const DisplacementSegment before = segments.empty()
                                           ? DisplacementSegment{time, 0, 0, at_rest, 0, 0}
                                           : std::get<DisplacementSegment>(segments.back());
    segments.push_back(displacement_segment(*model_, before, time));
  }
}

void EventsSolver::limit_segment(EventsState& state) const
{
  LoadSegment& segment = state.history.segments.back();
  const double time = dem::start(segment), last = end_time(model_->loading);
  state.segment_end = std::min(next_breakpoint(model_->loading, time), last);
  if (state.end != RunEnd::running)
    return;
  if (time >= last) {
    state.end = RunEnd::finished;
    return;
  }
  if (model_->loading.true_stress)
    state.segment_end = follow_area(std::get<ForceSegment>(segment), *model_, state.segment_end);
  if (std::abs(strain(state.history, time)) >= (1 - rounding) * model_->strain_limit)
    state.end = RunEnd::strain_limit;
  else if (const auto reached =
               first_strain(state.history, model_->strain_limit, time, state.segment_end))
    state.segment_end = *reached;
  if (model_->after_breakage == AfterBreakage::pressed)
    if (const auto turn = first_turn(state.history, time, state.segment_end))
      state.segment_end = *turn;
}

void EventsSolver::find_breakage(const EventsState& state)
{
  next_breakage_ = infinity;
  if (state.end == RunEnd::running)
    next_breakage_ = first_breakage(state.history, model_->rate_law, ratios_.critical,
                                    dem::start(state.history.segments.back()), state.segment_end)
                         .value_or(infinity);
}

double EventsSolver::next_change(const EventsState& state) const
{
  return state.end == RunEnd::running ? std::min(next_breakage_, state.segment_end) : infinity;
}

EventsState EventsSolver::step(EventsState state)
{
  if (state.end != RunEnd::running)
    return state;
  if (next_breakage_ <= state.segment_end)
    break_bonds(state, next_breakage_);
  else {
    creep_fields(state, model_->creep, unit_response_, state.segment_end);
    begin_segment(state, state.segment_end);
    open_contacts(state, dem::start(state.history.segments.back()));
  }
  limit_segment(state);
  find_breakage(state);
  return state;
}

EventsState EventsSolver::with_changes(EventsState state, double time,
                                       std::span<const BondChange> changes)
{
  creep_fields(state, model_->creep, unit_response_, time);
  if (apply(state, time, changes))
    open_contacts(state, time);
  limit_segment(state);
  find_breakage(state);
  return state;
}

void EventsSolver::break_bonds(EventsState& state, double time)
{
  const LoadSegment segment = state.history.segments.back();
  const double load = dem::load(segment, model_->creep, time);
  const double factor = strength_factor(
      model_->rate_law, averaged_strain_rate(state.history, model_->rate_law, time));
  const bool again = !state.breakages.empty() && state.breakages.back().time == time;
  const int pass = again ? state.breakages.back().pass + 1 : 0;
  std::vector<BondChange> changes;
  std::vector<Breakage> record;
  for (const Index b : critical_bonds(ratios_, load > 0)) {
    const double normal = load * ratios_.force[b].normal;
    const double shear = std::abs(load) * ratios_.force[b].shear;
    const bool by_tension =
        normal > 0 && normal * model_->strengths.shear[b] >= shear * model_->strengths.normal[b];
    const bool stays = model_->after_breakage == AfterBreakage::pressed && normal < 0;
    changes.push_back({b, stays ? BondStatus::pressed : BondStatus::gone});
    record.push_back({time, b, by_tension ? BreakMode::tension : BreakMode::shear, normal, shear,
                      factor, strain(state.history, time), pass});
  }
  creep_fields(state, model_->creep, unit_response_, time);
  const bool carries = apply(state, time, changes);
  state.breakages.insert(state.breakages.end(), record.begin(), record.end());
  if (carries)
    open_contacts(state, time);
}

void EventsSolver::open_contacts(EventsState& state, double time)
{
  for (;;) {
    const std::vector<BondChange> open = contacts_to_open(state, time);
    if (open.empty() || !apply(state, time, open))
      break;
    state.n_opened += std::ssize(open);
  }
}

/// Changes the network; the fields must have been brought to the time. On loss of equilibrium the
/// state keeps the last network that could carry the load.
bool EventsSolver::apply(EventsState& state, double time, std::span<const BondChange> changes)
{
  const Pieces before = network_solver_.pieces();
  Damage damage = network_solver_.apply(state.damage, changes);
  if (!network_solver_.response()) {
    state.end = RunEnd::lost_equilibrium;
    state.end_reason = network_solver_.obstacle();
    begin_segment(state, time);
    return false;
  }
  const double load = dem::load(state.history.segments.back(), model_->creep, time);
  for (std::size_t i = 0; i < before.piece.size(); ++i) { // what comes loose stays where it is
    const Index dof = model_->network.first_dof[i];
    if (dof < 0 || network_solver_.pieces().of(Index(i)) != PieceHold::loose ||
        before.of(Index(i)) == PieceHold::loose)
      continue;
    auto frozen = state.viscous.segment<6>(dof);
    frozen += load * unit_response_.segment<6>(dof);
    for (Eigen::VectorXd& kelvin : state.kelvin) {
      frozen += kelvin.segment<6>(dof);
      kelvin.segment<6>(dof).setZero();
    }
  }
  state.damage = std::move(damage);
  refresh(state.damage);
  state.largest_ground_share =
      std::max(state.largest_ground_share,
               std::min(network_solver_.ground_energy_share(), most_ground_share));
  begin_segment(state, time);
  return true;
}

std::vector<BondChange> EventsSolver::contacts_to_open(const EventsState& state, double time) const
{
  std::vector<BondChange> changes;
  if (model_->after_breakage == AfterBreakage::leave)
    return changes;
  const LoadSegment& segment = state.history.segments.back();
  double load = dem::load(segment, model_->creep, time);
  if (load == 0 && time < end_time(model_->loading)) // what the load is about to do
    load = dem::load(segment, model_->creep,
                     shortly_after(time, next_breakpoint(model_->loading, time)));
  double largest = 0;
  for (const ForcePair& force : ratios_.force)
    largest = std::max(largest, std::abs(load * force.normal));
  const bool squeezed_out = network_solver_.ground_energy_share() > most_ground_share;
  for (std::size_t b = 0; b < ratios_.force.size(); ++b) {
    if (state.damage.status[b] != BondStatus::pressed)
      continue;
    const auto& ends = model_->network.bonds[b].ends;
    const bool unsteady = squeezed_out && std::ranges::any_of(ends, [&](Index i) {
                            return network_solver_.pieces().of(i) == PieceHold::clamped;
                          });
    if (unsteady || load * ratios_.force[b].normal > contact_noise * largest)
      changes.push_back({Index(b), BondStatus::gone});
  }
  return changes;
}

Response EventsSolver::response(const EventsState& state, double time) const
{
  const LoadSegment& segment = segment_at(state.history, time);
  const double factor = dem::load(segment, model_->creep, time);
  const bool by_force = model_->loading.control == Loading::Control::force;
  const double rate = averaged_strain_rate(state.history, model_->rate_law, time);
  return {time,
          by_force ? factor : factor / compliance_,
          strain(state.history, time),
          rate,
          strength_factor(model_->rate_law, rate),
          compliance_,
          std::ssize(state.breakages)};
}

Eigen::VectorXd EventsSolver::displacements(const EventsState& state, double time) const
{
  EventsState now = state;
  creep_fields(now, model_->creep, unit_response_, time);
  Eigen::VectorXd sum = elastic_displacements(state, time) + now.viscous;
  for (const Eigen::VectorXd& part : now.kelvin)
    sum += part;
  return sum;
}

std::vector<Eigen::VectorXd> EventsSolver::kelvin_displacements(const EventsState& state,
                                                                double time) const
{
  EventsState now = state;
  creep_fields(now, model_->creep, unit_response_, time);
  return now.kelvin;
}

Eigen::VectorXd EventsSolver::elastic_displacements(const EventsState& state, double time) const
{
  return dem::load(state.history.segments.back(), model_->creep, time) * unit_response_;
}

} // namespace dem
