#pragma once
#include "dem/grading.h"
#include "dem/particles.h"
#include "dem/periodic_cell.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dem {

/// What a packing should be; the container is a cylinder with walls or a periodic cell.
template <typename Shape>
struct PackingRequestIn {
  Shape container;
  Grading grading;
  std::size_t n_particles;
  double solid_fraction;               ///< [-]
  double density = 2700;               ///< of the particles [kg/m^3]
  int min_contacts = 4;                ///< of every particle
  double contact_gap = 1e-3;           ///< a gap up to this times the smaller radius is a contact
  double residual_stress_bound = 30e3; ///< isotropic stress after preparation [Pa]
  double preparation_stiffness = 3e6;  ///< of a contact, for the residual stress [N/m]
};
using PackingRequest = PackingRequestIn<Cylinder>;
using PeriodicPackingRequest = PackingRequestIn<PeriodicCell>;

/// A request for n particles in a cube whose edge makes them fill the solid fraction at the sizes
/// of the grading.
PeriodicPackingRequest cube_request(const Grading& grading, std::size_t n_particles,
                                    double solid_fraction);

/// Diameters are scaled by this factor so that n particles of the grading fill the solid fraction.
double size_scale(const PackingRequest& request);

/// Dense frictionless packing in a rigid cylinder by radius expansion.
///
/// 1. Spheres of the grading at random places grow in stages; overlaps relax at each stage.
/// 2. At the full size, while the packing is over-compressed, sizes wander: spheres under more
///    than mean pressure change places in the size order with smaller ones. The sizes as a set do
///    not change, the pressure falls.
/// 3. Spheres with too few contacts grow, those under pressure shrink, at constant solid volume,
///    until nearly all have enough contacts. The last ones are fitted into the cages of their
///    neighbours. Sizes change by a few per cent; the report says by how much the grading moved.
///
/// Deterministic for a seed. The cost is linear in the number of particles. A target that the
/// grading cannot reach is not an error: the report shows what came out.
/// \throws std::invalid_argument for numbers out of range, or if the diameters would have to be
///         scaled by more than 5 % (the message names the fitting number of particles)
Particles grow_packing(const PackingRequest& request, std::uint64_t seed);

/// The same in a periodic cell of any shape, without walls. Centres lie in the cell.
/// \throws std::invalid_argument as above, and if the coarsest sieve is not smaller than the
///         distance between two faces
Particles grow_periodic_packing(const PeriodicPackingRequest& request, std::uint64_t seed);

} // namespace dem
