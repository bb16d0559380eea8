#pragma once
#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dem {

/// Spring and dashpot side by side.
struct KelvinBranch {
  double stiffness; ///< K_k [N/m], >= 0
  double viscosity; ///< C_k [N s/m], > 0
};

/// Retardation time tau_k = C_k / K_k [s]; infinite for a branch without a spring.
double retardation_time(const KelvinBranch& branch);

/// Creep law of a bond in its normal mode: a spring, an optional dashpot and any number of Kelvin
/// branches in series. One branch and a dashpot make the Burgers element.
///
/// The other five modes of a bond share the law up to a factor. Make one with `make_creep_law` or
/// `burgers`, which check the numbers and take limits (a branch of zero viscosity is a spring).
struct CreepLaw {
  double maxwell_stiffness = 0;            ///< K_m [N/m], > 0
  std::optional<double> maxwell_viscosity; ///< C_m [N s/m], > 0; absent in a solid
  std::vector<KelvinBranch> branches;      ///< sorted by retardation time
};

/// Checked law. Branches of equal retardation time are merged; a branch of zero viscosity joins the
/// spring, one without stiffness joins the dashpot, one of infinite stiffness or viscosity leaves.
/// \throws std::invalid_argument naming the constant that is not a number, negative or zero
CreepLaw make_creep_law(double maxwell_stiffness, std::optional<double> maxwell_viscosity,
                        std::span<const KelvinBranch> branches);

/// The Burgers element K_m [N/m], C_m [N s/m], K_k [N/m], C_k [N s/m]; infinite values are limits.
CreepLaw burgers(double maxwell_stiffness, double maxwell_viscosity, double kelvin_stiffness,
                 double kelvin_viscosity);

/// J(t) [m/N]: displacement under a unit force applied at t = 0.
double creep_compliance(const CreepLaw& law, double t);

/// dJ/dt [m/(N s)] for t > 0.
double creep_compliance_rate(const CreepLaw& law, double t);

/// Mean of J from begin to begin + length [m/N]: displacement after a force that grew evenly by 1
/// N, for a time `length` that ended `begin` ago. No digits are lost however short the growth was.
double mean_creep_compliance(const CreepLaw& law, double begin, double length);

/// Integral of J from 0 to t [m s/N]: displacement under a force that grows by 1 N/s.
double creep_compliance_integral(const CreepLaw& law, double t);

/// J* = J' - i J'' [m/N] at the angular frequency omega [rad/s], > 0.
std::complex<double> complex_compliance(const CreepLaw& law, double omega);

/// One exponential of the relaxation function.
struct RelaxationMode {
  double rate;      ///< r [1/s]; 0 for the part that never relaxes
  double stiffness; ///< g [N/m], >= 0
};

/// Spectrum of the relaxation function R(t) = sum_i g_i exp(-r_i t): the same law driven by
/// displacement. One mode more than branches; rates interlace the retardation rates.
///
/// The rates are the roots of a secular equation whose terms are all of one sign on each side of a
/// pole; each is found as its distance from the nearest pole, so that stiffness ratios of 1e8 and
/// near-coincident rates keep 1e-14 relative accuracy. (The textbook quadratic returns 0 there.)
std::vector<RelaxationMode> relaxation_spectrum(const CreepLaw& law);

/// R(t) [N/m]: force after a unit displacement applied at t = 0.
double relaxation(std::span<const RelaxationMode> spectrum, double t);

/// Mean of R from begin to begin + length [N/m]: force after a displacement that grew evenly by 1
/// m.
double mean_relaxation(std::span<const RelaxationMode> spectrum, double begin, double length);

/// Integral of R from 0 to t [N s/m]: force while the displacement grows by 1 m/s.
double relaxation_integral(std::span<const RelaxationMode> spectrum, double t);

/// The law with every viscosity multiplied by a factor > 0: the effect of temperature (shift
/// factor) and of viscosity scaling.
CreepLaw with_viscosities_scaled(CreepLaw law, double factor);

/// The law with every stiffness and viscosity multiplied by a factor > 0: the same function of
/// time, another size.
CreepLaw scaled(CreepLaw law, double factor);

/// If `other` is `law` times a constant (to 1e-12 relative in every entry), that constant.
std::optional<double> proportionality(const CreepLaw& law, const CreepLaw& other);

} // namespace dem
