#pragma once
#include "dem/contact_search.h"
#include "dem/particles.h"
#include "dem/periodic_cell.h"

#include <variant>
#include <vector>

namespace dem {

/// What holds spheres together: rigid walls, or their own images.
using Container = std::variant<Cylinder, PeriodicCell>;
double volume(const Container& container); ///< [m^3]

/// Frictionless spheres that repel each other and the container in proportion to their overlap,
/// with unit stiffness: the mechanics of specimen preparation.
struct SoftSpheres {
  Container container;
  std::vector<Vec3> centre;   ///< [m]
  std::vector<double> radius; ///< [m]

  std::size_t size() const { return radius.size(); }
};

/// Neighbour list that stays valid while spheres move and grow a little.
struct NearSpheres {
  double skin; ///< [m], gap below which a pair is listed
  NeighbourList list;
  std::vector<Vec3> offset; ///< [m] of the image of each neighbour; empty between walls
  SoftSpheres reference;    ///< the spheres the list was made for

  /// Where the k-th neighbour of the list stands, seen from its partner [m].
  Vec3 place(const SoftSpheres& spheres, Index k) const
  {
    const Vec3& centre = spheres.centre[list.neighbour[k]];
    return offset.empty() ? centre : centre + offset[k];
  }
};

/// A list with a skin of 0.4 times the smallest radius.
NearSpheres make_near_spheres(const SoftSpheres& spheres);

/// Makes the list anew if the spheres have moved or grown too far since it was made.
/// \param gap [m], pairs up to this gap must be in the list
void refresh(NearSpheres& near, const SoftSpheres& spheres, double gap = 0);

/// What presses on the spheres.
struct Compression {
  double virial = 0;             ///< sum of force times branch over all contacts [m^2]
  double mean_overlap = 0;       ///< over the contacts, each relative to the smaller radius [-]
  std::vector<double> force_sum; ///< of the contact forces on each sphere [m]
};

/// Contacts of the spheres as they stand.
Compression compression(const SoftSpheres& spheres, NearSpheres& near);

/// Gap of each sphere to its n-th nearest neighbour or wall [m]: the sphere has n contacts when
/// this gap is closed. Negative if they overlap; at most the skin of the list.
std::vector<double> gaps_to_neighbour(const SoftSpheres& spheres, NearSpheres& near, int n);

/// Moves the spheres towards the minimum of their elastic energy (FIRE: inertia that is reset when
/// it runs uphill). Stops after n_steps or when no force exceeds `tolerance` [m].
/// Bitzek et al., Phys. Rev. Lett. 97 (2006) 170201.
SoftSpheres relax(SoftSpheres spheres, NearSpheres& near, int n_steps, double tolerance);

/// Fits each sphere with less than n contacts into the cage of its neighbours, which keep place and
/// size: it grows and moves until n neighbours or walls are nearer than `gap` times its radius.
/// A sphere for which this fails (it would grow threefold, or is squeezed) stays as it is.
SoftSpheres fit_floaters(SoftSpheres spheres, NearSpheres& near, int n, double gap);

} // namespace dem
