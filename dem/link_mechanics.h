#pragma once
#include "dem/law_step.h"
#include "dem/links.h"
#include "dem/quasistatic_settings.h"

#include <span>
#include <vector>

namespace dem {

/// How all bodies have moved since the start of the step.
struct Configuration {
  std::vector<Vec3> moved;  ///< displacement [m]
  std::vector<Vec3> turn;   ///< rotation vector [rad]
  Mat3 cell = Mat3::Zero(); ///< change of the displacement gradient of the periodic cell [-]
};

/// What is the same for all links in a step.
struct LinkStep {
  const Assembly* assembly;
  const Bodies* bodies;
  const Links* start;            ///< at the start of the step
  std::span<const Vec3> centre;  ///< of all bodies then [m]
  std::span<const LawStep> laws; ///< one per law
  double friction;               ///< coefficient [-]
  double regularisation;         ///< viscous resistance of contacts to sliding and rolling over the
                                 ///< step, over their normal stiffness [-]
  Geometry geometry;
  Mat3 stretch = Mat3::Identity(); ///< deformation of the periodic cell at the start
};

/// Change of a link's forces with the relative motion of its bodies at the contact point:
/// dF = k_n n n.d + k_s (d - n n.d - s s.d) + k_v (d - n n.d),
/// dM = k_t n n.phi + k_b (phi - n n.phi).
///
/// s is the direction of slip (zero without), k_s the stiffness that is left beside it, k_v that of
/// the regularisation: with the friction limit held, that is the exact derivative, symmetric and
/// positive semidefinite.
struct LinkTangent {
  Vec3 normal, slip;
  double arm_first, arm_second; ///< from the centres to the contact point, along n and -n [m]
  double k_n = 0, k_s = 0, k_v = 0, k_t = 0, k_b = 0;
  double gap = 0; ///< that a link which does not carry has yet to close [m]

  bool carries() const { return k_n > 0 || k_s > 0 || k_v > 0; }
};

/// A link at a trial configuration.
struct LinkAnswer {
  LinkTangent tangent;
  Vec3 force, moment; ///< on the first body at the contact point, in global axes
  BondFrame frame;
  double distance;            ///< [m]
  std::array<double, 6> push; ///< displacement of each mode [m] or [rad]
  double normal_force = 0;    ///< tension positive [N]
  double shear_force = 0;     ///< [N]
  double kept_shear = 1;      ///< share of the trial shear force that friction leaves
  double opening = 0;         ///< distance at which a closed contact has no force [m]
  bool closed = false;
};

/// Forces of a link when its bodies have moved from the start of the step to `now`.
///
/// The elongation is the change of distance; shear, torsion and bending follow the relative motion
/// at the contact point in the mid-step configuration, so that rigid motions strain nothing, to
/// rounding, and the two ends are treated alike.
///
/// Within a step the friction limit of a contact is that of its start, whatever its normal force
/// does, and a contact that closes slides freely until the next: with the geometry held, forces are
/// then the gradient of a convex potential.
LinkAnswer answer(const LinkStep& step, std::size_t k, const Configuration& now);

/// The memory of a link after the step, and its energies.
struct LinkEnergies {
  double stored = 0, dashpots = 0, friction = 0, regularisation = 0; ///< over the step [J]
};
LinkEnergies commit(const LinkStep& step, std::size_t k, const LinkAnswer& end, Links& links);

/// What the other scheme would make of the same motion of a link that stays closed: work of the
/// difference of the forces [J], and that of the stiffness. Their quotient estimates the relative
/// error of the displacement gained.
void scheme_difference(const LinkStep& step, std::size_t k, const LinkAnswer& end,
                       std::span<const LawStep> other, double& difference, double& size);

/// Recoverable energy of a link [J].
double stored_energy(const Links& links, std::size_t k, const Assembly& assembly);

} // namespace dem
