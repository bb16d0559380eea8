#pragma once
#include "dem/creep_law.h"
#include "fem/creep_compliance.h"

namespace coupling {

/// The bond law that gives a packing a measured creep compliance D(t).
///
/// While bonds hold and displacements are small, D(t) = c J(t) with the geometry factor
/// c = D(0) K_m of the packing, one elastic solution (see `geometry_factor`): the calibration is
/// linear and exact, for any number of Kelvin branches.
/// \param geometry_factor  c [m], > 0
/// \throws std::invalid_argument as `dem::make_creep_law`
dem::CreepLaw calibrated_law(const fem::CreepCompliance& macroscopic, double geometry_factor);

/// c [m]: creep compliance [1/Pa] of a packing over that [m/N] of the bond law it was found with.
double geometry_factor(double macroscopic_compliance, const dem::CreepLaw& law);

} // namespace coupling
