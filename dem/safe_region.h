#pragma once
#include "dem/damaged_element.h"

namespace dem {

/// Certificate that no bond of an element breaks: an upper bound of `largest_ratio` that is cheap.
///
/// "No bond breaks" is a convex region of elastic strain: a half-space for the tension and an
/// elliptic cylinder for the shear force of each bond. The bonds that bound it most are looked at
/// one by one; all others are inside an ellipsoid, sum of the squares of their forces over their
/// strengths with weights that make it large (the D-optimal ones, found by multiplicative steps)
/// and a factor that makes it certain.
struct SafeRegion {
  Mat6 ellipsoid = Mat6::Zero(); ///< M: their ratio is at most sqrt(e^T M e)
  std::vector<Index> critical;   ///< bonds that are looked at one by one
  /// Their rows: normal force over normal strength, shear forces over shear strength.
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor> rows;
  bool is_empty = false; ///< a bond without strength: no strain but zero is safe
};

/// The region of an element with these strengths, at the reference strain rate.
SafeRegion safe_region(const DamagedElement& element, const Strengths& strengths);

/// M such that the largest ratio changes by at most sqrt(d^T M d) when the elastic strain changes
/// by d; infinite if a bond has no strength. Cheap, and not as tight as it could be.
Mat6 ratio_reach(const DamagedElement& element, const Strengths& strengths);

/// Upper bound of the largest ratio of force to strength under an elastic strain [-].
double ratio_bound(const SafeRegion& region, const Vec6& strain);

} // namespace dem
