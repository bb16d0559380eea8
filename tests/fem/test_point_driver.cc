#include "fem/creep_compliance.h"
#include "fem/point_driver.h"
#include "fem/relaxation_law.h"

#include <gtest/gtest.h>

#include <cmath>

using fem::PointTarget;
using fem::Vec6;

namespace {

/// Burgers, with a Poisson's ratio that does not change.
fem::ComplianceLaw burgers()
{
  return fem::isotropic_law(fem::burgers_compliance(3e8, 6e10, 2e8, 4e9), 0.3);
}

const std::array<bool, 6> by_stress{};
const std::array<bool, 6> by_axial_strain{false, false, true, false, false, false};
const fem::StepSettings settings{1e-8, 1e-4, 3};

PointTarget axial(double time, double value)
{
  return {time, value * Vec6::Unit(2)};
}

TEST(PointDriver, CreepAndRecoveryAreExactWhateverTheTimes)
{
  const fem::ComplianceLaw law = burgers();
  const std::vector<PointTarget> targets{axial(0, 1e5), axial(50, 1e5), axial(50, 0),
                                         axial(400, 0)};
  const fem::PointRun run =
      fem::drive_point(law, fem::TimeScheme::stress_linear, by_stress, targets, settings);
  const auto strain = [&](double t) { return 1e5 * fem::compliance(law, t)(2, 2); };
  EXPECT_NEAR(run.readings[0].strain[2], strain(0), 1e-12 * strain(0));
  EXPECT_NEAR(run.readings[1].strain[2], strain(50), 1e-12 * strain(50));
  EXPECT_NEAR(run.readings[2].strain[2], strain(50) - strain(0), 1e-12 * strain(50));
  EXPECT_NEAR(run.readings[3].strain[2], strain(400) - strain(350), 1e-11 * strain(50));
  EXPECT_NEAR(run.readings[3].strain[0], -0.3 * run.readings[3].strain[2], 1e-12 * strain(50));
}

TEST(PointDriver, HeldStrainRelaxesAsTheRelaxationLawSays)
{
  const fem::ComplianceLaw law = burgers();
  const std::array<bool, 6> all{true, true, true, true, true, true};
  std::vector<PointTarget> targets;
  for (const double t : {0., 1., 10., 100., 1e4})
    targets.push_back(axial(t, 1e-3));
  const fem::PointRun run =
      fem::drive_point(law, fem::TimeScheme::strain_linear, all, targets, settings);
  const fem::RelaxationLaw relaxing = fem::relaxation_law(law);
  for (const fem::PointReading& r : run.readings) {
    const Vec6 exact = 1e-3 * fem::stiffness(relaxing, r.time).col(2);
    EXPECT_LT((r.stress - exact).norm(), 1e-10 * 1e-3 * fem::stiffness(relaxing, 0).norm())
        << r.time;
  }
}

TEST(PointDriver, UniaxialConstantRateMeetsTheClosedFormToItsTolerance)
{
  const fem::CreepCompliance uniaxial = fem::burgers_compliance(3e8, 6e10, 2e8, 4e9);
  const fem::RelaxationModulus modulus = fem::relaxation_modulus(uniaxial);
  const double rate = 1e-4, end = 300;
  const std::vector<PointTarget> targets{axial(0, 0), axial(end, rate * end)};
  const fem::PointRun run = fem::drive_point(burgers(), fem::TimeScheme::strain_linear,
                                             by_axial_strain, targets, settings);
  double exact = modulus.equilibrium * rate * end;
  for (const fem::RelaxationPart& part : modulus.parts)
    exact += rate * part.modulus * part.time * -std::expm1(-end / part.time);
  EXPECT_NEAR(run.readings[1].stress[2], exact, 1e-9 * exact);
  EXPECT_NEAR(run.readings[1].stress[0], 0, 1e-9 * exact);
}

TEST(PointDriver, TighterTolerancesComeNearerInProportionToTheEstimate)
{
  // a sawtooth of stress by the scheme that is not exact for it
  const fem::ComplianceLaw law = burgers();
  const std::vector<PointTarget> targets{axial(0, 0), axial(40, 1e5), axial(90, 0)};
  const double exact =
      fem::drive_point(law, fem::TimeScheme::stress_linear, by_stress, targets, settings)
          .readings.back()
          .strain[2];
  double before = 0;
  for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
    const fem::PointRun run = fem::drive_point(law, fem::TimeScheme::strain_linear, by_stress,
                                               targets, {tolerance, 1e-3, 3});
    const double error = std::abs(run.readings.back().strain[2] / exact - 1);
    EXPECT_LT(error, 10 * run.error_sum);
    if (before > 0) {
      EXPECT_LT(error, before);
    }
    before = error;
  }
  EXPECT_LT(before, 1e-4);
}

TEST(PointDriver, RefusesTimesThatDecrease)
{
  const std::vector<PointTarget> targets{axial(2, 0), axial(1, 0)};
  EXPECT_THROW(
      fem::drive_point(burgers(), fem::TimeScheme::stress_linear, by_stress, targets, settings),
      std::invalid_argument);
}

} // namespace
