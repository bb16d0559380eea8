#pragma once
#include "dem/creep_law.h"
#include "dem/phi_functions.h"

#include <cmath>
#include <span>
#include <vector>

namespace dem {

/// State of an element driven by force: elongations of its parts.
///
/// The force is carried as the elongation of the spring, f = K_m * elastic. Because all modes of
/// all bonds of a proportional network share one law, the same state describes one bond
/// (Displacement = double) and the displacements of a whole network (Displacement = vector), with
/// `elastic` the solution of the elastic network under the present load.
template <typename Displacement>
struct CreepState {
  Displacement elastic;             ///< of the spring [m]
  Displacement viscous;             ///< of the dashpot [m]
  std::vector<Displacement> kelvin; ///< of each Kelvin branch [m]
};

/// Scalar state at rest.
inline CreepState<double> virgin_state(const CreepLaw& law)
{
  return {0.0, 0.0, std::vector<double>(law.branches.size(), 0.0)};
}

/// Elongation of the element [m].
template <typename Displacement>
Displacement displacement(const CreepState<Displacement>& state)
{
  Displacement sum = state.elastic + state.viscous;
  for (const Displacement& part : state.kelvin)
    sum += part;
  return sum;
}

/// State after a time dt >= 0 during which the force changes linearly by K_m * elastic_increment.
///
/// Exact for any dt while the force is linear in time: constant force, ramps, and any
/// piecewise-linear history taken step by step.
template <typename Displacement>
CreepState<Displacement> creep_step(const CreepLaw& law, CreepState<Displacement> state,
                                    const Displacement& elastic_increment, double dt)
{
  const double stiffness = law.maxwell_stiffness;
  if (law.maxwell_viscosity)
    state.viscous +=
        (dt * stiffness / *law.maxwell_viscosity) * (state.elastic + 0.5 * elastic_increment);
  for (std::size_t k = 0; k < law.branches.size(); ++k) {
    const KelvinBranch& branch = law.branches[k];
    const double flow = dt / branch.viscosity, x = flow * branch.stiffness;
    state.kelvin[k] +=
        flow * (phi1(x) * (stiffness * state.elastic - branch.stiffness * state.kelvin[k]) +
                phi2(x) * stiffness * elastic_increment);
  }
  state.elastic += elastic_increment;
  return state;
}

/// Rate of the elongation without its elastic part [m/s]: dashpot and Kelvin branches.
inline double inelastic_rate(const CreepLaw& law, const CreepState<double>& state)
{
  const double force = law.maxwell_stiffness * state.elastic;
  double rate = law.maxwell_viscosity ? force / *law.maxwell_viscosity : 0.0;
  for (std::size_t k = 0; k < law.branches.size(); ++k)
    rate += (force - law.branches[k].stiffness * state.kelvin[k]) / law.branches[k].viscosity;
  return rate;
}

/// Recoverable energy of one element [J].
inline double free_energy(const CreepLaw& law, const CreepState<double>& state)
{
  double energy = 0.5 * law.maxwell_stiffness * state.elastic * state.elastic;
  for (std::size_t k = 0; k < law.branches.size(); ++k)
    energy += 0.5 * law.branches[k].stiffness * state.kelvin[k] * state.kelvin[k];
  return energy;
}

/// State of an element driven by displacement: the force of each relaxation mode [N].
using RelaxationState = std::vector<double>;

/// Force of the element [N].
inline double force(const RelaxationState& state)
{
  double sum = 0;
  for (const double part : state)
    sum += part;
  return sum;
}

/// State after a time dt >= 0 during which the displacement changes linearly by `increment` [m].
///
/// Exact for any dt for relaxation and for ramps; of second order in dt for other histories.
/// Does not oscillate and damps fast modes fully for dt far above their relaxation times.
inline RelaxationState relaxation_step(std::span<const RelaxationMode> spectrum,
                                       RelaxationState state, double increment, double dt)
{
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const auto [rate, stiffness] = spectrum[i];
    state[i] = std::exp(-rate * dt) * state[i] + stiffness * phi1(rate * dt) * increment;
  }
  return state;
}

/// Force per displacement over one step of `creep_step` [N/m]: between K_m and 0.
inline double force_linear_stiffness(const CreepLaw& law, double dt)
{
  double compliance = 1 / law.maxwell_stiffness;
  if (law.maxwell_viscosity)
    compliance += dt / (2 * *law.maxwell_viscosity);
  for (const KelvinBranch& branch : law.branches)
    compliance += dt / branch.viscosity * phi2(dt / branch.viscosity * branch.stiffness);
  return 1 / compliance;
}

/// Force per displacement over one step of `relaxation_step` [N/m]: between K_m and 0.
inline double displacement_linear_stiffness(std::span<const RelaxationMode> spectrum, double dt)
{
  double sum = 0;
  for (const auto& [rate, stiffness] : spectrum)
    sum += stiffness * phi1(rate * dt);
  return sum;
}

} // namespace dem
