#include "fem/interconversion.h"

#include "fem/relaxation_law.h"
#include "tests/fem/tables.h"

#include <Eigen/LU>

#include <chrono>

using namespace fem;

namespace {

CreepSpectrum scalar_spectrum()
{
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  return {one(1e-8),
          one(2e-12),
          {{1 / 0.1, one(3e-9)}, {1 / 3.0, one(8e-9)}, {1 / 40.0, one(2e-8)}, {5e-4, one(5e-8)}}};
}

/// A law of random matrices, two terms a decade from 1e-4 s on, the fluidity of the given rank.
ComplianceLaw random_law(std::uint64_t seed, int n_terms, int flow_rank)
{
  std::mt19937_64 random(seed);
  std::vector<RetardationTerm> terms;
  for (int k = 0; k < n_terms; ++k)
    terms.push_back({1e-4 * std::pow(10, 0.5 * k),
                     tables::random_matrix(random, 1e-9 * std::pow(1.4, k), k % 3 == 1 ? 2 : 6)});
  const Mat6 fluidity = flow_rank == 0
                            ? Mat6(Mat6::Zero())
                            : tables::random_matrix(random, 1e-10 / terms.back().time, flow_rank);
  return make_compliance_law(tables::random_matrix(random, 1e-10), fluidity, terms);
}

double smallest_of(const RelaxationLaw& law)
{
  double least = smallest_eigenvalue(law.equilibrium);
  for (const auto& term : law.terms)
    least = std::min(least, smallest_eigenvalue(term.stiffness));
  return least;
}

} // namespace

TEST(Interconversion, ScalarSpectrumIsThatOfTheTable)
{
  const RelaxationSpectrum found = relaxation_spectrum(scalar_spectrum());
  const auto rows = reference::table("prony_interconversion.csv");
  ASSERT_EQ(found.modes.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(found.modes[i].rate / reference::number(rows[i], "relaxation_rate"), 1, 1e-11);
    EXPECT_NEAR(found.modes[i].weight(0, 0) / reference::number(rows[i], "relaxation_modulus"), 1,
                1e-11);
  }
  EXPECT_EQ(found.equilibrium(0, 0), 0);
}

TEST(Interconversion, ScalarSpectrumComesBack)
{
  const CreepSpectrum law = scalar_spectrum();
  const CreepSpectrum back = creep_spectrum(relaxation_spectrum(law));
  EXPECT_NEAR(back.instantaneous(0, 0) / 1e-8, 1, 1e-13);
  EXPECT_NEAR(back.fluidity(0, 0) / 2e-12, 1, 1e-12);
  ASSERT_EQ(back.modes.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(back.modes[k].rate / law.modes[3 - k].rate, 1, 1e-11);
    EXPECT_NEAR(back.modes[k].weight(0, 0) / law.modes[3 - k].weight(0, 0), 1, 1e-11);
  }
}

TEST(Interconversion, TensorRelaxationIsThatOfTheTable)
{
  const RelaxationLaw law = relaxation_law(tables::anisotropic_law());
  EXPECT_GE(smallest_of(law), -1e-12 * stiffness(law, 0).norm());
  for (const auto& row : reference::table("tensor_relaxation.csv")) {
    const Mat6 found = voigt_stiffness(stiffness(law, reference::number(row, "t")));
    const int i = std::stoi(row.at("i")) - 1, j = std::stoi(row.at("j")) - 1;
    EXPECT_NEAR(found(i, j), reference::number(row, "C_ij"), 1e-9 * found.norm())
        << row.at("t") << " " << i << j;
  }
}

TEST(Interconversion, CreepComesBackFromRelaxation)
{
  for (const int flow_rank : {0, 2, 6}) {
    const ComplianceLaw law = random_law(7, 6, flow_rank);
    const RelaxationLaw relaxation = relaxation_law(law);
    EXPECT_GE(smallest_of(relaxation), -1e-12 * stiffness(relaxation, 0).norm());
    const ComplianceLaw back = compliance_law(relaxation);
    ASSERT_EQ(back.terms.size(), law.terms.size()) << "flow of rank " << flow_rank;
    EXPECT_LE(tables::difference(back.instantaneous, law.instantaneous), 1e-10);
    EXPECT_LE((back.fluidity - law.fluidity).norm(), 1e-9 * law.fluidity.norm());
    for (std::size_t k = 0; k < law.terms.size(); ++k) {
      EXPECT_NEAR(back.terms[k].time / law.terms[k].time, 1, 1e-9);
      EXPECT_LE(tables::difference(back.terms[k].compliance, law.terms[k].compliance), 1e-8);
    }
    for (double t = 1e-5; t < 1e3; t *= 10)
      EXPECT_LE(tables::difference(compliance(back, t), compliance(law, t)), 1e-9) << t;
  }
}

TEST(Interconversion, BothFormsHaveTheSameComplexStiffness)
{
  const ComplianceLaw law = random_law(3, 13, 6);
  const auto start = std::chrono::steady_clock::now();
  const RelaxationLaw relaxation = relaxation_law(law);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  EXPECT_LE(spent.count(), 2.0);
  for (double omega = 1e-4; omega < 1e6; omega *= 10) {
    const ComplexMat6 direct = complex_stiffness(law, omega);
    EXPECT_LE((complex_stiffness(relaxation, omega) - direct).norm(), 1e-10 * direct.norm())
        << omega;
  }
}

TEST(Interconversion, ProportionalLawRelaxesInAsManyModes)
{
  const Mat6 shape = isotropic_shape(0.35);
  const std::vector<RetardationTerm> terms{
      {1.0, 1e-9 * shape}, {1.01, 1e-9 * shape}, {50.0, 4e-9 * shape}};
  const RelaxationLaw fluid =
      relaxation_law(make_compliance_law(1e-9 * shape, 1e-12 * shape, terms));
  EXPECT_EQ(fluid.terms.size(), 4U);
  EXPECT_EQ(fluid.equilibrium.norm(), 0);
  const RelaxationLaw solid =
      relaxation_law(make_compliance_law(1e-9 * shape, Mat6::Zero(), terms));
  EXPECT_EQ(solid.terms.size(), 3U);
  EXPECT_LE(tables::difference(solid.equilibrium, (7e-9 * shape).inverse()), 1e-13);
  const ComplianceLaw elastic =
      compliance_law(relaxation_law(make_compliance_law(1e-9 * shape, Mat6::Zero(), {})));
  EXPECT_TRUE(elastic.terms.empty());
  EXPECT_LE(tables::difference(elastic.instantaneous, 1e-9 * shape), 1e-14);
}

TEST(Interconversion, RelaxationLawIsChecked)
{
  const std::vector<RelaxationTerm> good{{1.0, Mat6::Identity()}};
  EXPECT_NO_THROW(make_relaxation_law(Mat6::Zero(), good));
  const std::vector<RelaxationTerm> bad{{1.0, -Mat6::Identity()}};
  EXPECT_THROW(make_relaxation_law(2 * Mat6::Identity(), bad), std::invalid_argument);
}
