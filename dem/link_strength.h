#pragma once
#include "dem/links.h"
#include "dem/strength.h"

#include <vector>

namespace dem {

/// Ratio of force to strength at the reference rate of each bond; 0 where it is broken. Forces
/// below a share of the largest are rounding and count as 0.
std::vector<double> strength_ratios(const Links& links, const Strengths& strengths, double noise);

/// Forces of a bond that breaks, and by which of its strengths it does.
struct BreakingForces {
  double normal, shear; ///< [N], tension positive
  BreakMode mode;
};
BreakingForces breaking_forces(const Links& links, std::size_t bond, const Strengths& strengths);

} // namespace dem
