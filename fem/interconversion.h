#pragma once
#include <Eigen/Core>

#include <vector>

/// Exact conversion between the creep form and the relaxation form of a linear law with discrete
/// spectrum, for symmetric matrices of any size (1x1: a scalar law).
namespace fem {

/// One exponential of a spectrum.
struct MatrixMode {
  double rate;            ///< [1/s], > 0
  Eigen::MatrixXd weight; ///< symmetric positive semidefinite
};

/// S(t) = instantaneous + t fluidity + sum_k weight_k (1 - exp(-rate_k t)).
struct CreepSpectrum {
  Eigen::MatrixXd instantaneous; ///< positive definite [1/Pa]
  Eigen::MatrixXd fluidity;      ///< positive semidefinite [1/(Pa s)]
  std::vector<MatrixMode> modes; ///< [1/Pa]
};

/// C(t) = equilibrium + sum_k weight_k exp(-rate_k t).
struct RelaxationSpectrum {
  Eigen::MatrixXd equilibrium;   ///< positive semidefinite [Pa]
  std::vector<MatrixMode> modes; ///< [Pa]; the sum of all weights is positive definite
};

/// Relaxation form of a creep form.
///
/// The internal variables of the law obey y' = -A y + (drive) with A symmetric positive definite
/// under prescribed strain; its eigenvalues are the relaxation rates and each eigenvector gives a
/// positive semidefinite weight of rank one. A is used as a product F^T F only and F is decomposed
/// by Jacobi rotations, so that rates many decades apart keep their digits. Modes whose rates agree
/// to 1e-9 are one mode (six modes of a proportional law come out as one). Directions in which a
/// weight is less than 1e-13 of its own largest are taken as empty.
RelaxationSpectrum relaxation_spectrum(const CreepSpectrum& creep);

/// Creep form of a relaxation form: the same with prescribed stress. Directions in which the
/// equilibrium stiffness is less than 1e-12 of the instantaneous one flow without end.
CreepSpectrum creep_spectrum(const RelaxationSpectrum& relaxation);

} // namespace fem
