#pragma once
#include "fem/types.h"

#include <span>
#include <vector>

namespace fem {

/// One retarded part of a compliance, S_k (1 - exp(-t / tau_k)).
struct RetardationTerm {
  double time;     ///< retardation time tau_k [s], > 0
  Mat6 compliance; ///< S_k, Mandel [1/Pa], positive semidefinite
};

/// Creep law of a linear, anisotropic, ageless material,
///
///   S(t) = S_0 + t S_v + sum_k S_k (1 - exp(-t / tau_k)),
///
/// all matrices in Mandel notation. With every matrix symmetric positive semidefinite and S_0
/// positive definite the law is thermodynamically admissible: no load history gains energy from it.
/// Make one with `make_compliance_law`, which checks that.
struct ComplianceLaw {
  Mat6 instantaneous = Mat6::Zero();  ///< S_0 [1/Pa], positive definite
  Mat6 fluidity = Mat6::Zero();       ///< S_v [1/(Pa s)], positive semidefinite; zero in a solid
  std::vector<RetardationTerm> terms; ///< by rising retardation time, all different
};

/// Checked law; terms are sorted by retardation time, and nothing else is changed.
/// \throws std::invalid_argument naming the matrix and its smallest eigenvalue if that is below
///         -1e-12 |S_0| (for S_0 itself: not above 1e-12 |S_0|), a matrix that is not symmetric to
///         1e-12 |S_0| or not finite, or a retardation time that is not positive or occurs twice.
///         S_v is measured as S_v times the longest retardation time (1 s without terms).
ComplianceLaw make_compliance_law(const Mat6& instantaneous, const Mat6& fluidity,
                                  std::span<const RetardationTerm> terms);

/// S(t) [1/Pa], Mandel, t >= 0: strain under a constant unit stress since t = 0.
Mat6 compliance(const ComplianceLaw& law, double t);

/// dS/dt [1/(Pa s)], Mandel, t >= 0.
Mat6 compliance_rate(const ComplianceLaw& law, double t);

/// Complex compliance S* = S' - i S'' [1/Pa], Mandel, at the angular frequency omega [rad/s] > 0.
ComplexMat6 complex_compliance(const ComplianceLaw& law, double omega);

/// Complex stiffness C* = C' + i C'' = (S*)^-1 [Pa], Mandel, at omega [rad/s] > 0.
ComplexMat6 complex_stiffness(const ComplianceLaw& law, double omega);

/// Uniaxial creep compliance D(t) = (n n):S(t):(n n) [1/Pa] along a direction of any length > 0.
/// \throws std::invalid_argument for a direction of length zero
double uniaxial_compliance(const ComplianceLaw& law, const Vec3& direction, double t);

/// The same law times a positive factor (a change of units, or a mean over samples).
ComplianceLaw scaled(ComplianceLaw law, double factor);

/// The law at a temperature of shift factor a_T > 0: every viscosity times a_T, so that
/// S(t) becomes S(t / a_T).
ComplianceLaw with_viscosities_scaled(ComplianceLaw law, double shift_factor);

/// Smallest eigenvalue of a symmetric matrix (the lower triangle is read).
double smallest_eigenvalue(const Mat6& matrix);

/// Positive semidefinite matrix nearest to a symmetric one in Frobenius norm: negative eigenvalues
/// become 0. Basis-free only in Mandel notation.
Mat6 nearest_positive_semidefinite(const Mat6& matrix);

/// Isotropic Mandel compliance per unit of uniaxial compliance [-]: 1 on the diagonal of the
/// normal part, -nu beside it, 1 + nu in shear. Times D(t) it is the law of constant creep Poisson
/// ratio.
/// \throws std::invalid_argument unless -1 < nu < 0.5
Mat6 isotropic_shape(double poisson_ratio);

} // namespace fem
