#pragma once
#include "fem/curve_fit.h"

namespace fem {

/// What should be known before a fit is used, from its numbers and its data.
std::vector<FitWarning> fit_warnings(const CurveFit& fit, const Measurements& data,
                                     int n_parameters, bool instantaneous_at_bound);

} // namespace fem
