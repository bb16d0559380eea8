#pragma once
#include "fem/compliance_law.h"

#include <complex>
#include <optional>
#include <vector>

namespace fem {

/// One retarded part of a scalar compliance.
struct RetardationPart {
  double time;       ///< tau_k [s], > 0
  double compliance; ///< D_k [1/Pa], >= 0
};

/// Uniaxial creep compliance D(t) = D_0 + phi t + sum_k D_k (1 - exp(-t / tau_k)); the Burgers
/// element is the case of one part.
struct CreepCompliance {
  double instantaneous = 0;           ///< D_0 [1/Pa], > 0
  double fluidity = 0;                ///< phi = 1/eta [1/(Pa s)], >= 0; 0 in a solid
  std::vector<RetardationPart> parts; ///< by rising retardation time
};

/// One relaxing part of a modulus.
struct RelaxationPart {
  double time;    ///< rho_k [s], > 0
  double modulus; ///< E_k [Pa], >= 0
};

/// Relaxation modulus E(t) = E_inf + sum_k E_k exp(-t / rho_k).
struct RelaxationModulus {
  double equilibrium = 0;            ///< E_inf [Pa], >= 0
  std::vector<RelaxationPart> parts; ///< by rising relaxation time
};

/// D(t) [1/Pa], t >= 0.
double value(const CreepCompliance& law, double t);

/// E(t) [Pa], t >= 0.
double value(const RelaxationModulus& law, double t);

/// D* = D' - i D'' [1/Pa] at omega [rad/s] > 0.
std::complex<double> complex_compliance(const CreepCompliance& law, double omega);

/// E* = E' + i E'' [Pa] at omega [rad/s] > 0.
std::complex<double> complex_modulus(const RelaxationModulus& law, double omega);
std::complex<double> complex_modulus(const CreepCompliance& law, double omega);

/// Exact conversions (see fem/interconversion.h).
RelaxationModulus relaxation_modulus(const CreepCompliance& law);
CreepCompliance creep_compliance(const RelaxationModulus& law);

/// The Burgers element of E_m [Pa], eta_m [Pa s], E_k [Pa], eta_k [Pa s], all > 0.
CreepCompliance burgers_compliance(double maxwell_modulus, double maxwell_viscosity,
                                   double kelvin_modulus, double kelvin_viscosity);

/// Isotropic law of a uniaxial compliance with a creep Poisson ratio that does not change.
/// \throws std::invalid_argument as `isotropic_shape` and `make_compliance_law`
ComplianceLaw isotropic_law(const CreepCompliance& uniaxial, double poisson_ratio);

/// Uniaxial compliance of a law along a direction, term by term.
CreepCompliance uniaxial(const ComplianceLaw& law, const Vec3& direction);

} // namespace fem
