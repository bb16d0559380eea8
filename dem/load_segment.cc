#include "dem/load_segment.h"

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

Range operator+(Range a, Range b)
{
  return {a.low + b.low, a.high + b.high};
}

Range between(double a, double b)
{
  return {std::min(a, b), std::max(a, b)};
}

double retardation_rate(const KelvinBranch& branch)
{
  return branch.stiffness / branch.viscosity;
}

CreepState<double> state_at(const ForceSegment& segment, const NetworkCreep& creep, double time)
{
  const double dt = time - segment.start;
  return creep_step(creep.law, segment.state, segment.compliance * segment.load_rate * dt, dt);
}

double inverse_viscosity(const CreepLaw& law)
{
  return law.maxwell_viscosity ? 1 / *law.maxwell_viscosity : 0.0;
}

/// z_k = sum_i a_ki f_i ties the Kelvin elongations to the relaxation modes.
double kelvin_elongation(const KelvinBranch& branch, std::span<const RelaxationMode> spectrum,
                         const RelaxationState& modes)
{
  const double rate = retardation_rate(branch);
  double sum = 0;
  for (std::size_t i = 0; i < spectrum.size(); ++i)
    sum += modes[i] / (branch.viscosity * (rate - spectrum[i].rate));
  return sum;
}

/// Integral of the elastic displacement since the start of the segment.
double integral_of_modes(const DisplacementSegment& segment, const NetworkCreep& creep, double time)
{
  const double dt = time - segment.start;
  double sum = 0;
  for (std::size_t i = 0; i < creep.spectrum.size(); ++i) {
    const auto [rate, stiffness] = creep.spectrum[i];
    sum += dt * phi1(rate * dt) * segment.modes[i] +
           dt * dt * phi2(rate * dt) * stiffness * segment.rate;
  }
  return sum;
}

// ---- force control --------------------------------------------------------------------------

double load_of(const ForceSegment& s, const NetworkCreep&, double time)
{
  return s.load + s.load_rate * (time - s.start);
}

Range load_range_of(const ForceSegment& s, const NetworkCreep& creep, double from, double to)
{
  return between(load_of(s, creep, from), load_of(s, creep, to));
}

double displacement_of(const ForceSegment& s, const NetworkCreep& creep, double time)
{
  return displacement(state_at(s, creep, time));
}

double rate_of(const ForceSegment& s, const NetworkCreep& creep, double time)
{
  return inelastic_rate(creep.law, state_at(s, creep, time)) + s.compliance * s.load_rate;
}

Range smooth_range_of(const ForceSegment& s, const NetworkCreep& creep, double from, double to)
{
  const CreepState<double> a = state_at(s, creep, from), b = state_at(s, creep, to);
  Range sum = between(a.elastic - s.jumps, b.elastic - s.jumps) + between(a.viscous, b.viscous);
  if (a.elastic * b.elastic < 0) { // the dashpot turns round in between
    const double turn = 0.5 * (to - from) * std::max(std::abs(a.elastic), std::abs(b.elastic)) *
                        inverse_viscosity(creep.law);
    sum = sum + Range{-turn, turn};
  }
  const double dt = to - from;
  for (std::size_t k = 0; k < a.kelvin.size(); ++k) {
    // A Kelvin elongation may pass an extremum: bound it by its rates at both ends.
    const KelvinBranch& branch = creep.law.branches[k];
    const double flow_a = a.elastic - branch.stiffness * a.kelvin[k];
    const double flow_b = b.elastic - branch.stiffness * b.kelvin[k];
    Range part = between(a.kelvin[k], b.kelvin[k]);
    if (flow_a * flow_b < 0) {
      const double turn = dt * std::max(std::abs(flow_a), std::abs(flow_b)) / branch.viscosity;
      part = part + Range{-turn, turn};
    }
    sum = sum + part;
  }
  return sum;
}

Range rate_range_of(const ForceSegment& s, const NetworkCreep& creep, double from, double to)
{
  const CreepState<double> a = state_at(s, creep, from), b = state_at(s, creep, to);
  const double fluidity = inverse_viscosity(creep.law), ramp = s.compliance * s.load_rate;
  Range sum = between(fluidity * a.elastic, fluidity * b.elastic) + Range{ramp, ramp};
  for (std::size_t k = 0; k < a.kelvin.size(); ++k) { // each rate relaxes monotonically
    const auto& [stiffness, viscosity] = creep.law.branches[k];
    sum = sum + between((a.elastic - stiffness * a.kelvin[k]) / viscosity,
                        (b.elastic - stiffness * b.kelvin[k]) / viscosity);
  }
  return sum;
}

LoadMemory memory_of(const ForceSegment& s, const NetworkCreep& creep, double time)
{
  const double dt = time - s.start;
  CreepState<double> at_rest = virgin_state(creep.law);
  at_rest.elastic = s.load;
  const CreepState<double> now = creep_step(creep.law, at_rest, s.load_rate * dt, dt);
  LoadMemory result{now.elastic, now.viscous, now.kelvin, {}};
  for (const KelvinBranch& branch : creep.law.branches)
    result.decay.push_back(std::exp(-dt * retardation_rate(branch)));
  return result;
}

// ---- displacement control ---------------------------------------------------------------------

double load_of(const DisplacementSegment& s, const NetworkCreep& creep, double time)
{
  const double dt = time - s.start;
  return force(relaxation_step(creep.spectrum, s.modes, s.rate * dt, dt));
}

Range load_range_of(const DisplacementSegment& s, const NetworkCreep& creep, double from, double to)
{
  const auto at = [&](double time) {
    const double dt = time - s.start;
    return relaxation_step(creep.spectrum, s.modes, s.rate * dt, dt);
  };
  const RelaxationState a = at(from), b = at(to);
  Range sum{0, 0};
  for (std::size_t i = 0; i < a.size(); ++i)
    sum = sum + between(a[i], b[i]);
  return sum;
}

double displacement_of(const DisplacementSegment& s, const NetworkCreep&, double time)
{
  return s.displacement + s.rate * (time - s.start);
}

double rate_of(const DisplacementSegment& s, const NetworkCreep&, double)
{
  return s.rate;
}

Range smooth_range_of(const DisplacementSegment& s, const NetworkCreep& creep, double from,
                      double to)
{
  return between(displacement_of(s, creep, from) - s.jumps,
                 displacement_of(s, creep, to) - s.jumps);
}

Range rate_range_of(const DisplacementSegment& s, const NetworkCreep&, double, double)
{
  return {s.rate, s.rate};
}

LoadMemory memory_of(const DisplacementSegment& s, const NetworkCreep& creep, double time)
{
  const double dt = time - s.start;
  const RelaxationState now = relaxation_step(creep.spectrum, s.modes, s.rate * dt, dt);
  LoadMemory result{force(now), 0, {}, {}};
  if (creep.law.maxwell_viscosity)
    result.viscous = integral_of_modes(s, creep, time) / *creep.law.maxwell_viscosity;
  for (const KelvinBranch& branch : creep.law.branches) {
    const double decay = std::exp(-dt * retardation_rate(branch));
    result.decay.push_back(decay);
    result.kelvin.push_back(kelvin_elongation(branch, creep.spectrum, now) -
                            decay * kelvin_elongation(branch, creep.spectrum, s.modes));
  }
  return result;
}

} // namespace

NetworkCreep network_creep(const CreepLaw& law)
{
  const CreepLaw unit = scaled(law, 1 / law.maxwell_stiffness);
  return {unit, relaxation_spectrum(unit)};
}

double load(const LoadSegment& segment, const NetworkCreep& creep, double time)
{
  return std::visit([&](const auto& s) { return load_of(s, creep, time); }, segment);
}

double displacement(const LoadSegment& segment, const NetworkCreep& creep, double time)
{
  return std::visit([&](const auto& s) { return displacement_of(s, creep, time); }, segment);
}

double smooth_displacement(const LoadSegment& segment, const NetworkCreep& creep, double time)
{
  return std::visit([&](const auto& s) { return displacement_of(s, creep, time) - s.jumps; },
                    segment);
}

double displacement_rate(const LoadSegment& segment, const NetworkCreep& creep, double time)
{
  return std::visit([&](const auto& s) { return rate_of(s, creep, time); }, segment);
}

Range load_range(const LoadSegment& segment, const NetworkCreep& creep, double from, double to)
{
  return std::visit([&](const auto& s) { return load_range_of(s, creep, from, to); }, segment);
}

Range smooth_displacement_range(const LoadSegment& segment, const NetworkCreep& creep, double from,
                                double to)
{
  return std::visit([&](const auto& s) { return smooth_range_of(s, creep, from, to); }, segment);
}

Range displacement_rate_range(const LoadSegment& segment, const NetworkCreep& creep, double from,
                              double to)
{
  return std::visit([&](const auto& s) { return rate_range_of(s, creep, from, to); }, segment);
}

LoadMemory memory(const LoadSegment& segment, const NetworkCreep& creep, double time)
{
  return std::visit([&](const auto& s) { return memory_of(s, creep, time); }, segment);
}

} // namespace dem
