#pragma once
#include "fem/compliance_law.h"

#include <complex>

namespace fem {

/// Symmetry of a material: which rotations leave it as it is.
enum class SymmetryClass { isotropic, cubic, transversely_isotropic, orthotropic };

/// A symmetry class with its axes in the columns of a rotation; the third is the axis of transverse
/// isotropy. Isotropy needs none.
struct Symmetry {
  SymmetryClass kind = SymmetryClass::isotropic;
  Mat3 axes = Mat3::Identity();
};

/// Axes with the given third one, of any length > 0.
/// \throws std::invalid_argument for a length of zero
Mat3 axes_about(const Vec3& axis);

/// The tensor of a symmetry nearest to a given one in Frobenius norm.
///
/// It is the mean over the rotations of the symmetry (for transverse isotropy five angles suffice,
/// as no harmonic of a fourth-order tensor is above the fourth), so a positive semidefinite tensor
/// stays one.
Mat6 nearest(const Mat6& matrix, const Symmetry& symmetry);

/// |M - nearest(M)| / |M| in Frobenius norm; 0 for a zero matrix.
double distance(const Mat6& matrix, const Symmetry& symmetry);

/// Every matrix of a law replaced by its nearest; an admissible law stays admissible.
ComplianceLaw nearest(const ComplianceLaw& law, const Symmetry& symmetry);

/// Root mean square of the distances of the matrices of a law, relative to the root mean square of
/// their norms; S_v counts as S_v times the longest retardation time (1 s without terms).
double distance(const ComplianceLaw& law, const Symmetry& symmetry);

/// The symmetry of a class whose axes make the distance of a law least: search from a fixed set of
/// starts over the sphere (transverse isotropy) or over the rotations, refined to 1e-7 rad. Axes
/// are determined up to the rotations that the class allows; of an isotropic law any axes are best.
Symmetry best_symmetry(const ComplianceLaw& law, SymmetryClass kind);

/// The same for one matrix.
Symmetry best_symmetry(const Mat6& matrix, SymmetryClass kind);

/// Constants of a compliance read in the axes of a rotation's columns; Scalar is double (at a time)
/// or complex (at a frequency, storage and loss).
template <typename Scalar>
struct EngineeringConstants {
  Eigen::Matrix<Scalar, 3, 1> young;   ///< E_1, E_2, E_3 = 1 / S_ii [Pa]
  Eigen::Matrix<Scalar, 3, 3> poisson; ///< nu_ij = -S_ji / S_ii: contraction along j pulled along i
  Eigen::Matrix<Scalar, 3, 1> shear;   ///< G_23, G_13, G_12 [Pa]
};

/// Creep stiffnesses 1 / S(t) and creep Poisson ratios of S(t).
EngineeringConstants<double> engineering_constants(const Mat6& compliance,
                                                   const Mat3& axes = Mat3::Identity());

/// Complex moduli and Poisson ratios of S*(omega).
EngineeringConstants<std::complex<double>>
engineering_constants(const ComplexMat6& compliance, const Mat3& axes = Mat3::Identity());

} // namespace fem
