#pragma once
#include "fem/creep_compliance.h"

#include <complex>
#include <variant>

namespace fem {

/// Power-law creep D(t) = D_0 + D_1 t^m.
struct PowerLaw {
  double instantaneous; ///< D_0 [1/Pa], > 0
  double coefficient;   ///< D_1 [1/(Pa s^m)], > 0
  double exponent;      ///< m [-], 0 < m < 1
};

/// Sigmoidal master curve of the dynamic modulus, log10 |E*| = delta + alpha / (1 + exp(beta +
/// gamma log10 f)), with |E*| in Pa and the frequency f in Hz (AASHTO R 84). It has no phase angle
/// of its own: the one given here is the local slope times 90 degrees, a first approximation of the
/// Kramers-Kronig relation (Booij and Thoone, Rheol. Acta 21 (1982) 15).
struct SigmoidalModulus {
  double delta; ///< log10 of the lowest modulus [log10 Pa]
  double alpha; ///< height [-], > 0
  double beta;  ///< [-]
  double gamma; ///< [-], < 0
};

/// 2S2P1D: two springs, two parabolic elements and a dashpot,
///
///   E* = E_00 + (E_0 - E_00) / (1 + delta (i w tau)^-k + (i w tau)^-h + (i w beta tau)^-1).
///
/// Olard and Di Benedetto, Road Mater. Pavement Des. 4 (2003) 185.
struct TwoSpringsTwoParabolasDashpot {
  double static_modulus; ///< E_00 [Pa], > 0
  double glassy_modulus; ///< E_0 [Pa], > E_00
  double delta;          ///< [-], > 0
  double k;              ///< [-], 0 < k < h
  double h;              ///< [-], k < h < 1
  double time;           ///< tau [s], > 0
  double beta;           ///< [-], > 0
};

/// D(t) [1/Pa] at t > 0.
double value(const PowerLaw& law, double t);

/// E* [Pa] at omega [rad/s] > 0: of t^m exactly, by Gamma(1 + m) (i omega)^-m.
std::complex<double> complex_modulus(const PowerLaw& law, double omega);
std::complex<double> complex_modulus(const SigmoidalModulus& law, double omega);
std::complex<double> complex_modulus(const TwoSpringsTwoParabolasDashpot& law, double omega);

/// Creep compliance series that follows a form over a range of times.
struct SeriesApproximation {
  CreepCompliance law;
  double relative_rms; ///< of D(t), or of E* (of |E*| for the sigmoid) at omega = 1/t
};

/// The series of two retardation times a decade nearest to a form from time `first` to `last` [s]:
/// by D(t) for the power law, by E* at omega = 1/t for the other two.
SeriesApproximation creep_series(const PowerLaw& form, double first, double last);
SeriesApproximation creep_series(const SigmoidalModulus& form, double first, double last);
SeriesApproximation creep_series(const TwoSpringsTwoParabolasDashpot& form, double first,
                                 double last);

} // namespace fem
