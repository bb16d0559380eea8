#pragma once
#include "fem/creep_compliance.h"

/// What discrete models and continua exchange: laws extracted from packings, and laws for other
/// programs. Units inside are SI; tension is positive.
namespace coupling {

/// Creep of an isotropic material: J(t) = 1/G(t) in shear and B(t) = 1/K(t) in volume, both as
/// responses to a constant stress.
struct IsotropicCreep {
  fem::CreepCompliance shear; ///< J(t), engineering shear strain per shear stress [1/Pa]
  fem::CreepCompliance bulk;  ///< B(t), volume strain per mean stress [1/Pa]
};

/// Relaxation of an isotropic material.
struct IsotropicRelaxation {
  fem::RelaxationModulus shear; ///< G(t) [Pa]
  fem::RelaxationModulus bulk;  ///< K(t) [Pa]
};

/// J(t) and B(t) of the isotropic law nearest to a law (see fem/symmetry.h). Terms of less than
/// 1e-13 of the instantaneous compliance are left out.
IsotropicCreep isotropic_creep(const fem::ComplianceLaw& law);

/// The tensor law of J(t) and B(t). Retardation times of the two that agree to 1e-12 are one.
fem::ComplianceLaw compliance_law(const IsotropicCreep& creep);

/// G(t) and K(t), exact to rounding. Shear and volume have relaxation times of their own, even
/// where their retardation times are the same.
IsotropicRelaxation isotropic_relaxation(const IsotropicCreep& creep);

/// J(t) and B(t), exact to rounding.
IsotropicCreep isotropic_creep(const IsotropicRelaxation& relaxation);

/// One line of a Prony series.
struct PronyTerm {
  double time;  ///< relaxation time [s]
  double shear; ///< g_i = G_i / G(0) [-]
  double bulk;  ///< k_i = K_i / K(0) [-]
};

/// G(t) = G_0 (1 - sum of g_i (1 - exp(-t / rho_i))), the same for K(t).
struct PronySeries {
  double shear_modulus = 0; ///< G_0 [Pa]
  double bulk_modulus = 0;  ///< K_0 [Pa]
  std::vector<PronyTerm> terms;
};

/// Prony series in which neither modulus relaxes to zero, as finite-element programs ask for: where
/// a modulus has no long-term part, all its terms are made smaller so that the part
/// 1e-4 / (G_0 J(last_time)) of it stays, between 1e-10 and 1e-3. At `last_time` that stiffens the
/// response by about half of 1e-4.
PronySeries prony_series(const IsotropicRelaxation& relaxation, double last_time);

/// G(t) and K(t) of a Prony series.
IsotropicRelaxation isotropic_relaxation(const PronySeries& series);

} // namespace coupling
