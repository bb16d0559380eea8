#include "dem/grading.h"

#include "dem/particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

constexpr std::array<std::string_view, 3> names{"sma10", "sma10-uniform", "sma10-gap"};

/// Mass between two sieves; its number density goes as d^-power.
struct SizeClass {
  double low, high; ///< [m]
  double power;
  double number; ///< particles per unit volume of all solids [1/m^3]
};

std::vector<SizeClass> size_classes(const Grading& grading)
{
  std::vector<SizeClass> result;
  for (std::size_t k = 1; k < grading.sieves.size(); ++k) {
    const double a = grading.sieves[k - 1].opening, b = grading.sieves[k].opening;
    const double mass = grading.sieves[k].passing - grading.sieves[k - 1].passing;
    if (mass == 0)
      continue;
    // mean of 1/V over the mass of the class
    const double inverse_cube = grading.spread == MassSpread::log_uniform
                                    ? (std::pow(a, -3) - std::pow(b, -3)) / (3 * std::log(b / a))
                                    : (std::pow(a, -2) - std::pow(b, -2)) / (2 * (b - a));
    result.push_back({a, b, grading.spread == MassSpread::log_uniform ? 4.0 : 3.0,
                      mass * inverse_cube / sphere_volume(0.5)});
  }
  return result;
}

} // namespace

Grading make_grading(std::vector<Sieve> sieves, MassSpread spread)
{
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("grading: " + what);
  };
  if (sieves.size() < 2)
    refuse("at least two sieves are needed");
  for (std::size_t k = 0; k < sieves.size(); ++k) {
    const auto [opening, share] = sieves[k];
    if (!(opening > 0) || !std::isfinite(opening))
      refuse(fmt::format("sieve {}: the opening must be > 0, found {:g} mm", k + 1, 1e3 * opening));
    if (!(share >= 0 && share <= 1))
      refuse(fmt::format("sieve {:g} mm: passing must be 0 to 100 %, found {:g} %", 1e3 * opening,
                         100 * share));
    if (k > 0 && !(opening > sieves[k - 1].opening && share >= sieves[k - 1].passing))
      refuse(fmt::format("sieve {:g} mm: openings must increase and passing must not decrease",
                         1e3 * opening));
  }
  if (sieves.front().passing != 0 || sieves.back().passing != 1)
    refuse("the finest sieve must pass 0 %, the coarsest 100 %");
  return {std::move(sieves), spread};
}

std::span<const std::string_view> grading_names()
{
  return names;
}

Grading named_grading(std::string_view name)
{
  if (name == names[0])
    return make_grading({{2e-3, 0}, {4e-3, 0.19}, {6.3e-3, 0.42}, {10e-3, 0.96}, {14e-3, 1}});
  if (name == names[1])
    return make_grading({{2e-3, 0}, {10e-3, 1}}, MassSpread::uniform);
  if (name == names[2])
    return make_grading({{2e-3, 0}, {4e-3, 0.055}, {6.3e-3, 0.18}, {10e-3, 0.96}, {14e-3, 1}});
  std::string known;
  for (const std::string_view each : names)
    known += fmt::format("{}{}", known.empty() ? "" : ", ", each);
  throw std::invalid_argument(fmt::format("no grading is called '{}'; known: {}", name, known));
}

Grading monodisperse_grading(double diameter)
{
  constexpr double half_width = 1e-6;
  return make_grading({{diameter * (1 - half_width), 0}, {diameter * (1 + half_width), 1}});
}

double mean_particle_volume(const Grading& grading)
{
  double number = 0;
  for (const SizeClass& each : size_classes(grading))
    number += each.number;
  return 1 / number;
}

std::vector<double> representative_diameters(const Grading& grading, std::size_t n)
{
  const std::vector<SizeClass> classes = size_classes(grading);
  double total = 0;
  for (const SizeClass& each : classes)
    total += each.number;
  std::vector<double> diameter;
  diameter.reserve(n);
  std::size_t c = 0;
  double below = 0; // number in the classes before c
  for (std::size_t k = 0; k < n; ++k) {
    const double wanted = (double(k) + 0.5) / double(n) * total;
    while (c + 1 < classes.size() && wanted > below + classes[c].number)
      below += classes[c++].number;
    const auto& [low, high, power, number] = classes[c];
    const double share = std::min(1.0, (wanted - below) / number), p = 1 - power;
    const double a = std::pow(low, p), b = std::pow(high, p);
    diameter.push_back(std::pow(a + share * (b - a), 1 / p));
  }
  return diameter;
}

std::vector<double> passing(std::span<const double> diameter, std::span<const Sieve> sieves)
{
  double total = 0;
  std::vector<double> result(sieves.size(), 0.0);
  for (const double d : diameter) {
    const double volume = sphere_volume(0.5 * d);
    total += volume;
    for (std::size_t k = 0; k < sieves.size(); ++k)
      if (d <= sieves[k].opening)
        result[k] += volume;
  }
  for (double& share : result)
    share = total > 0 ? share / total : 0;
  return result;
}

} // namespace dem
