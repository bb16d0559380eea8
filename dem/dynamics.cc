#include "dem/dynamics.h"

#include "dem/thread_team.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <optional>
#include <stdexcept>

namespace dem {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Gap up to which unbonded pairs are listed, over the smallest radius.
constexpr double relative_skin = 0.1;
/// Share of each servo correction that stays as velocity of the platen.
constexpr double servo_memory = 0.01;

ContactSurroundings surroundings(const DynamicModel& model, const DynamicState& state)
{
  return {state.motions,
          model.radius,
          model.support,
          model.material_class,
          loaded_by_platen(model.assembly),
          model.platens.low - 0.5 * state.displacement,
          model.platens.high + 0.5 * state.displacement};
}

std::vector<std::array<Index, 2>> bonded_slots(const DynamicModel& model)
{
  std::vector<std::array<Index, 2>> pairs;
  for (const auto& [i, j] : model.assembly.bonds.ends)
    pairs.push_back(std::minmax({model.slot[i], model.slot[j]}).first == model.slot[i]
                        ? std::array{model.slot[i], model.slot[j]}
                        : std::array{model.slot[j], model.slot[i]});
  std::ranges::sort(pairs);
  return pairs;
}

double simulated_time(const DynamicModel& model, long n_steps)
{
  return double(n_steps) * model.time_step;
}

double real_time_at(const DynamicModel& model, long n_steps)
{
  return simulated_time(model, n_steps) / model.settings.viscosity_scaling;
}

/// Prescribed value with its jumps spread over the ramp time.
double smoothed_load(const DynamicModel& model, long n_steps)
{
  const double time = real_time_at(model, n_steps);
  const double ramp = model.ramp_time / model.settings.viscosity_scaling;
  return ramp > 0 ? mean_load(model.loading, time, ramp) : load_value(model.loading, time);
}

/// Velocity of the upper platen relative to the lower over the next step [m/s]. Under force control
/// a proportional and an integral part, so that no error of force is left at constant velocity.
double platen_velocity(const DynamicModel& model, DynamicState& state)
{
  if (!loaded_by_platen(model.assembly))
    return 0;
  const double target = smoothed_load(model, state.n_steps + 1);
  if (model.loading.control == Loading::Control::displacement)
    return (target - state.displacement) / model.time_step;
  double prescribed = target;
  if (model.loading.true_stress)
    prescribed /= 1 + state.displacement / model.assembly.gauge_length;
  const double force = 0.5 * (state.force_on_upper + state.force_on_lower);
  const double correction =
      model.settings.servo_gain * (prescribed - force) / (model.platen_stiffness * model.time_step);
  state.servo_velocity += servo_memory * correction;
  return correction + state.servo_velocity;
}

/// Moves one free particle: local damping takes a share of each component of the force that drives
/// its motion and adds it where it brakes.
void move_particle(const DynamicModel& model, DynamicState& state, Index s, double load)
{
  const double dt = model.time_step, damping = model.settings.damping;
  double* velocity = state.velocity.data() + std::size_t(s) * 6;
  double* motion = state.motions.data() + std::size_t(s) * motion_stride;
  const double* force = state.forces.data() + std::size_t(s) * force_stride;
  for (int k = 0; k < 6; ++k) {
    const double applied = k < 3 ? model.force[s][k] : model.moment[s][k - 3];
    const double total = force[k] + load * applied;
    const double damped = total - damping * std::copysign(std::abs(total), velocity[k]);
    velocity[k] += dt * (k < 3 ? model.inverse_mass[s] : model.inverse_inertia[s]) *
                   (velocity[k] == 0 ? total : damped);
  }
  for (int k = 0; k < 3; ++k) {
    motion[k] += dt * velocity[k];
    state.rotation[s][k] += dt * velocity[3 + k];
  }
  const double squared =
      velocity[3] * velocity[3] + velocity[4] * velocity[4] + velocity[5] * velocity[5];
  const double half = 0.5 * dt * (1 + dt * dt * squared / 12); // tangent of half the angle
  for (int k = 0; k < 3; ++k)
    motion[3 + k] = half * velocity[3 + k];
}

/// Averaged real strain rate [1/s], or nothing while it is not defined yet.
std::optional<double> measured_strain_rate(const DynamicModel& model, const DynamicState& state)
{
  const double x = model.settings.viscosity_scaling, now = real_time_at(model, state.n_steps);
  const double ramp = model.ramp_time / x,
               smallest = model.settings.smallest_window * model.axial_period / x;
  const double begin = std::max(0.0, last_jump(model.loading, now) + ramp);
  const double window = std::max({model.rate_law.window, model.rate_law.window_fraction * now,
                                  smallest, 2 * steps_per_sample * model.time_step / x});
  const double from = std::max(begin, now - window);
  if (now - begin < smallest || !(now > from))
    return std::nullopt;
  const double per_sample = steps_per_sample * model.time_step / x;
  const auto sample = std::size_t(std::ceil(from / per_sample - 1e-9));
  if (sample >= state.samples.size())
    return std::nullopt;
  return (state.displacement - state.samples[sample]) / (now - double(sample) * per_sample) /
         model.assembly.gauge_length;
}

/// Strength factor from here on: that of the averaged rate; before the first average after a jump,
/// the one before, and no breakage under the first load.
void sample(const DynamicModel& model, DynamicState& state)
{
  state.samples.push_back(state.displacement);
  if (const auto rate = measured_strain_rate(model, state))
    state.strength_factor = strength_factor(model.rate_law, *rate);
  else if (model.rate_law.exponent == 0)
    state.strength_factor = 1;
}

void check_stability(const DynamicModel& model, const DynamicState& state)
{
  for (std::size_t s = 0; s < model.radius.size(); ++s) {
    bool steady = true; // false for NaN
    for (int k = 0; k < 6; ++k) {
      const double speed = std::abs(state.velocity[6 * s + k]) * (k < 3 ? 1 : model.radius[s]);
      steady = steady && speed * model.time_step < 0.1 * model.radius[s];
    }
    if (steady)
      continue;
    throw std::runtime_error(fmt::format(
        "the explicit solver is unstable: particle {} moves more than a tenth of its radius in one "
        "step at {:g} s; reduce the step safety (now {:g})",
        model.particle[s], real_time_at(model, state.n_steps), model.settings.step_safety));
  }
}

void break_bonds(const DynamicModel& model, DynamicState& state, std::vector<Index>& broken)
{
  std::ranges::sort(broken, {}, [&](Index lane) { return state.bonds.bond[lane]; });
  for (const Index lane : broken) {
    const DynamicBond bond = dynamic_bond(state.bonds, lane);
    const Eigen::Matrix<double, 6, 1> total = bond.modes.rowwise().sum();
    const double shear = std::hypot(total[1], total[2]);
    const BreakMode mode = total[0] * bond.shear_strength >= shear * bond.normal_strength
                               ? BreakMode::tension
                               : BreakMode::shear;
    state.breakages.push_back({real_time(model, state), bond.bond, mode, total[0], shear,
                               state.strength_factor,
                               state.displacement / model.assembly.gauge_length, 0});
    if (model.settings.after_breakage != AfterBreakage::leave)
      state.contacts.contacts.push_back(
          contact_after(bond, mode, state.initial_distance[bond.bond]));
    remove_bond(state.bonds, lane);
  }
  std::ranges::stable_sort(state.contacts.contacts, [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  broken.clear();
}

/// Everything a step needs besides the state.
struct Scratch {
  AlignedDoubles partial;                 ///< of the chunks
  AlignedDoubles on_contacts;             ///< forces of unbonded contacts, by slot
  std::vector<std::size_t> first, window; ///< partial sums of each slot (compressed rows)
  std::vector<Index> held;                ///< slots glued to a platen
  std::vector<std::vector<Index>> broken; ///< per thread
  double contact_upper = 0, contact_lower = 0;
};

Scratch make_scratch(const DynamicModel& model, const DynamicState& state, int n_threads)
{
  Scratch scratch;
  const std::size_t n = model.radius.size();
  scratch.partial.assign(state.bonds.n_partial_forces * force_stride, 0.0);
  scratch.on_contacts.assign(n * force_stride, 0.0);
  scratch.first.push_back(0);
  for (std::size_t s = 0; s < n; ++s) {
    for (const BondChunk& chunk : state.bonds.chunks)
      if (Index(s) >= chunk.first_particle && Index(s) < chunk.last_particle)
        scratch.window.push_back(chunk.window + s - chunk.first_particle);
    scratch.first.push_back(scratch.window.size());
    if (model.support[s] != Support::free)
      scratch.held.push_back(Index(s));
  }
  scratch.broken.resize(n_threads);
  return scratch;
}

/// Adds up the forces on one particle in fixed order.
void gather(const Scratch& scratch, DynamicState& state, Index s)
{
  double* force = state.forces.data() + std::size_t(s) * force_stride;
  const double* contact = scratch.on_contacts.data() + std::size_t(s) * force_stride;
  for (int k = 0; k < force_stride; ++k)
    force[k] = contact[k];
  for (std::size_t w = scratch.first[s]; w < scratch.first[s + 1]; ++w) {
    const double* part = scratch.partial.data() + scratch.window[w] * force_stride;
    for (int k = 0; k < force_stride; ++k)
      force[k] += part[k];
  }
}

struct PlatenForces {
  double upper, lower;
};

/// Force that the platens exert on the specimen along z, tension positive.
PlatenForces platen_forces(const DynamicModel& model, const DynamicState& state,
                           const Scratch& scratch)
{
  PlatenForces sum{-scratch.contact_upper, scratch.contact_lower};
  for (const Index s : scratch.held) {
    const double z = state.forces[std::size_t(s) * force_stride + 2];
    (model.support[s] == Support::top ? sum.upper : sum.lower) +=
        model.support[s] == Support::top ? -z : z;
  }
  return sum;
}

void move_held(const DynamicModel& model, DynamicState& state, const Scratch& scratch,
               double velocity)
{
  for (const Index s : scratch.held) {
    const double own = model.support[s] == Support::top ? 0.5 * velocity : -0.5 * velocity;
    state.velocity[6 * std::size_t(s) + 2] = own;
    state.motions[std::size_t(s) * motion_stride + 2] += model.time_step * own;
  }
}

/// What one thread does before each step.
void move_platens(const DynamicModel& model, DynamicState& state, const Scratch& scratch)
{
  const double velocity = platen_velocity(model, state);
  move_held(model, state, scratch, velocity);
  state.displacement += model.time_step * velocity;
  ++state.n_steps;
}

void sum_contacts(const DynamicModel& model, DynamicState& state, Scratch& scratch)
{
  const double friction =
      model.settings.after_breakage == AfterBreakage::friction ? model.settings.friction : 0;
  std::ranges::fill(scratch.on_contacts, 0.0);
  scratch.contact_upper = scratch.contact_lower = 0;
  advance_contacts(state.contacts, surroundings(model, state), model.assembly.laws, model.factors,
                   friction, scratch.on_contacts.data(), scratch.contact_upper,
                   scratch.contact_lower);
}

/// Mean displacement of the loads on particles, conjugate to their work as in the other solvers
/// [m].
double displacement_of_loads(const DynamicModel& model, const DynamicState& state)
{
  double work = 0, squares = 0;
  for (const Index s : model.loaded) {
    const Vec3 now = Eigen::Map<const Vec3>(state.motions.data() + std::size_t(s) * motion_stride);
    work += model.force[s].dot(now - model.assembly.particles.centre[model.particle[s]]) +
            model.moment[s].dot(state.rotation[s]);
    squares += model.force[s].squaredNorm() + (model.moment[s] / model.radius[s]).squaredNorm();
  }
  return squares > 0 ? work / std::sqrt(squares) : 0;
}

/// What one thread does after each step.
void keep_books(const DynamicModel& model, DynamicState& state, Scratch& scratch)
{
  const PlatenForces on_platens = platen_forces(model, state, scratch);
  state.force_on_upper = on_platens.upper;
  state.force_on_lower = on_platens.lower;
  if (!loaded_by_platen(model.assembly))
    state.displacement = displacement_of_loads(model, state);
  std::vector<Index> broken;
  for (std::vector<Index>& part : scratch.broken) {
    broken.insert(broken.end(), part.begin(), part.end());
    part.clear();
  }
  if (!broken.empty())
    break_bonds(model, state, broken);
  if (state.n_steps % steps_per_sample != 0)
    return;
  sample(model, state);
  check_stability(model, state);
  const ContactSurroundings around = surroundings(model, state);
  if (is_outdated(state.contacts, around))
    state.contacts = find_contacts(std::move(state.contacts), around, bonded_slots(model),
                                   model.assembly.pair_laws, model.n_modes);
  const double strain = state.displacement / model.assembly.gauge_length;
  if (std::abs(strain) >= model.strain_limit)
    state.end = RunEnd::strain_limit;
  else if (real_time(model, state) >= end_time(model.loading))
    state.end = RunEnd::finished;
}

} // namespace

DynamicState start(const DynamicModel& model)
{
  DynamicState state;
  const std::size_t n = model.radius.size();
  state.motions.assign(n * motion_stride, 0.0);
  for (std::size_t s = 0; s < n; ++s)
    for (int k = 0; k < 3; ++k)
      state.motions[s * motion_stride + k] = model.assembly.particles.centre[model.particle[s]][k];
  state.velocity.assign(6 * n, 0.0);
  state.rotation.assign(n, Vec3::Zero());
  state.forces.assign(n * force_stride, 0.0);
  state.bonds = make_dynamic_bonds(model.assembly, model.slot, model.n_modes);
  for (const auto& [i, j] : model.assembly.bonds.ends)
    state.initial_distance.push_back(
        (model.assembly.particles.centre[i] - model.assembly.particles.centre[j]).norm());
  if (n > 0)
    state.contacts.skin = relative_skin * std::ranges::min(model.radius);
  state.contacts = find_contacts(std::move(state.contacts), surroundings(model, state),
                                 bonded_slots(model), model.assembly.pair_laws, model.n_modes);
  sample(model, state);
  if (end_time(model.loading) <= 0)
    state.end = RunEnd::finished;
  return state;
}

double real_time(const DynamicModel& model, const DynamicState& state)
{
  return real_time_at(model, state.n_steps);
}

DynamicState advance(const DynamicModel& model, DynamicState state, long n_steps, int n_threads)
{
  const auto n = Index(model.radius.size());
  const auto n_chunks = Index(state.bonds.chunks.size());
  Scratch scratch = make_scratch(model, state, n_threads);
  std::exception_ptr failure;
  bool go_on = true;
  std::atomic<Index> next_chunk{0};
  MeetingPoint meeting(n_threads);
  run_on_threads(n_threads, [&](int thread) {
    const auto [begin, end] = share_of(n, thread, n_threads);
    for (long k = 0;; ++k) {
      if (thread == 0) {
        go_on = k < n_steps && state.end == RunEnd::running && !failure;
        next_chunk = -1; // stands for the contacts
        if (go_on)
          move_platens(model, state, scratch);
      }
      meeting.wait();
      if (!go_on)
        return;
      const double load =
          loaded_by_platen(model.assembly) ? 0.0 : smoothed_load(model, state.n_steps - 1);
      for (Index s = begin; s < end; ++s)
        if (model.support[s] == Support::free)
          move_particle(model, state, s, load);
      meeting.wait();
      for (Index c; (c = next_chunk++) < n_chunks;)
        if (c < 0)
          sum_contacts(model, state, scratch);
        else
          advance_chunk(state.bonds, state.bonds.chunks[c], state.motions.data(), model.factors,
                        state.strength_factor, scratch.partial.data(), scratch.broken[thread]);
      meeting.wait();
      for (Index s = begin; s < end; ++s)
        gather(scratch, state, s);
      meeting.wait();
      if (thread == 0)
        try {
          keep_books(model, state, scratch);
        } catch (...) {
          failure = std::current_exception();
        }
    }
  });
  if (failure)
    std::rethrow_exception(failure);
  return state;
}

Response response(const DynamicModel& model, const DynamicState& state)
{
  const double force = loaded_by_platen(model.assembly)
                           ? 0.5 * (state.force_on_upper + state.force_on_lower)
                           : smoothed_load(model, state.n_steps);
  return {real_time(model, state),
          force,
          state.displacement / model.assembly.gauge_length,
          measured_strain_rate(model, state).value_or(0),
          state.strength_factor,
          0,
          std::ssize(state.breakages)};
}

Motion motion(const DynamicModel& model, const DynamicState& state, Index particle)
{
  const Index s = model.slot[particle];
  const Vec3 now = Eigen::Map<const Vec3>(state.motions.data() + std::size_t(s) * motion_stride);
  return {now - model.assembly.particles.centre[particle], state.rotation[s]};
}

} // namespace dem
