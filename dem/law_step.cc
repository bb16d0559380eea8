#include "dem/law_step.h"

#include "dem/phi_functions.h"

#include <Eigen/LU>

#include <cmath>

namespace dem {

namespace {

LawStep blank(StepScheme scheme, double duration, int n_parts)
{
  return {scheme, duration, Eigen::MatrixXd::Zero(n_parts, n_parts),
          Eigen::VectorXd::Zero(n_parts)};
}

/// Force linear in time: du = C df + d, with d what the present memory gives by itself.
LawStep force_linear_step(const CreepLaw& law, double h, int n_parts)
{
  LawStep step = blank(StepScheme::force_linear, h, n_parts);
  const auto n = Eigen::Index(law.branches.size());
  double compliance = 1 / law.maxwell_stiffness;
  Eigen::RowVectorXd drift = Eigen::RowVectorXd::Zero(n_parts); // d = drift x
  if (law.maxwell_viscosity) {
    compliance += h / (2 * *law.maxwell_viscosity);
    drift[0] += h / *law.maxwell_viscosity;
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto [stiffness, viscosity] = law.branches[j];
    const double flow = h / viscosity, x = flow * stiffness;
    compliance += flow * phi2(x);
    drift[0] += flow * phi1(x);
    drift[1 + j] = -flow * phi1(x) * stiffness;
  }
  step.gain[0] = 1 / compliance;
  const Eigen::RowVectorXd force_change = -drift / compliance; // for du = 0
  step.carry.row(0) = force_change;
  step.carry(0, 0) += 1;
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto [stiffness, viscosity] = law.branches[j];
    const double flow = h / viscosity, x = flow * stiffness;
    step.carry.row(1 + j) = flow * phi2(x) * force_change;
    step.carry(1 + j, 0) += flow * phi1(x);
    step.carry(1 + j, 1 + j) += std::exp(-x);
    step.gain[1 + j] = flow * phi2(x) / compliance;
  }
  return step;
}

/// Memory of the law in terms of the forces of its relaxation modes: x = T m.
Eigen::MatrixXd memory_of_modes(const CreepLaw& law, std::span<const RelaxationMode> modes)
{
  const auto n = Eigen::Index(modes.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(n, n);
  for (Eigen::Index j = 1; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i)
      matrix(j, i) =
          1 / (law.branches[j - 1].stiffness - law.branches[j - 1].viscosity * modes[i].rate);
  return matrix;
}

/// Displacement linear in time: each relaxation mode by itself.
LawStep displacement_linear_step(const CreepLaw& law, double h, int n_parts)
{
  LawStep step = blank(StepScheme::displacement_linear, h, n_parts);
  std::vector<RelaxationMode> modes = relaxation_spectrum(law);
  const bool has_elastic_part_only = law.branches.empty() && !law.maxwell_viscosity;
  if (has_elastic_part_only)
    modes.assign(1, {0.0, law.maxwell_stiffness});
  const auto n = Eigen::Index(law.branches.size()) + 1;
  Eigen::VectorXd decay(n), gain(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    decay[i] = std::exp(-modes[i].rate * h);
    gain[i] = modes[i].stiffness * phi1(modes[i].rate * h);
  }
  const Eigen::MatrixXd to_memory = memory_of_modes(law, modes);
  const Eigen::MatrixXd from_memory = to_memory.inverse();
  step.carry.topLeftCorner(n, n) = to_memory * decay.asDiagonal() * from_memory;
  step.gain.head(n) = to_memory * gain;
  return step;
}

/// Dissipation of one Kelvin dashpot under a force linear in time: its rate of elongation is
/// (a + b exp(-s / tau)) / C.
double kelvin_dissipation(const KelvinBranch& branch, double h, double force, double force_change,
                          double elongation)
{
  const double x = h / branch.viscosity * branch.stiffness;
  const double push = force - branch.stiffness * elongation;
  if (x < 0.05) { // four Gauss points: the closed form cancels
    constexpr double point[] = {0.0694318442029737, 0.3300094782075719, 0.6699905217924281,
                                0.9305681557970263};
    constexpr double weight[] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731,
                                 0.1739274225687269};
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const double s = point[k] * x;
      const double g = push * std::exp(-s) + force_change * point[k] * phi1(s);
      sum += weight[k] * g * g;
    }
    return sum * h / branch.viscosity;
  }
  const double a = force_change / x, b = push - a;
  return h / branch.viscosity * (a * a + 2 * a * b * phi1(x) + b * b * phi1(2 * x));
}

} // namespace

LawStep law_step(const CreepLaw& law, StepScheme scheme, double duration, int n_parts)
{
  if (scheme == StepScheme::force_linear || duration == 0) {
    LawStep step = force_linear_step(law, duration, n_parts);
    step.scheme = scheme;
    return step;
  }
  return displacement_linear_step(law, duration, n_parts);
}

double stored_energy(const CreepLaw& law, const double* memory, double multiplier)
{
  if (multiplier == 0)
    return 0;
  double energy = memory[0] * memory[0] / law.maxwell_stiffness;
  for (std::size_t k = 0; k < law.branches.size(); ++k)
    energy += law.branches[k].stiffness * memory[1 + k] * memory[1 + k];
  return 0.5 * energy / multiplier;
}

namespace {

/// Whether a duration is so short that forces are linear in it under either scheme, and what the
/// dashpots move is lost in rounding.
bool is_moment(const CreepLaw& law, double duration)
{
  constexpr double share = 1e-4; // of the time in which something happens
  double rate = law.maxwell_viscosity ? law.maxwell_stiffness / *law.maxwell_viscosity : 0.0;
  for (const KelvinBranch& branch : law.branches)
    rate += (law.maxwell_stiffness + branch.stiffness) / branch.viscosity;
  return duration * rate < share;
}

} // namespace

double dissipated_energy(const CreepLaw& law, const LawStep& step, const double* before,
                         const double* after, double increment, double multiplier)
{
  const double h = step.duration;
  if (h == 0 || multiplier == 0)
    return 0;
  if (step.scheme == StepScheme::displacement_linear &&
      !is_moment(law, h)) { // work less what is stored
    double impulse = 0;     // mean force times h, from the balance of the dashpots' elongations
    double elongation = increment * multiplier - (after[0] - before[0]) / law.maxwell_stiffness;
    for (std::size_t k = 0; k < law.branches.size(); ++k)
      elongation -= after[1 + k] - before[1 + k];
    if (law.maxwell_viscosity)
      impulse = elongation * *law.maxwell_viscosity;
    else if (!law.branches.empty())
      impulse = 0.5 * h * (before[0] + after[0]);
    return impulse / h * increment -
           (stored_energy(law, after, multiplier) - stored_energy(law, before, multiplier));
  }
  const double force = before[0], change = after[0] - before[0];
  double sum = 0;
  if (law.maxwell_viscosity)
    sum += h / *law.maxwell_viscosity * (force * force + force * change + change * change / 3);
  for (std::size_t k = 0; k < law.branches.size(); ++k)
    sum += kelvin_dissipation(law.branches[k], h, force, change, before[1 + k]);
  return sum / multiplier;
}

double inelastic_rate(const CreepLaw& law, const double* memory)
{
  double rate = law.maxwell_viscosity ? memory[0] / *law.maxwell_viscosity : 0.0;
  for (std::size_t k = 0; k < law.branches.size(); ++k)
    rate += (memory[0] - law.branches[k].stiffness * memory[1 + k]) / law.branches[k].viscosity;
  return rate;
}

} // namespace dem
