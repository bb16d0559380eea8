#pragma once
#include "dem/assembly.h"
#include "dem/random.h"
#include "tests/reference.h"

#include <numbers>
#include <string>
#include <vector>

/// Small specimens that several tests use.
namespace assemblies {

using namespace dem;

constexpr PairLaw one_law{0, 0, 0};

inline Assembly bonded(const std::vector<Vec3>& centre, const std::vector<double>& radius,
                       const std::vector<Support>& support,
                       const std::vector<std::array<Index, 2>>& pairs, const BondLaw& law)
{
  Assembly assembly;
  assembly.particles.centre = centre;
  assembly.particles.radius = radius;
  assembly.particles.material_class.assign(radius.size(), 0);
  assembly.support = support;
  assembly.laws = {law};
  assembly.bonds = make_bonds(assembly.particles, pairs, assembly.laws, {&one_law, 1});
  assembly.area = 1;
  assembly.gauge_length = 1;
  return assembly;
}

/// Equal touching spheres of a diameter in a row along z; the first is clamped, the last is loaded
/// by the platen (`platen`) or by a particle load.
inline Assembly chain(int n_bonds, double diameter, const BondLaw& law, bool platen)
{
  std::vector<Vec3> centre;
  std::vector<std::array<Index, 2>> pairs;
  for (int i = 0; i <= n_bonds; ++i) {
    centre.emplace_back(0, 0, (i + 0.5) * diameter);
    if (i > 0)
      pairs.push_back({i - 1, i});
  }
  std::vector<Support> support(centre.size(), Support::free);
  support.front() = Support::bottom;
  if (platen)
    support.back() = Support::top;
  Assembly assembly =
      bonded(centre, std::vector<double>(centre.size(), diameter / 2), support, pairs, law);
  assembly.gauge_length = n_bonds * diameter;
  if (!platen)
    assembly.loads = {{n_bonds, Vec3(1, 0, 0), Vec3::Zero()}};
  return assembly;
}

/// n bonds side by side between the platens, each between two spheres of its own.
inline Assembly bundle(std::span<const double> strength, double length, const CreepLaw& creep)
{
  std::vector<Vec3> centre;
  std::vector<Support> support;
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t k = 0; k < strength.size(); ++k) {
    const double x = 2 * length * double(k);
    centre.insert(centre.end(), {Vec3(x, 0, length / 2), Vec3(x, 0, 3 * length / 2)});
    support.insert(support.end(), {Support::bottom, Support::top});
    pairs.push_back({Index(2 * k), Index(2 * k + 1)});
  }
  Assembly assembly = bonded(centre, std::vector<double>(centre.size(), length / 2), support, pairs,
                             BondLaw{creep, 11, 1});
  assembly.gauge_length = length;
  assembly.strengths =
      Strengths{{strength.begin(), strength.end()}, {strength.begin(), strength.end()}, 0};
  return assembly;
}

/// A network in the form of the golden_network files; `laws` of the even and the odd bonds.
inline Assembly golden(const nlohmann::json& network, const std::vector<BondLaw>& laws)
{
  Assembly assembly;
  for (const auto& x : network.at("positions"))
    assembly.particles.centre.emplace_back(x[0].get<double>(), x[1].get<double>(),
                                           x[2].get<double>());
  assembly.particles.radius = network.at("radii").get<std::vector<double>>();
  assembly.particles.material_class.assign(assembly.particles.size(), 0);
  assembly.support.assign(assembly.particles.size(), Support::free);
  for (const auto& i : network.at("clamped"))
    assembly.support[i.get<int>()] = Support::bottom;
  std::vector<std::array<Index, 2>> pairs;
  for (const auto& bond : network.at("bonds"))
    pairs.push_back({bond.at("a").get<Index>(), bond.at("b").get<Index>()});
  assembly.laws = laws;
  assembly.bonds = make_bonds(assembly.particles, pairs, laws, {&one_law, 1});
  for (std::size_t b = 0; b < pairs.size(); ++b)
    assembly.bonds.law[b] = int(b % laws.size());
  for (const auto& [particle, load] : network.at("loads").items())
    assembly.loads.push_back(
        {Index(std::stoi(particle)),
         Vec3(load[0].get<double>(), load[1].get<double>(), load[2].get<double>()),
         Vec3(load[3].get<double>(), load[4].get<double>(), load[5].get<double>())});
  assembly.area = 1;
  assembly.gauge_length = 1;
  return assembly;
}

/// A random bonded block between the platens: spheres near the sites of a simple cubic lattice.
inline Assembly block(int n_side, int n_high, const BondLaw& law, std::uint64_t seed)
{
  const double pitch = 4e-3;
  std::vector<Vec3> centre;
  std::vector<double> radius;
  std::vector<Support> support;
  for (int z = 0; z < n_high; ++z)
    for (int y = 0; y < n_side; ++y)
      for (int x = 0; x < n_side; ++x) {
        const auto jitter = [&](std::uint32_t k) {
          return uniform(seed, RandomStream::packing, centre.size(), k) - 0.5;
        };
        centre.push_back(pitch * (Vec3(x, y, z) + 0.2 * Vec3(jitter(0), jitter(1), jitter(2))));
        radius.push_back(pitch * (0.52 + 0.1 * jitter(3)));
        support.push_back(z == 0            ? Support::bottom
                          : z + 1 == n_high ? Support::top
                                            : Support::free);
      }
  Particles particles{centre, radius, std::vector<int>(radius.size(), 0)};
  const ContactPairs contacts = contacts_within(particles, 0.3);
  Assembly assembly = bonded(centre, radius, support, contacts.pairs, law);
  assembly.area = pitch * pitch * n_side * n_side;
  assembly.gauge_length = pitch * (n_high - 1);
  return assembly;
}

} // namespace assemblies
