#pragma once
#include "dem/packing.h"
#include "dem/volume_element.h"

#include <vector>

/// Random volume elements that several tests use.
namespace elements {

using namespace dem;

inline BondLaw law(double ratio = 11)
{
  return {burgers(1e6, 1.6e8, 8e5, 2.4e7), ratio, 1};
}

/// Spheres of 2 to 4 mm in a cube, bonded to the nearest until each has 6 contacts in the mean.
inline VolumeElement random_cube(std::size_t n_particles, std::uint64_t seed,
                                 std::vector<BondLaw> laws = {law()},
                                 std::vector<PairLaw> pair_laws = {{0, 0, 0}})
{
  const Grading grading = make_grading({{2e-3, 0}, {4e-3, 1}});
  const PeriodicPackingRequest request = cube_request(grading, n_particles, 0.62);
  Particles particles = grow_periodic_packing(request, seed);
  if (pair_laws.size() > 1)
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.material_class[i] = int(i % 2);
  const PeriodicContacts contacts = periodic_nearest_contacts(request.container, particles, 6);
  return make_volume_element(request.container, particles, contacts, std::move(laws),
                             std::move(pair_laws));
}

/// The same with two laws that are not proportional: between equal classes, and between others.
inline VolumeElement two_law_cube(std::size_t n_particles, std::uint64_t seed)
{
  const BondLaw other{burgers(3e6, 4e9, 2e6, 4e8), 5, 0.8};
  return random_cube(n_particles, seed, {law(), other}, {{0, 0, 0}, {1, 1, 0}, {0, 1, 1}});
}

} // namespace elements
