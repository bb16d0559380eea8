#pragma once
#include "dem/assembly.h"
#include "dem/bond_frame.h"
#include "dem/periodic_cell.h"
#include "dem/records.h"

#include <optional>
#include <span>
#include <vector>

namespace dem {

/// What a link between two bodies does.
enum class LinkKind : std::uint8_t {
  bond,   ///< all six modes
  contact ///< pressed only, with or without friction
};

/// A bond, or two bodies that touch or may soon touch without being bonded.
///
/// Bodies are the particles and, after them, the lower and the upper platen. A contact whose force
/// would pull opens and forgets; it closes again at the distance at which its force was zero, so
/// that viscous flattening stays.
struct Link {
  Index first, second; ///< bodies; a platen is always second
  Index bond = -1;     ///< bond it is or was, or -1
  int law = 0;
  LinkKind kind = LinkKind::contact;
  bool closed = false; ///< bonds are always closed
  double offset;       ///< of the contact point from mid-distance towards the second [m]
  double touch;        ///< distance of the centres at which an open contact closes [m]
  double distance;     ///< of the centres, or height above the platen [m]
  double span;         ///< distance when the link was made: of the arms of small displacements [m]
  BondFrame frame;     ///< from the first body to the second
  ImageShift image = ImageShift::Zero(); ///< of the second body, in a periodic cell
};

/// The links of a specimen and what each of their six modes remembers.
struct Links {
  std::vector<Link> link;      ///< bonds first, in their order; then by bodies
  int n_parts = 1;             ///< numbers that a mode remembers (see law_step.h)
  std::vector<double> memory;  ///< 6 x n_parts per link: normal, shear (2), torsion, bending (2)
  std::vector<Vec3> reference; ///< centres when near pairs were last looked for [m]

  double* memory_of(std::size_t k) { return memory.data() + 6 * n_parts * k; }
  const double* memory_of(std::size_t k) const { return memory.data() + 6 * n_parts * k; }
};

/// Bodies of a specimen: particles, then the two platens.
struct Bodies {
  std::vector<double> radius;
  std::vector<Support> support;
  std::vector<int> material_class;
  bool platens_press;                    ///< false if the load does not act through platens
  std::optional<PeriodicCell> cell = {}; ///< at rest, if the particles repeat; no platens then

  Index n_particles() const { return Index(radius.size()) - 2; }
  Index lower_platen() const { return n_particles(); }
  Index upper_platen() const { return n_particles() + 1; }
};
Bodies make_bodies(const Assembly& assembly);

/// Vector from the first body of a link to its second; to a platen along its normal.
/// \param stretch  deformation of the periodic cell, if there is one
Vec3 branch(const Link& link, const Bodies& bodies, std::span<const Vec3> centre,
            const Mat3& stretch = Mat3::Identity());

/// Stiffness multipliers of the six modes; those of torsion and bending are zero in a contact.
std::array<double, 6> mode_multipliers(const Link& link, const Assembly& assembly);

/// Bonds at rest.
/// \param centre  of all bodies
/// \param image   of the second end of each bond, in a periodic cell
Links make_links(const Assembly& assembly, const Bodies& bodies, std::span<const Vec3> centre,
                 std::span<const ImageShift> image = {});

/// Looks for near pairs that are not linked yet, and drops open contacts that are far apart. A pair
/// that overlaps when it is first seen touches at that distance: no force comes from nowhere.
/// \param skin  gap up to which pairs are linked [m]
/// \param stretch  deformation of the periodic cell, if there is one
Links find_contacts(Links links, const Assembly& assembly, const Bodies& bodies,
                    std::span<const Vec3> centre, double skin,
                    const Mat3& stretch = Mat3::Identity());

/// True if bodies have moved so far that near pairs must be looked for again.
bool contacts_outdated(const Links& links, std::span<const Vec3> centre, double skin);

/// What the breakage of a bond leaves: after shear of a pressed bond the forces stay (without
/// friction the normal one; moments end), after tension an open contact that touches again where
/// the bond began.
void break_link(Links& links, std::size_t k, BreakMode mode, AfterBreakage after,
                double initial_distance);

/// Opens a contact at a distance and lets it forget its forces.
void open_link(Links& links, std::size_t k, double distance);

} // namespace dem
