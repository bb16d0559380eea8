#include "dem/bonds.h"

#include "dem/contact_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace dem {

namespace {

struct Candidate {
  double gap; ///< relative to the smaller radius
  std::array<Index, 2> pair;
};

std::vector<Candidate> candidates(const Particles& particles, double largest_gap)
{
  std::vector<Candidate> result;
  if (particles.size() == 0)
    return result;
  const auto& [centre, radius, material_class, density] = particles;
  const double margin = std::max(0.0, largest_gap) * std::ranges::max(radius);
  const NeighbourList near = near_pairs(centre, radius, margin);
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (Index k = near.start[i]; k < near.start[i + 1]; ++k) {
      const Index a = std::min(Index(i), near.neighbour[k]);
      const Index b = std::max(Index(i), near.neighbour[k]);
      const double gap =
          ((centre[a] - centre[b]).norm() - radius[a] - radius[b]) / std::min(radius[a], radius[b]);
      if (gap <= largest_gap)
        result.push_back({gap, {a, b}});
    }
  return result;
}

ContactPairs sorted_pairs(std::span<const Candidate> chosen)
{
  ContactPairs result{{}, -1};
  for (const Candidate& each : chosen) {
    result.pairs.push_back(each.pair);
    result.gap = std::max(result.gap, each.gap);
  }
  std::ranges::sort(result.pairs);
  return result;
}

int law_between(int a, int b, std::span<const PairLaw> pair_laws)
{
  for (const PairLaw& each : pair_laws)
    if ((each.class_a == a && each.class_b == b) || (each.class_a == b && each.class_b == a))
      return each.law;
  throw std::invalid_argument(
      fmt::format("no bond law is given between particles of class {} and class {}", a, b));
}

} // namespace

ModeStiffness mode_stiffness(const BondLaw& law, double section_radius)
{
  const double normal = law.creep.maxwell_stiffness, shear = normal / law.normal_to_shear;
  const double squared = section_radius * section_radius;
  return {normal, shear, shear * squared / 2, normal * squared / 4};
}

ContactPairs contacts_within(const Particles& particles, double gap)
{
  return sorted_pairs(candidates(particles, gap));
}

ContactPairs nearest_contacts(const Particles& particles, double mean_contacts)
{
  std::vector<Candidate> all = candidates(particles, 0.05);
  std::ranges::sort(all, [](const Candidate& x, const Candidate& y) {
    return std::tie(x.gap, x.pair) < std::tie(y.gap, y.pair);
  });
  const auto wanted = std::size_t(std::llround(0.5 * mean_contacts * double(particles.size())));
  all.resize(std::min(all.size(), wanted));
  return sorted_pairs(all);
}

void validate(std::span<const BondLaw> laws)
{
  const auto require = [](bool condition, const char* what, double found) {
    if (!condition)
      throw std::invalid_argument(fmt::format("bond law: {} must be > 0, found {:g}", what, found));
  };
  for (const BondLaw& law : laws) {
    require(law.normal_to_shear > 0 && std::isfinite(law.normal_to_shear), "N/S",
            law.normal_to_shear);
    require(law.radius_multiplier > 0 && std::isfinite(law.radius_multiplier),
            "the radius multiplier", law.radius_multiplier);
  }
}

void append_bond(Bonds& bonds, const Particles& particles, const std::array<Index, 2>& ends,
                 std::span<const BondLaw> laws, std::span<const PairLaw> pair_laws)
{
  const auto [a, b] = ends;
  const int law = law_between(particles.material_class[a], particles.material_class[b], pair_laws);
  const double smaller = std::min(particles.radius[a], particles.radius[b]);
  bonds.ends.push_back(ends);
  bonds.section_radius.push_back(laws[law].radius_multiplier * smaller);
  bonds.contact_offset.push_back(0.5 * (particles.radius[a] - particles.radius[b]));
  bonds.law.push_back(law);
  bonds.id.push_back(std::int64_t(bonds.size()) - 1);
}

Bonds make_bonds(const Particles& particles, std::span<const std::array<Index, 2>> pairs,
                 std::span<const BondLaw> laws, std::span<const PairLaw> pair_laws)
{
  validate(laws);
  const auto n = Index(particles.size());
  std::set<std::array<Index, 2>> seen;
  Bonds bonds;
  for (const auto& [a, b] : pairs) {
    const auto refuse = [&](const std::string& what) {
      throw std::invalid_argument(
          fmt::format("bond {} between particles {} and {}: {}", bonds.size(), a, b, what));
    };
    if (a < 0 || b < 0 || a >= n || b >= n)
      refuse(fmt::format("there are particles 0 to {} only", n - 1));
    if (a == b)
      refuse("a particle cannot be bonded to itself");
    if (!seen.insert({std::min(a, b), std::max(a, b)}).second)
      refuse("this pair is already bonded");
    const double smaller = std::min(particles.radius[a], particles.radius[b]);
    if (!((particles.centre[a] - particles.centre[b]).norm() > 1e-9 * smaller))
      refuse("the centres coincide, the bond has no direction");
    append_bond(bonds, particles, {a, b}, laws, pair_laws);
  }
  return bonds;
}

std::optional<ProportionalLaws> proportional_laws(std::span<const BondLaw> laws)
{
  ProportionalLaws result{laws.front().creep, {}};
  for (const BondLaw& law : laws) {
    const std::optional<double> factor = proportionality(result.creep, law.creep);
    if (!factor)
      return std::nullopt;
    result.factors.push_back(*factor);
  }
  return result;
}

} // namespace dem
