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
  std::vector<double> residual; ///< nodal forces out of balance over the load, at each frequency
  int n_factorisations = 0;
  int basis_size = 0; ///< motions in which all frequencies were solved
};

/// Steady oscillation of a network with any laws.
///
/// The network is sum_g kappa_g(omega) K_g over groups g of proportional laws, with kappa the
/// complex stiffness over the elastic one. All frequencies are solved in one common basis of
/// motions (Galerkin), and the basis grows until the forces out of balance at every frequency, in
/// the full network, are below the tolerance: it takes in the elastic solution, with the real
/// stiffnesses |kappa|, under what is out of balance. As loads and measured stresses are the same
/// functionals, the error of C* is of the order of the tolerance squared. The phases of the kappa
/// lie between 0 and 90 degrees, so each elastic solution reduces the residual of its frequency at
/// least 2.4 times, mostly 5 to 10 times, and those of near frequencies too.
/// \throws std::invalid_argument for a cut element, a frequency or a tolerance that is not > 0
FrequencyResponse frequency_response(const VolumeElement& element, std::span<const double> omega,
                                     double tolerance = 1e-6);

/// S* = (C*)^-1 = S' - i S'' [1/Pa].
ComplexMat6 complex_compliance(const ComplexMat6& stiffness);

} // namespace dem
