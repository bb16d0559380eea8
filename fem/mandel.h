#pragma once
#include "fem/types.h"

/// Mandel notation: order 11, 22, 33, 23, 13, 12, shear entries times sqrt(2). Products, norms,
/// eigenvalues and rotations of 6-vectors and 6x6 matrices are then those of the tensors, which
/// Voigt notation does not give.
namespace fem {

/// Mandel vector of the symmetric part of a second-order tensor.
Vec6 mandel_vector(const Mat3& tensor);

/// The symmetric tensor of a Mandel vector.
Mat3 tensor(const Vec6& mandel);

/// The six components (11, 22, 33, 23, 13, 12) of a tensor, without the factor of Mandel's shears.
/// Of a stress that is Voigt's notation.
Vec6 tensor_components(const Vec6& mandel);

/// Mandel stress from Voigt stress (s11, s22, s33, s23, s13, s12).
Vec6 mandel_stress_from_voigt(const Vec6& stress);

/// Mandel strain from Voigt strain with engineering shear (e11, e22, e33, 2 e23, 2 e13, 2 e12).
Vec6 mandel_strain_from_voigt(const Vec6& strain);

/// Voigt strain with engineering shear from Mandel strain.
Vec6 voigt_strain(const Vec6& strain);

/// Mandel compliance from Voigt compliance (engineering shear) [1/Pa].
Mat6 mandel_compliance_from_voigt(const Mat6& compliance);

/// Voigt compliance (engineering shear) from Mandel compliance [1/Pa].
Mat6 voigt_compliance(const Mat6& compliance);

/// Mandel stiffness from Voigt stiffness (engineering shear) [Pa].
Mat6 mandel_stiffness_from_voigt(const Mat6& stiffness);

/// Voigt stiffness (engineering shear) from Mandel stiffness [Pa].
Mat6 voigt_stiffness(const Mat6& stiffness);

/// Orthogonal 6x6 matrix Q with mandel_vector(R e R^T) = Q mandel_vector(e), for a rotation R.
Mat6 mandel_rotation(const Mat3& rotation);

/// Fourth-order tensor turned with the material by a rotation R: Q M Q^T.
Mat6 rotated(const Mat6& matrix, const Mat3& rotation);

} // namespace fem
