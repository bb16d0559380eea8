#pragma once
#include "fem/compliance_law.h"

#include <vector>

namespace fem {

/// One relaxing part of a stiffness, C_k exp(-t / rho_k).
struct RelaxationTerm {
  double time;    ///< relaxation time rho_k [s], > 0
  Mat6 stiffness; ///< C_k, Mandel [Pa], positive semidefinite
};

/// Relaxation law C(t) = C_inf + sum_k C_k exp(-t / rho_k): stress under a constant unit strain.
struct RelaxationLaw {
  Mat6 equilibrium = Mat6::Zero();   ///< C_inf [Pa]; singular where the material flows
  std::vector<RelaxationTerm> terms; ///< by rising relaxation time
};

/// Checked law, sorted by relaxation time.
/// \throws std::invalid_argument as `make_compliance_law`; C(0) must be positive definite and sets
///         the scale of the thresholds
RelaxationLaw make_relaxation_law(const Mat6& equilibrium, std::span<const RelaxationTerm> terms);

/// C(t) [Pa], Mandel, t >= 0.
Mat6 stiffness(const RelaxationLaw& law, double t);

/// Complex stiffness C* [Pa], Mandel, at the angular frequency omega [rad/s] > 0.
ComplexMat6 complex_stiffness(const RelaxationLaw& law, double omega);

/// The relaxation law of a creep law, exact to rounding (see fem/interconversion.h). In general
/// every retardation term gives up to six relaxation times, in a proportional law one.
RelaxationLaw relaxation_law(const ComplianceLaw& law);

/// The creep law of a relaxation law, exact to rounding.
ComplianceLaw compliance_law(const RelaxationLaw& law);

} // namespace fem
