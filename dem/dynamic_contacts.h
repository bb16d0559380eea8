#pragma once
#include "dem/bond_frame.h"
#include "dem/dynamic_bonds.h"
#include "dem/records.h"

#include <span>
#include <vector>

namespace dem {

/// Partner of a contact that is a platen instead of a particle.
constexpr Index lower_platen = -1, upper_platen = -2;

/// Two spheres, or a sphere and a platen, that touch or may soon touch without being bonded.
///
/// Compression only, with the creep law of the pair in the normal and the shear direction and
/// Coulomb friction. A contact whose force would pull opens and forgets its forces; it closes again
/// at the distance at which it opened, so that viscous flattening stays.
struct FrictionContact {
  Index first;     ///< slot
  Index second;    ///< slot, or a platen
  Index bond = -1; ///< bond it was, or -1
  int law;         ///< of the assembly
  double touch;    ///< distance of the centres (height above the platen) at which it closes [m]
  double distance; ///< [m]
  BondFrame frame;
  bool closed = false;
  std::vector<double> normal, shear_1, shear_2; ///< forces of the relaxation modes [N]
};

/// Contacts of an explicit run, and where the particles were when near pairs were last looked for.
struct DynamicContacts {
  std::vector<FrictionContact> contacts; ///< sorted by slots
  std::vector<Vec3> reference;           ///< centre of each slot then [m]
  double skin;                           ///< gap up to which pairs are listed [m]
};

/// What contacts need to know of the spheres: all by slot.
struct ContactSurroundings {
  std::span<const double> motions; ///< motion_stride numbers per slot
  std::span<const double> radius;  ///< [m]
  std::span<const Support> support;
  std::span<const int> material_class;
  bool platens_press;                ///< false if the load does not act through platens
  double lower_height, upper_height; ///< of the platens [m]
};

/// Looks for near pairs anew and keeps the contacts that exist. Pairs in `bonded` (sorted, lower
/// slot first) are left out. A pair that overlaps when it is first seen touches at that distance:
/// no force comes from nowhere.
DynamicContacts find_contacts(DynamicContacts contacts, const ContactSurroundings& around,
                              std::span<const std::array<Index, 2>> bonded,
                              std::span<const PairLaw> pair_laws, int n_modes);

/// True if particles have moved so far that near pairs must be looked for again.
bool is_outdated(const DynamicContacts& contacts, const ContactSurroundings& around);

/// The contact that a broken bond leaves: after shear of a pressed bond its forces stay (moments
/// end), after tension it is open and touches again where the bond began.
FrictionContact contact_after(const DynamicBond& bond, BreakMode mode, double initial_distance);

/// Advances all contacts over one step and adds their forces to the particles.
/// \param forces  force_stride numbers per slot
/// \param on_upper, on_lower  receive the force on the platens along z [N]
void advance_contacts(DynamicContacts& contacts, const ContactSurroundings& around,
                      std::span<const BondLaw> laws, std::span<const StepFactors> factors,
                      double friction, double* forces, double& on_upper, double& on_lower);

} // namespace dem
