#pragma once
#include "dem/bonds.h"
#include "dem/network.h"
#include "dem/periodic_cell.h"

#include <span>
#include <vector>

namespace dem {

/// A particle at the surface of an element that was cut out of a packing.
struct BoundaryParticle {
  Index particle;
  ImageShift side; ///< -1, 0 or 1 along each edge: the faces it lies at
};

/// Representative volume element (RVE): bonded spheres that fill a cell. It does not change.
///
/// Either periodic, or cut out of a larger packing, where the cell only says which box was cut.
/// Make one with `make_volume_element` or `cut_box`, which check it.
struct VolumeElement {
  PeriodicCell cell;
  Particles particles;
  std::vector<BondLaw> laws;
  std::vector<PairLaw> pair_laws;
  Bonds bonds;
  std::vector<ImageShift> shift;          ///< of each bond: the image of its second end
  bool is_periodic = true;                ///< false: cut out; all shifts are zero
  std::vector<BoundaryParticle> boundary; ///< of a cut element
};

/// Pairs of particles to be bonded across faces, and the gap that decided.
struct PeriodicContacts {
  std::vector<std::array<Index, 2>> pairs;
  std::vector<ImageShift> shift;
  double gap; ///< largest gap bonded, relative to the smaller radius [-]; -1 without pairs
};

/// All pairs, images included, whose gap is at most `gap` times the smaller radius.
PeriodicContacts periodic_contacts_within(const PeriodicCell& cell, const Particles& particles,
                                          double gap);

/// The nearest pairs, until the mean number of contacts per particle is reached, as
/// `nearest_contacts`.
PeriodicContacts periodic_nearest_contacts(const PeriodicCell& cell, const Particles& particles,
                                           double mean_contacts);

/// Checked periodic element. Particles are wrapped into the cell.
/// \throws std::invalid_argument for a missing particle, a self bond without shift, a contact that
///         comes twice (in either direction), coincident centres, lists of different length,
///         numbers that are not finite, or a pair of classes without a law
VolumeElement make_volume_element(const PeriodicCell& cell, Particles particles,
                                  const PeriodicContacts& contacts, std::vector<BondLaw> laws,
                                  std::vector<PairLaw> pair_laws);

/// The part of a packing whose centres lie in an upright box, bonded inside. Particles with centres
/// nearer to a face than `layer` [m] are its boundary. Only the largest connected group is kept.
/// \param contacts  pairs of the packing
/// \throws std::invalid_argument if nothing is inside, or a face has no boundary particles
VolumeElement cut_box(const Particles& packing, std::span<const std::array<Index, 2>> contacts,
                      const Vec3& low, const Vec3& high, double layer, std::vector<BondLaw> laws,
                      std::vector<PairLaw> pair_laws);

/// From the first centre of a bond to the second, image included [m].
Vec3 branch(const VolumeElement& element, std::size_t bond);

/// Volume of the spheres over the volume of the cell [-]; overlaps count twice.
double solid_fraction(const VolumeElement& element);

/// Particles that hang together by bonds, through faces.
struct Cluster {
  std::vector<Index> particles; ///< the first comes first in the element
  std::vector<Vec3> direction;  ///< 0 to 3 independent directions in which it goes on for ever [m]
};
struct Clusters {
  std::vector<Cluster> cluster;
  std::vector<ImageShift> offset; ///< of each particle, to stand beside the others of its cluster
};
Clusters find_clusters(const VolumeElement& element, std::span<const BondStatus> status);

/// The same element with particles moved by whole edges until each cluster is one body when
/// the bonds across faces are cut. Branches, and all that follows from them, stay.
VolumeElement with_whole_clusters(VolumeElement element);

/// Network of the bonds. Dofs are the motions of the particles on top of the mean strain; they are
/// the same for all images. Nothing is held.
ElasticNetwork make_network(const VolumeElement& element);

} // namespace dem
