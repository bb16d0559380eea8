#include "fem/compliance_law.h"

#include "fem/mandel.h"
#include "tests/fem/tables.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

using namespace fem;

namespace {

Mat3 some_rotation()
{
  return Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
}

std::string refusal(const Mat6& instantaneous, const Mat6& fluidity,
                    const std::vector<RetardationTerm>& terms)
{
  try {
    make_compliance_law(instantaneous, fluidity, terms);
  } catch (const std::invalid_argument& problem) {
    return problem.what();
  }
  return "accepted";
}

} // namespace

TEST(Mandel, VectorsAndMatricesKeepProductsAndNorms)
{
  std::mt19937_64 random(1);
  const Mat6 m = tables::random_matrix(random, 1.0);
  const Mat3 a = tensor(m.col(0)), b = tensor(m.col(1));
  EXPECT_NEAR((a * b).trace(), m.col(0).dot(m.col(1)), 1e-14);
  EXPECT_NEAR((mandel_vector(a) - m.col(0)).norm(), 0, 1e-15);
  const Mat3 r = some_rotation();
  EXPECT_NEAR((mandel_rotation(r) * m.col(0) - mandel_vector(r * a * r.transpose())).norm(), 0,
              1e-14);
  EXPECT_NEAR((mandel_rotation(r) * mandel_rotation(r).transpose() - Mat6::Identity()).norm(), 0,
              1e-14);
}

TEST(Mandel, VoigtComplianceAndStiffnessAreInverseToOneAnother)
{
  std::mt19937_64 random(2);
  const Mat6 compliance = tables::random_matrix(random, 1.0);
  const Vec6 stress = tables::random_matrix(random, 1.0).col(2);
  const Mat6 voigt = voigt_compliance(compliance);
  EXPECT_NEAR((voigt_strain(compliance * stress) - voigt * tensor_components(stress)).norm(), 0,
              1e-13);
  EXPECT_NEAR((voigt * voigt_stiffness(compliance.inverse()) - Mat6::Identity()).norm(), 0, 1e-12);
  EXPECT_NEAR((mandel_compliance_from_voigt(voigt) - compliance).norm(), 0, 1e-14);
  EXPECT_NEAR((mandel_stiffness_from_voigt(voigt_stiffness(compliance)) - compliance).norm(), 0,
              1e-14);
  EXPECT_NEAR((mandel_stress_from_voigt(tensor_components(stress)) - stress).norm(), 0, 1e-15);
  EXPECT_NEAR((mandel_strain_from_voigt(voigt_strain(stress)) - stress).norm(), 0, 1e-15);
}

TEST(ComplianceLaw, RefusesWhatIsNotAdmissible)
{
  const auto cases = reference::json("admissibility_cases.json");
  const auto mandel = [&](const char* name) {
    return mandel_compliance_from_voigt(tables::matrix(cases.at(name)));
  };
  const Mat6 good = mandel("accept"), zero = Mat6::Zero();
  EXPECT_EQ(refusal(good, zero, {{1.0, good}}), "accepted");
  EXPECT_EQ(refusal(good, zero, {{3.0, mandel("reject_indefinite")}}),
            "compliance law: the compliance of the retardation time 3 s is not positive "
            "semidefinite: its smallest eigenvalue is -1e-09");
  EXPECT_NE(refusal(mandel("reject_indefinite"), zero, {}).find("eigenvalue is -1e-09"),
            std::string::npos);
  EXPECT_NE(refusal(good, mandel("reject_indefinite"), {}).find("the fluidity is not positive"),
            std::string::npos);
  EXPECT_NE(refusal(good, zero, {{3.0, mandel("reject_asymmetric")}}).find("is not symmetric"),
            std::string::npos);
  EXPECT_NE(refusal(zero, zero, {}).find("positive definite"), std::string::npos);
  EXPECT_NE(refusal(good, zero, {{0.0, good}}).find("found 0"), std::string::npos);
  EXPECT_NE(refusal(good, zero, {{2.0, good}, {2.0, good}}).find("occurs twice"),
            std::string::npos);
  Mat6 bad = good;
  bad(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(bad, zero, {}).find("finite"), std::string::npos);
}

TEST(ComplianceLaw, ProjectionIsTheNearestSemidefiniteMatrix)
{
  const auto cases = reference::json("admissibility_cases.json");
  const Mat6 found = nearest_positive_semidefinite(tables::matrix(cases.at("reject_indefinite")));
  EXPECT_LE(tables::difference(found, tables::matrix(cases.at("nearest_psd"))), 1e-12);
}

TEST(ComplianceLaw, RateIsTheDerivative)
{
  const ComplianceLaw law = tables::anisotropic_law();
  for (const double t : {0.1, 4.0, 700.0}) {
    const double h = 1e-4 * t;
    const Mat6 slope = (compliance(law, t + h) - compliance(law, t - h)) / (2 * h);
    EXPECT_LE(tables::difference(slope, compliance_rate(law, t)), 1e-7);
  }
  EXPECT_EQ(compliance(law, 0), law.instantaneous);
}

TEST(ComplianceLaw, ComplexComplianceMeetsItsLimitsAndInverse)
{
  const ComplianceLaw law = tables::anisotropic_law();
  EXPECT_LE(tables::difference(complex_compliance(law, 1e9).real(), law.instantaneous), 1e-12);
  const double slow = 1e-9;
  EXPECT_LE(tables::difference(-slow * complex_compliance(law, slow).imag(), law.fluidity), 1e-10);
  const ComplexMat6 one = complex_compliance(law, 0.3) * complex_stiffness(law, 0.3);
  EXPECT_NEAR((one - ComplexMat6::Identity()).norm(), 0, 1e-12);
}

TEST(ComplianceLaw, UniaxialComplianceFollowsTheMaterial)
{
  const ComplianceLaw law = tables::anisotropic_law();
  EXPECT_DOUBLE_EQ(uniaxial_compliance(law, {2, 0, 0}, 7.0), compliance(law, 7.0)(0, 0));
  ComplianceLaw turned = law;
  const Mat3 r = some_rotation();
  turned.instantaneous = rotated(law.instantaneous, r);
  turned.fluidity = rotated(law.fluidity, r);
  for (RetardationTerm& term : turned.terms)
    term.compliance = rotated(term.compliance, r);
  const Vec3 n(0.2, -1, 0.4);
  EXPECT_NEAR(uniaxial_compliance(turned, r * n, 7.0) / uniaxial_compliance(law, n, 7.0), 1, 1e-13);
  EXPECT_THROW(uniaxial_compliance(law, {0, 0, 0}, 1.0), std::invalid_argument);
}

TEST(ComplianceLaw, ShiftFactorStretchesTime)
{
  const ComplianceLaw law = tables::anisotropic_law();
  EXPECT_LE(tables::difference(compliance(with_viscosities_scaled(law, 7.0), 70.0),
                               compliance(law, 10.0)),
            1e-14);
}

TEST(ComplianceLaw, DoesNotDependOnTheUnits)
{
  const ComplianceLaw law = tables::anisotropic_law();
  ComplianceLaw other = scaled(law, 1e6); // 1/MPa and minutes
  other = with_viscosities_scaled(other, 1 / 60.0);
  EXPECT_LE(tables::difference(compliance(other, 5.0), 1e6 * compliance(law, 300.0)), 1e-14);
}

TEST(ComplianceLaw, IsotropicShapeHasItsPoissonRatio)
{
  const Mat6 shape = isotropic_shape(0.3);
  EXPECT_DOUBLE_EQ(shape(0, 0), 1);
  EXPECT_DOUBLE_EQ(shape(1, 0), -0.3);
  EXPECT_DOUBLE_EQ(shape(3, 3), 1.3); // 2 (1 + nu) in Voigt notation
  EXPECT_THROW(isotropic_shape(0.5), std::invalid_argument);
}
