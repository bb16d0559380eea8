#pragma once
#include "dem/homogenization.h"

#include <complex>
#include <span>
#include <vector>

namespace dem {

using ComplexMat6 = Eigen::Matrix<std::complex<double>, 6, 6>;

/// C*(omega) = C' + i C'' [Pa] of a periodic volume element at angular frequencies [rad/s].
struct FrequencyResponse {
  std::vector<double> omega;          ///< [rad/s]
  std::vector<ComplexMat6> stiffness; ///< [Pa], Mandel notation
  std::vector<double> error;          ///< estimated, relative, of the stiffness at each frequency
  int basis_size = 0;                 ///< motions in which all frequencies were solved
};

/// Steady oscillation of a network with any laws.
///
/// The network is sum_g kappa_g(omega) K_g over groups g of proportional laws, with kappa the
/// complex stiffness over the elastic one. All frequencies are solved in one common basis of
/// motions (Galerkin). At each one the forces R out of balance in the full network are measured
/// with the factorised elastic network K_r of the real stiffnesses |kappa|: as loads and measured
/// stresses are the same functionals, the error of C* times the volume is R^T K^-1 R, which
/// Z = K_r^-1 R estimates as R^H Z, at most 1.42 times too small. While this, relative to C* in
/// every direction, exceeds the tolerance, the basis takes in Z. The phases of the kappa lie
/// between 0 and 90 degrees, so each Z reduces the residual of its frequency at least 2.4 times,
/// mostly 5 to 10 times, and those of near frequencies too. The measure is one of energy: soft
/// bonds between stiff ones count as they do for the result. \param tolerance  relative, of C*;
/// below 1e-13 it cannot be met \throws std::invalid_argument for a cut element, a frequency or a
/// tolerance that is not > 0
FrequencyResponse frequency_response(const VolumeElement& element, std::span<const double> omega,
                                     double tolerance = 1e-9);

/// S* = (C*)^-1 = S' - i S'' [1/Pa].
ComplexMat6 complex_compliance(const ComplexMat6& stiffness);

} // namespace dem
