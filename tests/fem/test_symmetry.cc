#include "fem/symmetry.h"

#include "fem/mandel.h"
#include "tests/fem/tables.h"

#include <Eigen/Geometry>

using namespace fem;

namespace {

const std::vector<SymmetryClass> classes{SymmetryClass::isotropic, SymmetryClass::cubic,
                                         SymmetryClass::transversely_isotropic,
                                         SymmetryClass::orthotropic};

Mat3 some_axes()
{
  return Eigen::AngleAxisd(1.1, Vec3(2, 1, -0.5).normalized()).toRotationMatrix();
}

} // namespace

TEST(Symmetry, NearestIsAnOrthogonalProjection)
{
  std::mt19937_64 random(5);
  const Mat6 matrix = tables::random_matrix(random, 1.0);
  for (const SymmetryClass kind : classes) {
    const Symmetry symmetry{kind, some_axes()};
    const Mat6 once = nearest(matrix, symmetry);
    EXPECT_LE(tables::difference(nearest(once, symmetry), once), 1e-14);
    EXPECT_NEAR(once.cwiseProduct(matrix - once).sum(), 0, 1e-13 * matrix.squaredNorm());
    EXPECT_GE(smallest_eigenvalue(once), smallest_eigenvalue(matrix) - 1e-14);
    EXPECT_LE(distance(once, symmetry), 1e-14);
  }
}

TEST(Symmetry, LessSymmetryIsNearer)
{
  std::mt19937_64 random(6);
  const Mat6 matrix = tables::random_matrix(random, 1.0);
  double before = 1;
  for (const SymmetryClass kind : {SymmetryClass::isotropic, SymmetryClass::transversely_isotropic,
                                   SymmetryClass::orthotropic}) {
    const double found = distance(matrix, {kind, some_axes()});
    EXPECT_LT(found, before);
    before = found;
  }
}

TEST(Symmetry, TransverseIsotropyHoldsForAnyAngle)
{
  std::mt19937_64 random(8);
  const Vec3 axis(1, 2, 2);
  const Mat6 found = nearest(tables::random_matrix(random, 1.0),
                             {SymmetryClass::transversely_isotropic, axes_about(axis)});
  for (const double angle : {0.1, 1.0, 2.7}) {
    const Mat3 turn = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
    EXPECT_LE(tables::difference(rotated(found, turn), found), 1e-14);
  }
}

TEST(Symmetry, BestAxesAreFound)
{
  std::mt19937_64 random(9);
  for (const SymmetryClass kind :
       {SymmetryClass::cubic, SymmetryClass::transversely_isotropic, SymmetryClass::orthotropic}) {
    const Mat6 hidden = nearest(tables::random_matrix(random, 1.0), {kind, some_axes()});
    const Symmetry found = best_symmetry(hidden, kind);
    EXPECT_LE(distance(hidden, found), 1e-7) << int(kind);
  }
}

TEST(Symmetry, LawIsProjectedMatrixByMatrix)
{
  const ComplianceLaw law = tables::anisotropic_law();
  const Symmetry symmetry = best_symmetry(law, SymmetryClass::transversely_isotropic);
  const ComplianceLaw found = nearest(law, symmetry);
  EXPECT_NO_THROW(make_compliance_law(found.instantaneous, found.fluidity, found.terms));
  EXPECT_LE(tables::difference(compliance(found, 9.0), nearest(compliance(law, 9.0), symmetry)),
            1e-14);
  EXPECT_GT(distance(law, symmetry), 0.01);
  EXPECT_LT(distance(law, symmetry), distance(law, {SymmetryClass::isotropic, Mat3::Identity()}));
}

TEST(Symmetry, EngineeringConstantsOfAnIsotropicMaterial)
{
  const Mat6 compliance = isotropic_shape(0.3) / 7e9;
  const auto found = engineering_constants(compliance, some_axes());
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.young[i] / 7e9, 1, 1e-14);
    EXPECT_NEAR(found.shear[i] / (7e9 / 2.6), 1, 1e-14);
  }
  EXPECT_NEAR(found.poisson(0, 2), 0.3, 1e-14);
  const ComplexMat6 lossy = std::complex<double>(1, -0.5) * compliance.cast<std::complex<double>>();
  EXPECT_NEAR(std::arg(engineering_constants(lossy).young[1]), std::atan(0.5), 1e-14);
}
