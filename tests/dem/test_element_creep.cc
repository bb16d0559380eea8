#include "dem/crystals.h"
#include "dem/element_creep.h"
#include "dem/frequency_response.h"
#include "tests/dem/elements.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <omp.h>

#include <cmath>
#include <numbers>

using namespace dem;

namespace {

constexpr double diameter = 4e-3;

/// Spheres in a row along x, bonded by two laws in turn, in square array.
VolumeElement two_law_row(const CreepLaw& first, const CreepLaw& second)
{
  const Particles particles{
      {Vec3::Zero(), Vec3(diameter, 0, 0)}, {diameter / 2, diameter / 2}, {0, 0}};
  const PeriodicCell cell = box_cell(Vec3(2 * diameter, diameter, diameter));
  VolumeElement element =
      make_volume_element(cell, particles, periodic_contacts_within(cell, particles, 1e-6),
                          {{first, 11, 1}, {second, 11, 1}}, {{0, 0, 0}});
  bool is_second = false;
  for (std::size_t b = 0; b < element.bonds.size(); ++b)
    if (element.bonds.ends[b] == std::array<Index, 2>{0, 1})
      element.bonds.law[b] = std::exchange(is_second, !is_second);
  return element;
}

const CreepLaw soft = burgers(1e6, 1.6e8, 8e5, 2.4e7), stiff = burgers(3e6, 4e9, 2e6, 4e8);

const VolumeElement& cube()
{
  static const VolumeElement element = elements::two_law_cube(40, 4);
  return element;
}

/// Mixed control: strains along x and in one shear plane, stresses else, growing or oscillating.
MacroLoad mixed_load(double time)
{
  MacroLoad load{{false, true, true, false, true, true}, Vec6::Zero()};
  load.value << 1e-3 * std::sin(time / 20), 1e3, 2e3 * std::cos(time / 30), 2e-4 * time / 100, 0,
      5e2;
  return load;
}

ElementState after(const ElementModel& model, int n_steps, StepScheme scheme, bool is_creep)
{
  constexpr double end = 100;
  std::vector<MacroPoint> points;
  for (int k = 0; k <= n_steps; ++k) {
    const double time = end * k / n_steps;
    points.push_back(
        {time, is_creep ? MacroLoad{{true, true, true, true, true, true}, Vec6::Constant(1e3)}
                        : mixed_load(time)});
  }
  return follow(model, virgin_state(model), points, scheme).back();
}

Vec6 scaled_difference(const ElementState& a, const ElementState& b)
{
  return (a.strain - b.strain) / b.strain.norm() + (a.stress - b.stress) / b.stress.norm();
}

double distance(const ComplexMat6& a, const ComplexMat6& b)
{
  return (a - b).norm() / b.norm();
}

} // namespace

TEST(ElementCreep, TwoLawsInARowAddTheirCompliances)
{
  const ElementModel model = make_element_model(two_law_row(soft, stiff));
  const std::vector<double> times{0, 0.1, 3, 30, 300, 3000};
  const CreepHistory history = creep_compliance(model, times, 1e-6);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k];
    EXPECT_NEAR(history.compliance[k](0, 0) /
                    (diameter * (creep_compliance(soft, t) + creep_compliance(stiff, t)) / 2),
                1, 1e-12)
        << t;
    EXPECT_NEAR(history.compliance[k](1, 1) / (diameter * creep_compliance(soft, t)), 1, 1e-12);
  }
}

TEST(ElementCreep, ProportionalLawsCreepAsOne)
{
  const VolumeElement element =
      elements::random_cube(40, 4, {elements::law(), {scaled(elements::law().creep, 3), 5, 0.7}},
                            {{0, 0, 0}, {1, 1, 1}, {0, 1, 0}});
  const std::vector<double> times{0, 1, 40, 1000};
  const CreepHistory history = creep_compliance(make_element_model(element), times, 1e-8);
  const Mat6 elastic = compliance(homogenize(element).stiffness);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Mat6 expected = creep_compliance(element, elastic, times[k]);
    EXPECT_LT((history.compliance[k] - expected).norm(), 1e-11 * expected.norm()) << times[k];
  }
  EXPECT_THROW(creep_compliance(cube(), elastic, 1), std::invalid_argument);
}

TEST(ElementCreep, BothSchemesAreOfSecondOrder)
{
  const ElementModel model = make_element_model(cube());
  for (const bool is_creep : {true, false})
    for (const auto scheme : {StepScheme::force_linear, StepScheme::displacement_linear}) {
      const ElementState exact = after(model, 1024, scheme, is_creep);
      std::vector<double> error;
      for (const int n : {16, 32, 64})
        error.push_back(scaled_difference(after(model, n, scheme, is_creep), exact).norm());
      for (std::size_t k = 1; k < error.size(); ++k)
        EXPECT_NEAR(std::log2(error[k - 1] / error[k]), 2, 0.2) << is_creep << " " << int(scheme);
      EXPECT_LT(error.back(), 1e-3);
    }
  const Vec6 difference =
      scaled_difference(after(model, 512, StepScheme::force_linear, false),
                        after(model, 512, StepScheme::displacement_linear, false));
  EXPECT_LT(difference.norm(), 1e-4);
}

TEST(ElementCreep, MeetsItsTolerance)
{
  const ElementModel model = make_element_model(cube());
  const std::vector<double> times{0, 1, 10, 100, 1000, 10000};
  const CreepHistory rough = creep_compliance(model, times, 1e-4);
  const CreepHistory fine = creep_compliance(model, times, 1e-7);
  EXPECT_GT(fine.n_steps, rough.n_steps);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Mat6& exact = fine.compliance[k];
    EXPECT_LT((rough.compliance[k] - exact).norm(), 3e-4 * exact.norm()) << times[k];
    EXPECT_LT((exact - exact.transpose()).norm(), 1e-10 * exact.norm()); // reciprocity in time
  }
  EXPECT_LT((rough.compliance[0] - compliance(homogenize(cube()).stiffness)).norm(),
            1e-11 * rough.compliance[0].norm());
}

TEST(ElementCreep, OneStepIsTwoWhileForcesAreLinear)
{
  // one law: bond forces follow the mean stress, so a ramp of stress is exact in any steps
  const ElementModel model = make_element_model(elements::random_cube(30, 9));
  const MacroLoad half{{true, true, true, true, true, true}, Vec6::Constant(1e3)};
  MacroLoad full = half;
  full.value *= 2;
  const std::vector<MacroPoint> one{{20, full}}, two{{10, half}, {20, full}};
  const ElementState start = virgin_state(model);
  const ElementState a = follow(model, start, one, StepScheme::force_linear).back();
  const ElementState b = follow(model, start, two, StepScheme::force_linear).back();
  EXPECT_LT((a.strain - b.strain).norm(), 1e-12 * a.strain.norm());
  EXPECT_LT((a.dofs - b.dofs).norm(), 1e-11 * a.dofs.norm());
  EXPECT_THROW(follow(model, a, two, StepScheme::force_linear), std::invalid_argument);
  EXPECT_EQ(start.strain, Vec6::Zero()); // states are values
}

TEST(FrequencyResponse, TwoLawsInARowAddTheirCompliances)
{
  const VolumeElement element = two_law_row(soft, stiff);
  const std::vector<double> omega{1e-6, 1e-3, 0.1, 10, 1e4};
  const FrequencyResponse response = frequency_response(element, omega, 1e-10);
  for (std::size_t k = 0; k < omega.size(); ++k) {
    const std::complex<double> expected =
        diameter / 2 * (complex_compliance(soft, omega[k]) + complex_compliance(stiff, omega[k]));
    const ComplexMat6 s = complex_compliance(response.stiffness[k]);
    EXPECT_LT(std::abs(s(0, 0) / expected - 1.0), 1e-10) << omega[k];
  }
}

TEST(FrequencyResponse, IsThatOfTheFullComplexNetwork)
{
  const VolumeElement& element = cube();
  const MacroNetwork macro = make_macro_network(element);
  const Index n = macro.n_dofs() - 3; // the first particle does not move
  const std::vector<double> omega{1e-5, 1e-4, 3e-3, 0.02, 0.4, 7, 100};
  const FrequencyResponse response = frequency_response(element, omega);
  for (std::size_t k = 0; k < omega.size(); ++k) {
    Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(n, n), loads = Eigen::MatrixXcd::Zero(n, 6);
    ComplexMat6 expected = ComplexMat6::Zero();
    for (std::size_t l = 0; l < element.laws.size(); ++l) {
      std::vector<double> own(element.laws.size(), 0.0);
      own[l] = 1;
      const std::complex<double> stiffness =
          1.0 / complex_compliance(element.laws[l].creep, omega[k]);
      const Eigen::SparseMatrix<double> lower = stiffness_matrix(macro, own);
      const Eigen::MatrixXd dense = lower.selfadjointView<Eigen::Lower>() *
                                    Eigen::MatrixXd::Identity(macro.n_dofs(), macro.n_dofs());
      matrix += stiffness * dense.bottomRightCorner(n, n);
      loads += stiffness * strain_loads(macro, own).bottomRows(n);
      expected += stiffness * affine_energy(macro, own);
    }
    expected -= loads.transpose() * matrix.partialPivLu().solve(loads);
    EXPECT_LT(distance(response.stiffness[k], expected / macro.volume), 1e-9) << omega[k];
    EXPECT_LE(response.error[k], 1e-9);
  }
}

TEST(FrequencyResponse, OfOneLawIsTheElasticOneTimesTheLaw)
{
  const VolumeElement element = elements::random_cube(40, 4);
  const std::vector<double> omega{1e-4, 1, 30};
  const FrequencyResponse response = frequency_response(element, omega);
  const Mat6 elastic = compliance(homogenize(element).stiffness);
  for (std::size_t k = 0; k < omega.size(); ++k)
    EXPECT_LT(distance(complex_compliance(response.stiffness[k]),
                       complex_compliance(element, elastic, omega[k])),
              1e-10);
  EXPECT_LE(response.basis_size, 18); // the first frequency, and its round-off
}

TEST(FrequencyResponse, IsTheSteadyStateOfTimeStepping)
{
  const VolumeElement element =
      two_law_row(burgers(1e6, 1e7, 8e5, 4e6), burgers(3e6, 5e7, 1e6, 2e6));
  const double omega = 0.3, period = 2 * std::numbers::pi / omega;
  const ComplexMat6 exact = frequency_response(element, {{omega}}).stiffness[0];
  const ElementModel model = make_element_model(element);
  constexpr int n_periods = 30, component = 5; // shear: the spheres turn
  std::vector<double> error;
  for (const int n : {64, 128}) {
    std::vector<MacroPoint> points;
    for (int k = 0; k <= n_periods * n; ++k)
      points.push_back(
          {period * k / n, {{}, Vec6::Unit(component) * std::sin(2 * std::numbers::pi * k / n)}});
    const auto states = follow(model, virgin_state(model), points, StepScheme::displacement_linear);
    std::complex<double> amplitude = 0;
    for (int k = 0; k < n; ++k)
      amplitude += 2.0 / n * states[std::size_t((n_periods - 1) * n + k)].stress[component] *
                   std::complex<double>(std::sin(2 * std::numbers::pi * k / n),
                                        std::cos(2 * std::numbers::pi * k / n));
    error.push_back(std::abs(amplitude / exact(component, component) - 1.0));
  }
  EXPECT_LT(error[1], 1e-3);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
}

TEST(FrequencyResponse, SeesASoftLawBetweenStiffOnes)
{
  // stiffness ratio 1e8: forces out of balance in soft bonds vanish beside the loads of stiff ones
  const CreepLaw hard = scaled(stiff, 1e8 / 3);
  const VolumeElement element = two_law_row(soft, hard);
  const std::vector<double> omega{1e-3, 0.02, 0.1, 1};
  const FrequencyResponse response = frequency_response(element, omega);
  for (std::size_t k = 0; k < omega.size(); ++k) {
    const std::complex<double> expected =
        diameter / 2 * (complex_compliance(soft, omega[k]) + complex_compliance(hard, omega[k]));
    const ComplexMat6 s = complex_compliance(response.stiffness[k]);
    EXPECT_LT(std::abs(s(0, 0) / expected - 1.0), 1e-6) << omega[k];
  }
}

TEST(FrequencyResponse, DoesNotDependOnTheNumberOfThreads)
{
  const VolumeElement element = elements::two_law_cube(150, 4);
  const std::vector<double> omega{1e-4, 1e-2, 1, 30};
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const FrequencyResponse one = frequency_response(element, omega);
  omp_set_num_threads(4);
  const FrequencyResponse four = frequency_response(element, omega);
  omp_set_num_threads(before);
  for (std::size_t k = 0; k < omega.size(); ++k)
    EXPECT_EQ(one.stiffness[k], four.stiffness[k]);
}

TEST(FrequencyResponse, RefusesWhatIsNoFrequency)
{
  EXPECT_THROW(frequency_response(cube(), {{-1.0}}), std::invalid_argument);
  EXPECT_THROW(frequency_response(cube(), {{1.0}}, 0), std::invalid_argument);
  EXPECT_TRUE(frequency_response(cube(), {}).stiffness.empty());
}
