#include "dem/quasistatic.h"

#include "dem/breakage_search.h"
#include "dem/connectivity.h"
#include "dem/link_strength.h"
#include "dem/quasistatic_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Bonds whose ratios agree to this share break together, over the residual tolerance.
constexpr double tie_over_tolerance = 10;
/// Force beyond the strength at which a single breakage counts as found.
constexpr double breakage_overshoot = 1e-10;
/// Hold of loose particles in place, over that of contacts against sliding and rolling.
constexpr double ground_share = 1e-4;
constexpr int most_attempts = 60;
constexpr double largest_growth = 1.6;

/// Load at the end of a step that begins now and crosses no breakpoint.
double load_after(const Loading& loading, double time, double duration)
{
  return load_value(loading, time) + load_rate(loading, time) * duration;
}

/// Of each bond; none if bonds do not break.
std::vector<double> ratios_of(const QuasistaticModel& model, const Links& links)
{
  const std::optional<Strengths>& strengths = model.assembly.strengths;
  return strengths ? strength_ratios(links, *strengths, model.settings.residual_tolerance)
                   : std::vector<double>(model.assembly.bonds.size(), 0.0);
}

double largest_ratio(std::span<const double> ratios)
{
  return ratios.empty() ? 0 : std::ranges::max(ratios);
}

} // namespace

QuasistaticSolver::QuasistaticSolver(const QuasistaticModel& model, int n_threads)
    : model_(&model), finder_(model.dofs, n_threads), bond_network_(make_network(model.assembly))
{
}

void QuasistaticSolver::resume(const QuasistaticState& state)
{
  finder_.factor().restore(state.wear, model_->dofs);
}

std::vector<double> QuasistaticSolver::holds(const QuasistaticState& state, double everything,
                                             double stiffness) const
{
  const std::size_t n = model_->bodies.radius.size();
  std::vector<double> hold(n, everything * stiffness);
  std::vector<BondStatus> status(bond_network_.bonds.size());
  for (std::size_t b = 0; b < status.size(); ++b)
    status[b] = state.links.link[b].kind == LinkKind::bond ? BondStatus::intact : BondStatus::gone;
  const Pieces pieces = find_pieces(bond_network_, status);
  for (std::size_t i = 0; i + 2 < n; ++i)
    if (model_->dofs.first_dof[i] >= 0 && pieces.of(Index(i)) != PieceHold::held)
      hold[i] += ground_share * model_->settings.regularisation * stiffness;
  return hold;
}

QuasistaticSolver::Trial QuasistaticSolver::attempt(const QuasistaticState& state, double duration,
                                                    double hold_everything,
                                                    double residual_tolerance)
{
  const QuasistaticModel& model = *model_;
  const Assembly& assembly = model.assembly;
  const double time = state.time();
  std::vector<LawStep> laws, others;
  double stiffness = 0;
  const StepScheme other = model.scheme == StepScheme::force_linear
                               ? StepScheme::displacement_linear
                               : StepScheme::force_linear;
  const double reduced =
      model.clock ? reduced_duration(*model.clock, time, time + duration) : duration;
  for (const BondLaw& law : assembly.laws) {
    laws.push_back(law_step(law.creep, model.scheme, reduced, state.links.n_parts));
    others.push_back(law_step(law.creep, other, reduced, state.links.n_parts));
    stiffness += laws.back().stiffness() / double(assembly.laws.size());
  }
  const BodyLinks links_of = body_links(state.links, state.centre.size());
  const double friction =
      model.settings.after_breakage == AfterBreakage::friction ? model.settings.friction : 0;
  const Eigen::VectorXd confinement = carried_confinement(model, state.links);
  Trial trial{duration, {}, {}, 0, 0, {}, 0};
  trial.load = load_after(model.loading, time, duration);
  EquilibriumProblem problem{{&assembly, &model.bodies, &state.links, state.centre, laws, friction,
                              model.settings.regularisation, model.settings.geometry},
                             &links_of,
                             holds(state, hold_everything, stiffness),
                             confinement,
                             {},
                             0,
                             residual_tolerance,
                             stiffness};
  const double displaced = state.path.back().displacement;
  if (!loaded_by_platen(assembly))
    problem.external += trial.load * model.unit_load;
  else if (model.loading.control == Loading::Control::displacement)
    problem.platen_moved = trial.load - displaced;
  else
    problem.platen_force = [&](double moved) {
      return model.loading.true_stress
                 ? trial.load / (1 + (displaced + moved) / assembly.gauge_length)
                 : trial.load;
    };
  Eigen::VectorXd guess = duration * state.velocity;
  trial.equilibrium = finder_.find(problem, guess);
  if (!trial.equilibrium.found)
    return trial;

  const Equilibrium& found = trial.equilibrium;
  trial.links = state.links;
  const auto n_links = Index(state.links.link.size());
  std::vector<LinkEnergies> gained(n_links);
  std::vector<double> difference(n_links, 0.0), size(n_links, 0.0);
  for (Index k = 0; k < n_links; ++k) {
    const LinkAnswer end = answer(problem.step, k, found.at);
    gained[k] = commit(problem.step, k, end, trial.links);
    if (duration > 0 && end.closed && state.links.link[k].closed)
      scheme_difference(problem.step, k, end, others, difference[k], size[k]);
  }
  double differences = 0, sizes = 0;
  for (Index k = 0; k < n_links; ++k) {
    trial.energy.stored += gained[k].stored;
    trial.energy.dashpots += gained[k].dashpots;
    trial.energy.friction += gained[k].friction;
    trial.energy.regularisation += gained[k].regularisation;
    differences += difference[k];
    sizes += size[k];
  }
  trial.error = sizes > 0 ? std::abs(differences) / sizes : 0;
  const double norm = model.unit_load.norm();
  if (loaded_by_platen(assembly)) {
    trial.displacement =
        model.dofs.platen_dof >= 0 ? found.x[model.dofs.platen_dof] : problem.platen_moved;
    trial.load = found.platen_force;
    trial.energy.work = 0.5 * (state.path.back().force + trial.load) * trial.displacement;
  } else if (norm > 0) {
    trial.displacement = model.unit_load.dot(found.x) / norm;
    trial.energy.work = 0.5 * (state.path.back().force + trial.load) * norm * trial.displacement;
  }
  trial.energy.work += confinement.dot(found.x);
  for (std::size_t i = 0; i < problem.hold.size(); ++i)
    if (const Index dof = model.dofs.first_dof[i]; dof >= 0 && problem.hold[i] > 0)
      trial.energy.regularisation += problem.hold[i] * found.x.segment<6>(dof).squaredNorm();
  return trial;
}

double QuasistaticSolver::rate_now(const QuasistaticState& state, double fallback) const
{
  const QuasistaticModel& model = *model_;
  if (model.loading.control == Loading::Control::displacement)
    return load_rate(model.loading, state.time());
  const double force =
      state.path.back().force * (loaded_by_platen(model.assembly) ? 1 : model.unit_load.norm());
  double power = 0, scale = 0; // of the link forces on the inelastic motions
  for (std::size_t k = 0; k < state.links.link.size(); ++k) {
    const Link& link = state.links.link[k];
    if (!link.closed)
      continue;
    const std::array<double, 6> w = mode_multipliers(link, model.assembly);
    const CreepLaw& creep = model.assembly.laws[link.law].creep;
    for (int mode = 0; mode < 6; ++mode)
      if (w[mode] > 0) {
        const double* memory = state.links.memory_of(k) + mode * state.links.n_parts;
        power += memory[0] * inelastic_rate(creep, memory) / w[mode];
        scale += std::abs(memory[0] * inelastic_rate(creep, memory)) / w[mode];
      }
  }
  if (model.clock)
    power /= shift_factor(*model.clock, state.time());
  const bool alone = model.confinement.isZero(0);
  const bool loaded =
      (alone && std::abs(force) * std::abs(fallback) > 1e-3 * scale) || state.n_steps == 0;
  return force != 0 && loaded ? power / force : fallback;
}

double QuasistaticSolver::strength_factor_now(const QuasistaticState& state) const
{
  return strength_factor(model_->rate_law, averaged_strain_rate(state.path, model_->rate_law,
                                                                model_->assembly.gauge_length));
}

void QuasistaticSolver::take(QuasistaticState& state, Trial&& trial, bool is_jump)
{
  const QuasistaticModel& model = *model_;
  for (std::size_t i = 0; i < state.centre.size(); ++i) {
    state.centre[i] += trial.equilibrium.at.moved[i];
    state.rotation[i] += trial.equilibrium.at.turn[i];
  }
  state.links = std::move(trial.links);
  const PathPoint& last = state.path.back();
  PathPoint next = last;
  next.time += trial.duration;
  next.displacement += trial.displacement;
  next.smooth += is_jump ? 0 : trial.displacement;
  next.force = trial.load;
  next.n_broken = std::ssize(state.breakages);
  next.energy.work += trial.energy.work;
  next.energy.stored += trial.energy.stored;
  next.energy.dashpots += trial.energy.dashpots;
  next.energy.friction += trial.energy.friction;
  next.energy.regularisation += trial.energy.regularisation;
  if (is_jump && state.pass > 0) // neighbours take over: what no part keeps is radiated
    next.energy.breakage = next.energy.work - next.energy.stored - next.energy.dashpots -
                           next.energy.friction - next.energy.regularisation - last.energy.gap();
  state.path.push_back(next);
  if (trial.duration > 0)
    state.velocity = trial.equilibrium.x / trial.duration;
  const double fallback = trial.duration > 0 ? trial.displacement / trial.duration : last.rate;
  state.path.back().rate = rate_now(state, fallback);
  state.wear = finder_.factor().wear();
  if (model.settings.geometry == Geometry::finite &&
      contacts_outdated(state.links, state.centre, model.skin))
    state.links = find_contacts(std::move(state.links), model.assembly, model.bodies, state.centre,
                                model.skin);
  if (std::abs(state.path.back().displacement) >= model.strain_limit * model.assembly.gauge_length)
    state.end = RunEnd::strain_limit;
}

void QuasistaticSolver::break_bonds(QuasistaticState& state)
{
  const QuasistaticModel& model = *model_;
  const double factor = strength_factor_now(state);
  const std::vector<double> ratios = ratios_of(model, state.links);
  std::vector<Index> over;
  for (std::size_t b = 0; b < ratios.size(); ++b)
    if (ratios[b] > 0 && ratios[b] >= factor)
      over.push_back(Index(b));
  if (over.empty()) {
    state.settled = !state.in_avalanche; // after a loose equilibrium a tight one decides
    state.in_avalanche = false;
    state.pass = state.settled ? 0 : state.pass;
    return;
  }
  std::ranges::stable_sort(over, std::ranges::greater(), [&](Index b) { return ratios[b]; });
  const double tie =
      ratios[over.front()] * (1 - tie_over_tolerance * model.settings.residual_tolerance);
  const long batch = model.settings.breakage_batch;
  std::size_t n = std::min(over.size(), std::size_t(batch));
  while (n < over.size() && ratios[over[n]] >= tie)
    ++n;
  state.in_avalanche = n < over.size() || (batch > 1 && n > 1); // several bring on others
  std::sort(over.begin(), over.begin() + std::ptrdiff_t(n));
  const Strengths& strengths = *model.assembly.strengths;
  for (std::size_t each = 0; each < n; ++each) {
    const Index b = over[each];
    const auto [normal, shear, mode] = breaking_forces(state.links, std::size_t(b), strengths);
    state.breakages.push_back({state.time(), b, mode, normal, shear, factor,
                               state.path.back().displacement / model.assembly.gauge_length,
                               state.pass});
    const double before = stored_energy(state.links, b, model.assembly);
    break_link(state.links, b, mode, model.settings.after_breakage, model.initial_distance[b]);
    state.path.back().energy.breakage += before - stored_energy(state.links, b, model.assembly);
    state.path.back().energy.stored -= before - stored_energy(state.links, b, model.assembly);
  }
  ++state.pass;
  state.settled = false;
}

double QuasistaticSolver::largest_duration(const QuasistaticState& state) const
{
  const Loading& loading = model_->loading;
  return std::min(next_breakpoint(loading, state.time()), end_time(loading)) - state.time();
}

double QuasistaticSolver::first_duration(const QuasistaticState& state) const
{
  const double rate = std::abs(state.path.back().rate) / model_->assembly.gauge_length;
  const double longest = largest_duration(state);
  return rate > 0 ? std::min(0.02 * model_->settings.strain_per_step / rate, longest)
                  : 0.01 * longest;
}

void QuasistaticSolver::step_in_time(QuasistaticState& state)
{
  const QuasistaticModel& model = *model_;
  const QuasistaticSettings& settings = model.settings;
  const double longest = largest_duration(state), gauge = model.assembly.gauge_length;
  double duration = state.next_step > 0 ? state.next_step : first_duration(state);
  duration = duration > 0.99 * longest ? longest : duration;
  const std::vector<double> before = ratios_of(model, state.links);
  const double factor_before = strength_factor_now(state);
  BreakageSearch search{0, largest_ratio(before) / factor_before - 1};
  double growth = largest_growth;
  for (int attempts = 0;; ++attempts) {
    Trial trial = attempt(state, duration, 0, settings.residual_tolerance);
    if (!trial.equilibrium.found) {
      ++state.n_rejected;
      if (attempts > 12) {
        pass_through(state, duration, trial.equilibrium);
        return;
      }
      duration *= 0.25;
      continue;
    }
    const double strain = std::abs(trial.displacement) / gauge;
    const bool tried_enough = attempts > most_attempts;
    if (!tried_enough && strain > 1.3 * settings.strain_per_step) {
      ++state.n_rejected;
      duration *= std::max(0.1, 0.9 * settings.strain_per_step / strain);
      continue;
    }
    if (!tried_enough && trial.error > 2 * settings.error_tolerance) {
      ++state.n_rejected;
      duration *= std::max(0.2, 0.8 * std::sqrt(settings.error_tolerance / trial.error));
      continue;
    }
    QuasistaticState next = state;
    take(next, std::move(trial), false);
    const std::vector<double> after = ratios_of(model, next.links);
    const double factor = strength_factor_now(next);
    std::vector<double> crossing; // share of the step at which each bond reaches its strength
    for (std::size_t b = 0; b < after.size(); ++b)
      if (after[b] > 0 && after[b] >= factor) {
        const double from = before[b] / factor_before, to = after[b] / factor;
        crossing.push_back(to > from && from < 1 ? (1 - from) / (to - from) : 0);
      }
    const auto batch = std::size_t(settings.breakage_batch);
    const bool exact = batch == 1;
    const double overshoot = largest_ratio(after) / factor - 1;
    const bool too_many = exact ? overshoot > breakage_overshoot : crossing.size() > batch;
    const bool too_early = exact && overshoot < 0 && search.unsafe < infinity;
    if ((too_many || too_early) && !tried_enough && duration > 1e-9 * longest) {
      ++state.n_rejected;
      if (!exact) {
        std::ranges::nth_element(crossing, crossing.begin() + std::ptrdiff_t(batch / 2));
        duration *= std::clamp(crossing[batch / 2], 0.02, 0.9);
        continue;
      }
      if (search.narrow(duration, overshoot)) {
        duration = search.next();
        continue;
      }
    }
    if (crossing.size() * 2 > batch && !exact)
      growth = 1;
    const double by_strain = strain > 0 ? settings.strain_per_step / strain : infinity;
    const double by_error =
        trial.error > 0 ? 0.9 * std::sqrt(settings.error_tolerance / trial.error) : infinity;
    state = std::move(next);
    ++state.n_steps;
    state.passages_in_a_row = 0;
    state.passage_start.reset();
    state.passage_hold = 0;
    state.next_step = duration * std::clamp(std::min(by_strain, by_error), 0.3, growth);
    return break_or_go_on(state);
  }
}

void QuasistaticSolver::break_or_go_on(QuasistaticState& state)
{
  if (state.end != RunEnd::running)
    return;
  break_bonds(state);
  const double time = state.time();
  const Loading& loading = model_->loading;
  if (last_jump(loading, time) == time && time > loading.points.front().time)
    state.settled = false;
  if (state.settled && time >= end_time(loading))
    state.end = RunEnd::finished;
}

QuasistaticState QuasistaticSolver::step(QuasistaticState state)
{
  if (state.end != RunEnd::running)
    return state;
  if (!state.settled) {
    settle(state);
    if (state.end == RunEnd::running && state.settled && state.time() >= end_time(model_->loading))
      state.end = RunEnd::finished;
  } else
    step_in_time(state);
  return state;
}

Response QuasistaticSolver::response(const QuasistaticState& state, double time) const
{
  const double gauge = model_->assembly.gauge_length;
  const PathPoint now = point_at(state.path, time);
  const double rate = averaged_strain_rate(state.path, model_->rate_law, gauge, time);
  return {
      time, now.force,   now.displacement / gauge, rate, strength_factor(model_->rate_law, rate),
      0,    now.n_broken};
}

} // namespace dem
