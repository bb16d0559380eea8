#include "dem/creep_law.h"

#include "dem/phi_functions.h"

#include <boost/math/tools/roots.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require(bool condition, const char* what, double found)
{
  if (!condition)
    throw std::invalid_argument(fmt::format("creep law: {}, found {:g}", what, found));
}

double retardation_rate(const KelvinBranch& branch)
{
  return branch.stiffness / branch.viscosity;
}

/// Pole of the secular function: 1/K_m + sum_j fluidity_j / (rate_j - r).
struct Pole {
  double rate;     ///< [1/s]
  double fluidity; ///< 1/C [m/(N s)]
};

std::vector<Pole> poles(const CreepLaw& law)
{
  std::vector<Pole> result;
  if (law.maxwell_viscosity)
    result.push_back({0.0, 1 / *law.maxwell_viscosity});
  for (const KelvinBranch& branch : law.branches)
    result.push_back({retardation_rate(branch), 1 / branch.viscosity});
  std::ranges::sort(result, {}, &Pole::rate);
  return result;
}

/// Distance of the root from pole `origin`, towards `side` (+1 or -1), at most `reach` away.
/// The secular function is multiplied by the distance, which removes the pole.
double root_distance(const CreepLaw& law, std::span<const Pole> pole, std::size_t origin, int side,
                     double reach)
{
  const auto function = [&](double distance) {
    double rest = 1 / law.maxwell_stiffness;
    for (std::size_t j = 0; j < pole.size(); ++j)
      if (j != origin)
        rest += pole[j].fluidity / (pole[j].rate - pole[origin].rate - side * distance);
    return rest * distance - side * pole[origin].fluidity;
  };
  const double at_reach = function(reach);
  if (at_reach == 0)
    return reach;
  const auto beyond_root = [&](double value) { return (value > 0) == (at_reach > 0); };
  double low = reach, high = reach;
  do {
    high = low;
    low *= 1e-3;
  } while (beyond_root(function(low)) && low > std::numeric_limits<double>::min());
  const double at_low = function(low), at_high = function(high);
  if (at_low == 0 || beyond_root(at_low))
    return low;
  std::uintmax_t iterations = 200;
  const auto [a, b] =
      boost::math::tools::toms748_solve(function, low, high, at_low, at_high,
                                        boost::math::tools::eps_tolerance<double>(53), iterations);
  return 0.5 * (a + b);
}

/// Mode at a distance from a pole; the weight is a sum of positive terms.
RelaxationMode mode_at(std::span<const Pole> pole, std::size_t origin, int side, double distance)
{
  const double rate = pole[origin].rate + side * distance;
  double slope = 0;
  for (std::size_t j = 0; j < pole.size(); ++j) {
    const double gap =
        j == origin ? -side * distance : pole[j].rate - pole[origin].rate - side * distance;
    slope += pole[j].fluidity / gap / gap;
  }
  return {rate, 1 / (rate * slope)};
}

} // namespace

double retardation_time(const KelvinBranch& branch)
{
  return branch.stiffness > 0 ? branch.viscosity / branch.stiffness : infinity;
}

CreepLaw make_creep_law(double maxwell_stiffness, std::optional<double> maxwell_viscosity,
                        std::span<const KelvinBranch> branches)
{
  require(maxwell_stiffness > 0 && maxwell_stiffness < infinity,
          "the Maxwell stiffness must be a finite number > 0", maxwell_stiffness);
  double compliance = 1 / maxwell_stiffness, fluidity = 0;
  if (maxwell_viscosity) {
    require(*maxwell_viscosity > 0, "the Maxwell viscosity must be > 0 (or absent)",
            *maxwell_viscosity);
    fluidity = 1 / *maxwell_viscosity;
  }
  CreepLaw law;
  for (const KelvinBranch& branch : branches) {
    require(branch.stiffness >= 0, "a Kelvin stiffness must be >= 0", branch.stiffness);
    require(branch.viscosity >= 0, "a Kelvin viscosity must be >= 0", branch.viscosity);
    require(branch.stiffness > 0 || branch.viscosity > 0,
            "a Kelvin branch needs a stiffness or a viscosity > 0", branch.stiffness);
    if (branch.stiffness == infinity || branch.viscosity == infinity)
      continue;
    if (branch.viscosity == 0)
      compliance += 1 / branch.stiffness;
    else if (branch.stiffness == 0)
      fluidity += 1 / branch.viscosity;
    else
      law.branches.push_back(branch);
  }
  law.maxwell_stiffness = 1 / compliance;
  if (compliance == 1 / maxwell_stiffness)
    law.maxwell_stiffness = maxwell_stiffness;
  if (fluidity > 0)
    law.maxwell_viscosity =
        maxwell_viscosity && fluidity == 1 / *maxwell_viscosity ? *maxwell_viscosity : 1 / fluidity;
  std::ranges::stable_sort(law.branches, {}, retardation_time);
  std::vector<KelvinBranch> merged;
  for (const KelvinBranch& branch : law.branches) {
    if (!merged.empty() && retardation_rate(merged.back()) == retardation_rate(branch)) {
      const double factor = 1 / (1 + merged.back().stiffness / branch.stiffness);
      merged.back() = {merged.back().stiffness * factor, merged.back().viscosity * factor};
    } else
      merged.push_back(branch);
  }
  law.branches = std::move(merged);
  return law;
}

CreepLaw burgers(double maxwell_stiffness, double maxwell_viscosity, double kelvin_stiffness,
                 double kelvin_viscosity)
{
  const KelvinBranch branch{kelvin_stiffness, kelvin_viscosity};
  return make_creep_law(maxwell_stiffness, maxwell_viscosity, {&branch, 1});
}

double creep_compliance(const CreepLaw& law, double t)
{
  double sum = 1 / law.maxwell_stiffness;
  if (law.maxwell_viscosity)
    sum += t / *law.maxwell_viscosity;
  for (const KelvinBranch& branch : law.branches)
    sum += t / branch.viscosity * phi1(t * retardation_rate(branch));
  return sum;
}

double creep_compliance_rate(const CreepLaw& law, double t)
{
  double sum = law.maxwell_viscosity ? 1 / *law.maxwell_viscosity : 0.0;
  for (const KelvinBranch& branch : law.branches)
    sum += std::exp(-t * retardation_rate(branch)) / branch.viscosity;
  return sum;
}

double mean_creep_compliance(const CreepLaw& law, double begin, double length)
{
  double sum = 1 / law.maxwell_stiffness;
  if (law.maxwell_viscosity)
    sum += (begin + length / 2) / *law.maxwell_viscosity;
  for (const KelvinBranch& branch : law.branches) {
    const double x = begin * retardation_rate(branch), y = length * retardation_rate(branch);
    sum += (begin * phi1(x) + std::exp(-x) * length * phi2(y)) / branch.viscosity;
  }
  return sum;
}

double creep_compliance_integral(const CreepLaw& law, double t)
{
  return t * mean_creep_compliance(law, 0, t);
}

std::complex<double> complex_compliance(const CreepLaw& law, double omega)
{
  double storage = 1 / law.maxwell_stiffness;
  double loss = law.maxwell_viscosity ? 1 / (omega * *law.maxwell_viscosity) : 0.0;
  for (const auto& [stiffness, viscosity] : law.branches) {
    const double tangent = omega * viscosity / stiffness,
                 part = 1 / stiffness / (1 + tangent * tangent);
    storage += part;
    loss += part * tangent;
  }
  return {storage, -loss};
}

std::vector<RelaxationMode> relaxation_spectrum(const CreepLaw& law)
{
  constexpr double margin = 1 + 1e-9; // roots at the end of their interval stay inside
  const std::vector<Pole> pole = poles(law);
  std::vector<RelaxationMode> spectrum;
  if (!law.maxwell_viscosity) {
    double compliance = 1 / law.maxwell_stiffness;
    for (const KelvinBranch& branch : law.branches)
      compliance += 1 / branch.stiffness;
    spectrum.push_back({0.0, 1 / compliance});
  }
  for (std::size_t j = 0; j < pole.size(); ++j) {
    const bool last = j + 1 == pole.size();
    double fluidity = 0;
    for (const Pole& each : pole)
      fluidity += each.fluidity;
    const double width =
        last ? 2 * law.maxwell_stiffness * fluidity : pole[j + 1].rate - pole[j].rate;
    double middle = 1 / law.maxwell_stiffness; // secular function in the middle of the interval
    for (std::size_t k = 0; k < pole.size(); ++k)
      middle += pole[k].fluidity / (pole[k].rate - pole[j].rate - 0.5 * width);
    const bool left = last || middle > 0;
    const std::size_t origin = left ? j : j + 1;
    const int side = left ? 1 : -1;
    const double distance = root_distance(law, pole, origin, side, 0.5 * margin * width);
    spectrum.push_back(mode_at(pole, origin, side, distance));
  }
  return spectrum;
}

double relaxation(std::span<const RelaxationMode> spectrum, double t)
{
  double sum = 0;
  for (const auto& [rate, stiffness] : spectrum)
    sum += stiffness * std::exp(-rate * t);
  return sum;
}

double mean_relaxation(std::span<const RelaxationMode> spectrum, double begin, double length)
{
  double sum = 0;
  for (const auto& [rate, stiffness] : spectrum)
    sum += stiffness * std::exp(-rate * begin) * phi1(rate * length);
  return sum;
}

double relaxation_integral(std::span<const RelaxationMode> spectrum, double t)
{
  return t * mean_relaxation(spectrum, 0, t);
}

CreepLaw with_viscosities_scaled(CreepLaw law, double factor)
{
  require(factor > 0 && factor < infinity, "a viscosity factor must be a finite number > 0",
          factor);
  if (law.maxwell_viscosity)
    *law.maxwell_viscosity *= factor;
  for (KelvinBranch& branch : law.branches)
    branch.viscosity *= factor;
  return law;
}

CreepLaw scaled(CreepLaw law, double factor)
{
  law = with_viscosities_scaled(std::move(law), factor);
  law.maxwell_stiffness *= factor;
  for (KelvinBranch& branch : law.branches)
    branch.stiffness *= factor;
  return law;
}

std::optional<double> proportionality(const CreepLaw& law, const CreepLaw& other)
{
  if (law.maxwell_viscosity.has_value() != other.maxwell_viscosity.has_value() ||
      law.branches.size() != other.branches.size())
    return std::nullopt;
  const double factor = other.maxwell_stiffness / law.maxwell_stiffness;
  const auto same = [&](double a, double b) { return std::abs(a * factor - b) <= 1e-12 * b; };
  bool all = !law.maxwell_viscosity || same(*law.maxwell_viscosity, *other.maxwell_viscosity);
  for (std::size_t k = 0; k < law.branches.size(); ++k)
    all = all && same(law.branches[k].stiffness, other.branches[k].stiffness) &&
          same(law.branches[k].viscosity, other.branches[k].viscosity);
  return all ? std::optional(factor) : std::nullopt;
}

} // namespace dem
