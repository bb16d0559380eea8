#include "fem/law_points.h"

#include "fem/mandel.h"
#include "fem/relaxation_law.h"
#include "tests/fem/bodies.h"
#include "tests/fem/tables.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

using namespace fem;

namespace {

constexpr TimeScheme creep = TimeScheme::stress_linear, relaxation = TimeScheme::strain_linear;

/// One point without a body, led through strains or through stresses.
struct Point {
  LawPoints states;
  double estimate = 0; ///< of the error of the last step: of strains, or of stresses

  Point(const ComplianceLaw& law, TimeScheme scheme) : states(std::span(&law, 1), {0}, scheme) {}

  const Vec6& stress() const { return states.stress()[0]; }
  const Vec6& strain() const { return states.strain()[0]; }

  Vec6 try_strain(const Vec6& end, double h)
  {
    const Vec6 increment = end - strain();
    return states.evaluate(std::span(&increment, 1), h).stress[0];
  }

  void to_strain(const Vec6& end, double h)
  {
    try_strain(end, h);
    const double weight = 1;
    estimate = std::sqrt(states.step_error(std::span(&weight, 1)).square);
    states.commit();
  }

  void to_stress(const Vec6& end, double h)
  {
    const Vec6 still = try_strain(strain(), h);
    const Mat6 tangent = states.evaluate(std::vector<Vec6>(1, Vec6::Zero()), h).tangent[0];
    to_strain(strain() + tangent.llt().solve(end - still), h);
  }

  std::vector<double> numbers() const
  {
    std::vector<double> result(states.numbers_per_point());
    states.store(0, result);
    return result;
  }
};

const Vec6 pulled = (Vec6() << 0, 0, 1, 0, 0, 0).finished();
const Vec6 skew = (Vec6() << 0.3, -0.2, 1, 0.5, -0.4, 0.1).finished();

Vec6 unit(int k)
{
  return Vec6::Unit(k);
}

/// int S(t') dt' from 0 to t.
Mat6 compliance_integral(const ComplianceLaw& law, double t)
{
  Mat6 sum = t * law.instantaneous + t * t / 2 * law.fluidity;
  for (const RetardationTerm& term : law.terms)
    sum += term.compliance * (t + term.time * std::expm1(-t / term.time));
  return sum;
}

Mat6 stiffness_integral(const RelaxationLaw& law, double t)
{
  Mat6 sum = t * law.equilibrium;
  for (const RelaxationTerm& term : law.terms)
    sum += -term.stiffness * term.time * std::expm1(-t / term.time);
  return sum;
}

} // namespace

TEST(MaterialPoint, BarCreepsAsTheTable)
{
  const double stress = 2e6;
  Point point(bodies::burgers_in_shear(), creep);
  double t = 0;
  for (const auto& row : reference::table("bar_uniaxial_creep.csv")) {
    const double end = reference::number(row, "t");
    point.to_stress(stress * pulled, end - t);
    t = end;
    const double axial = stress * reference::number(row, "axial_strain_per_stress");
    const double lateral = stress * reference::number(row, "lateral_strain_per_stress");
    EXPECT_NEAR(point.strain()[2], axial, 1e-12 * axial) << t;
    EXPECT_NEAR(point.strain()[0], lateral, 1e-12 * axial) << t;
  }
}

TEST(MaterialPoint, OedometerRelaxesAsTheTable)
{
  const double strain = -1e-3;
  Point point(bodies::burgers_in_shear(), relaxation);
  double t = 0;
  for (const auto& row : reference::table("oedometer_relaxation.csv")) {
    const double end = reference::number(row, "t");
    point.to_strain(strain * pulled, end - t);
    t = end;
    const double axial = strain * reference::number(row, "axial_stress_per_strain");
    const double lateral = strain * reference::number(row, "lateral_stress_per_strain");
    EXPECT_NEAR(point.stress()[2] / axial, 1, 1e-12) << t;
    EXPECT_NEAR(point.stress()[1] / lateral, 1, 1e-12) << t;
  }
}

TEST(MaterialPoint, AnisotropicLawRelaxesAndCreepsAsTheTables)
{
  const ComplianceLaw law = tables::anisotropic_law();
  std::map<double, Mat6> voigt;
  for (const auto& row : reference::table("tensor_relaxation.csv")) {
    const int i = int(reference::number(row, "i")) - 1, j = int(reference::number(row, "j")) - 1;
    Mat6& c = voigt[reference::number(row, "t")];
    c(i, j) = c(j, i) = reference::number(row, "C_ij");
  }
  ASSERT_GE(voigt.size(), 4U);
  const double size = stiffness(relaxation_law(law), 0).norm();
  for (int k = 0; k < 6; ++k) {
    Point held(law, relaxation), loaded(law, creep);
    const Vec6 strain = mandel_strain_from_voigt(unit(k));
    held.to_strain(strain, 0);
    loaded.to_stress(1e6 * unit(k), 0);
    double t = 0;
    for (const auto& [end, stiffness] : voigt) {
      held.to_strain(strain, end - t);
      loaded.to_stress(1e6 * unit(k), end - t);
      t = end;
      EXPECT_LE((tensor_components(held.stress()) - stiffness.col(k)).norm(), 1e-12 * size)
          << t << " s, direction " << k;
      const Vec6 exact = 1e6 * compliance(law, t).col(k);
      EXPECT_LE((loaded.strain() - exact).norm(), 1e-12 * exact.norm()) << t;
    }
  }
}

TEST(MaterialPoint, RampsAreExactForAnySteps)
{
  const ComplianceLaw law = tables::anisotropic_law();
  const RelaxationLaw relaxing = relaxation_law(law);
  Point loaded(law, creep), strained(law, relaxation);
  double t = 0;
  for (const double h : {0.01, 40., 3., 1e-5, 700., 20.}) {
    t += h;
    loaded.to_stress(1e3 * t * skew, h);
    strained.to_strain(1e-5 * t * skew, h);
    const Vec6 strain = 1e3 * compliance_integral(law, t) * skew;
    const Vec6 stress = 1e-5 * stiffness_integral(relaxing, t) * skew;
    EXPECT_LE((loaded.strain() - strain).norm(), 1e-12 * strain.norm()) << t;
    EXPECT_LE((strained.stress() - stress).norm(), 1e-12 * stress.norm()) << t;
  }
}

TEST(MaterialPoint, OtherHistoriesConvergeWithSecondOrder)
{
  const ComplianceLaw law = tables::anisotropic_law();
  const double end = 60;
  const Vec6 strain = compliance(law, end) * skew;
  const Vec6 stress = stiffness(relaxation_law(law), end) * skew;
  std::vector<double> of_creep, of_relaxation;
  for (const int n : {32, 64, 128}) {
    Point crept(law, relaxation), relaxed(law, creep);
    crept.to_stress(skew, 0);
    relaxed.to_strain(skew, 0);
    for (int k = 0; k < n; ++k) {
      crept.to_stress(skew, end / n);
      relaxed.to_strain(skew, end / n);
    }
    of_creep.push_back((crept.strain() - strain).norm() / strain.norm());
    of_relaxation.push_back((relaxed.stress() - stress).norm() / stress.norm());
  }
  for (const auto& error : {of_creep, of_relaxation}) {
    EXPECT_GT(error[0], 1e-7);
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.05);
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.02);
  }
}

TEST(MaterialPoint, TangentsOfAScalarLawAreThoseOfTheTableFrom1em12To1e12)
{
  const auto sets = reference::json("burgers_sets.json");
  for (const auto& row : reference::table("algorithmic_stiffness.csv")) {
    const auto& set = sets.at(row.at("set"));
    const auto number = [&](const char* name) { return reference::number(set.at(name)); };
    const Mat6 one = Mat6::Identity();
    const RetardationTerm kelvin{number("Ck") / number("Kk"), one / number("Kk")};
    const ComplianceLaw law =
        make_compliance_law(one / number("Km"), one / number("Cm"), std::span(&kelvin, 1));
    const double h = reference::number(row, "h");
    const Mat6 linear_stress = step_operator(steppable_law(law, creep), h).tangent;
    const Mat6 linear_strain = step_operator(steppable_law(law, relaxation), h).tangent;
    EXPECT_NEAR(linear_stress(2, 2) / reference::number(row, "K_Jlin"), 1, 1e-13) << h;
    EXPECT_NEAR(linear_strain(2, 2) / reference::number(row, "K_Glin"), 1, 1e-12) << h;
  }
}

TEST(MaterialPoint, StepsOfAnySizeFollowOneAnother)
{
  const ComplianceLaw law = tables::anisotropic_law();
  const RelaxationLaw relaxing = relaxation_law(law);
  const double tau = 5;
  for (const bool rising : {true, false}) {
    Point loaded(law, creep), held(law, relaxation);
    loaded.to_stress(skew, 0);
    held.to_strain(skew, 0);
    double t = 0, before = held.stress().norm();
    for (int k = -12; k <= 12; ++k) {
      const double h = tau * std::pow(10., rising ? k : -k);
      t += h;
      loaded.to_stress(skew, h);
      held.to_strain(skew, h);
      const Vec6 strain = compliance(law, t) * skew;
      EXPECT_LE((loaded.strain() - strain).norm(), 1e-12 * strain.norm()) << h;
      const Vec6 stress = stiffness(relaxing, t) * skew;
      EXPECT_LE((held.stress() - stress).norm(), 1e-12 * stiffness(relaxing, 0).norm()) << h;
      EXPECT_LE(held.stress().norm(), before + 1e-12 * stiffness(relaxing, 0).norm()) << h;
      before = held.stress().norm();
    }
  }
}

TEST(MaterialPoint, TangentsArePositiveAndFallWithTheStep)
{
  const ComplianceLaw law = tables::anisotropic_law();
  for (const TimeScheme scheme : {creep, relaxation}) {
    const SteppableLaw steppable = steppable_law(law, scheme);
    Mat6 before = step_operator(steppable, 0).tangent;
    EXPECT_LE(tables::difference(before, stiffness(relaxation_law(law), 0)), 1e-12);
    for (int k = -12; k <= 12; ++k) {
      const Mat6 tangent = step_operator(steppable, 5 * std::pow(10., k)).tangent;
      EXPECT_LE((tangent - tangent.transpose()).norm(), 1e-15 * tangent.norm());
      EXPECT_GT(smallest_eigenvalue(tangent), 0) << k;
      EXPECT_GE(smallest_eigenvalue(before - tangent), -1e-14 * before.norm()) << k;
      before = tangent;
    }
  }
}

TEST(MaterialPoint, StressIsAffineInTheStrainWithTheTangentAsItsSlope)
{
  const ComplianceLaw law = tables::anisotropic_law();
  for (const TimeScheme scheme : {creep, relaxation}) {
    Point point(law, scheme);
    point.to_strain(1e-3 * skew, 0);
    point.to_strain(2e-3 * skew, 7);
    const Vec6 from = point.strain() + 1e-3 * unit(4), stress = point.try_strain(from, 30);
    const Mat6 tangent = point.states.evaluate(std::vector<Vec6>(1, Vec6::Zero()), 30).tangent[0];
    for (int k = 0; k < 6; ++k) {
      const Vec6 slope = (point.try_strain(from + 1e-3 * unit(k), 30) - stress) / 1e-3;
      EXPECT_LE((slope - tangent.col(k)).norm(), 1e-12 * tangent.norm());
    }
  }
}

TEST(MaterialPoint, TrialsLeaveTheStateAndStoredStatesGoOnBitwise)
{
  for (const TimeScheme scheme : {creep, relaxation}) {
    Point first(tables::anisotropic_law(), scheme), second(tables::anisotropic_law(), scheme);
    first.to_strain(1e-3 * skew, 0);
    first.to_strain(1e-3 * skew, 3);
    const std::vector<double> kept = first.numbers();
    first.try_strain(5e-3 * skew, 11);
    EXPECT_EQ(first.numbers(), kept);
    second.states.restore(0, kept);
    second.states.set_last_step(first.states.last_step());
    EXPECT_EQ(second.numbers(), kept);
    for (Point* each : {&first, &second})
      each->to_strain(2e-3 * skew, 8);
    EXPECT_EQ(second.numbers(), first.numbers());
    EXPECT_EQ(second.estimate, first.estimate);
    EXPECT_GT(first.estimate, 0);
  }
}

TEST(MaterialPoint, ErrorEstimateIsTheErrorOfASmoothHistoryWithinAFactorOfTwo)
{
  const auto path = [](double t) -> Vec6 { return (1 + std::sin(0.1 * t)) * skew; };
  for (const TimeScheme scheme : {creep, relaxation})
    for (const double before : {0.5, 1., 2.}) { // the step before over the step
      std::vector<double> estimates;
      for (const double h : {1., 0.5, 0.25}) {
        const auto lead = [&](Point& point, double t, double by) {
          scheme == creep ? point.to_stress(1e6 * path(t + by), by)
                          : point.to_strain(1e-3 * path(t + by), by);
        };
        Point coarse(tables::anisotropic_law(), scheme), fine = coarse;
        const double start = 10 - before * h;
        for (Point* each : {&coarse, &fine}) {
          lead(*each, start, 0);
          lead(*each, start, before * h);
        }
        lead(coarse, 10, h);
        constexpr int n = 64;
        for (int k = 0; k < n; ++k)
          lead(fine, 10 + k * h / n, h / n);
        const double error = scheme == creep ? (coarse.strain() - fine.strain()).norm()
                                             : (coarse.stress() - fine.stress()).norm();
        EXPECT_GT(coarse.estimate, error / 2) << h << ' ' << before;
        EXPECT_LT(coarse.estimate, error * 2) << h << ' ' << before;
        estimates.push_back(coarse.estimate);
      }
      EXPECT_NEAR(std::log2(estimates[1] / estimates[2]), 3, 0.15) << before;
    }
}

TEST(MaterialPoint, StraightPathsAndJumpsHaveNoError)
{
  for (const TimeScheme scheme : {creep, relaxation}) {
    Point point(tables::anisotropic_law(), scheme);
    const auto lead = [&](double value, double h) {
      scheme == creep ? point.to_stress(value * 1e6 * skew, h)
                      : point.to_strain(value * 1e-3 * skew, h);
    };
    const double size = scheme == creep ? 1e-3 : 1e6;
    lead(1, 0);
    EXPECT_EQ(point.estimate, 0);
    lead(2, 4); // bent
    EXPECT_GT(point.estimate, 1e-3 * size);
    lead(4, 8); // goes on straight
    EXPECT_LT(point.estimate, 1e-12 * size);
  }
}

TEST(MaterialPoint, RefusesStepsThatAreNoTimes)
{
  Point point(bodies::burgers_in_shear(), creep);
  EXPECT_THROW(point.try_strain(skew, -1), std::invalid_argument);
  EXPECT_THROW(point.try_strain(skew, std::nan("")), std::invalid_argument);
  EXPECT_THROW(point.try_strain(skew, std::numeric_limits<double>::infinity()),
               std::invalid_argument);
}
