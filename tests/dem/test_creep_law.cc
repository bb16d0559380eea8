#include "dem/creep_law.h"
#include "dem/law_step.h"
#include "dem/phi_functions.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <limits>

using namespace dem;

namespace {

void expect_close(double found, double expected, double relative, const std::string& where)
{
  EXPECT_LE(std::abs(found - expected), relative * std::abs(expected))
      << where << ": " << found << " instead of " << expected;
}

} // namespace

TEST(PhiFunctions, MatchTheTableToRounding)
{
  for (const auto& row : reference::table("phi_functions.csv")) {
    const double x = reference::number(row, "x");
    expect_close(phi1(x), reference::number(row, "phi1"), 6e-16, "phi1 at " + row.at("x"));
    expect_close(phi2(x), reference::number(row, "phi2"), 6e-16, "phi2 at " + row.at("x"));
  }
}

TEST(CreepLaw, TimeFunctionsMatchTheTable)
{
  for (const auto& row : reference::table("burgers_time_functions.csv")) {
    const CreepLaw law = laws::burgers_set(row.at("set"));
    const auto spectrum = relaxation_spectrum(law);
    const double t = reference::number(row, "t");
    const std::string where = row.at("set") + " at t = " + row.at("t");
    expect_close(creep_compliance(law, t), reference::number(row, "J"), 1e-13, "J " + where);
    expect_close(creep_compliance_rate(law, t), reference::number(row, "Jdot"), 1e-13,
                 "dJ/dt " + where);
    expect_close(creep_compliance_integral(law, t), reference::number(row, "int_J"), 1e-13,
                 "int J " + where);
    expect_close(relaxation_integral(spectrum, t), reference::number(row, "int_G"), 1e-13,
                 "int G " + where);
    EXPECT_NEAR(relaxation(spectrum, t), reference::number(row, "G"), 1e-13 * law.maxwell_stiffness)
        << where;
  }
}

TEST(CreepLaw, SpectrumMatchesTheSetsAlsoForStiffnessRatiosOf1e8)
{
  const auto sets = reference::json("burgers_sets.json");
  for (const auto& [name, set] : sets.items()) {
    const CreepLaw law = laws::burgers_set(name);
    const auto spectrum = relaxation_spectrum(law);
    ASSERT_EQ(spectrum.size(), 2u);
    for (int i = 0; i < 2; ++i) {
      const std::string k = std::to_string(i + 1);
      expect_close(spectrum[i].rate, reference::number(set.at("relax_rate_" + k)), 1e-13,
                   name + " rate " + k);
      expect_close(spectrum[i].stiffness, reference::number(set.at("g" + k)), 1e-13,
                   name + " stiffness " + k);
    }
  }
}

TEST(CreepLaw, SpectrumOfManyBranchesMatchesTheTable)
{
  // J(t) = 1e-8 + 2e-12 t + sum J_k (1 - exp(-t / tau_k))
  const double compliance[] = {3e-9, 8e-9, 2e-8, 5e-8}, time[] = {0.1, 3, 40, 2000};
  std::vector<KelvinBranch> branches;
  for (int k = 0; k < 4; ++k)
    branches.push_back({1 / compliance[k], time[k] / compliance[k]});
  const auto spectrum = relaxation_spectrum(make_creep_law(1e8, 5e11, branches));
  const auto rows = reference::table("prony_interconversion.csv");
  ASSERT_EQ(spectrum.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    expect_close(spectrum[i].rate, reference::number(rows[i], "relaxation_rate"), 1e-11, "rate");
    expect_close(spectrum[i].stiffness, reference::number(rows[i], "relaxation_modulus"), 1e-11,
                 "stiffness");
  }
}

TEST(CreepLaw, SpectrumOfASpringAndADashpotIsOneMode)
{
  for (double viscosity = 1e-3; viscosity < 1e12; viscosity *= 1.37) {
    const auto spectrum = relaxation_spectrum(make_creep_law(1e6, viscosity, {}));
    ASSERT_EQ(spectrum.size(), 1U);
    expect_close(spectrum[0].rate, 1e6 / viscosity, 1e-14, "rate");
    expect_close(spectrum[0].stiffness, 1e6, 1e-14, "stiffness");
  }
}

TEST(CreepLaw, SpectrumKeepsItsIdentities)
{
  for (const CreepLaw& law : {laws::burgers_set("asphalt"), laws::wide()}) {
    double stiffness = 0, viscosity = 0;
    const auto spectrum = relaxation_spectrum(law);
    for (const auto& mode : spectrum) {
      EXPECT_GE(mode.stiffness, 0);
      stiffness += mode.stiffness;
      viscosity += mode.stiffness / mode.rate;
    }
    expect_close(stiffness, law.maxwell_stiffness, 1e-13, "sum of stiffnesses");
    expect_close(viscosity, *law.maxwell_viscosity, 1e-12, "sum of viscosities");
    for (std::size_t k = 0; k < law.branches.size(); ++k) { // rates interlace
      EXPECT_LT(spectrum[k].rate, 1 / retardation_time(law.branches[law.branches.size() - 1 - k]));
      EXPECT_GT(spectrum[k + 1].rate,
                1 / retardation_time(law.branches[law.branches.size() - 1 - k]));
    }
  }
}

TEST(CreepLaw, ComplexComplianceMatchesTheTable)
{
  for (const auto& row : reference::table("burgers_complex.csv")) {
    const CreepLaw law = laws::burgers_set(row.at("set"));
    const auto j = complex_compliance(law, reference::number(row, "omega"));
    const std::string where = row.at("set") + " at omega = " + row.at("omega");
    expect_close(j.real(), reference::number(row, "Jp"), 1e-12, "J' " + where);
    expect_close(-j.imag(), reference::number(row, "Jpp"), 1e-12, "J'' " + where);
    const std::complex<double> k = 1.0 / j;
    expect_close(std::abs(k), reference::number(row, "Kabs"), 1e-12, "|K*| " + where);
    expect_close(std::arg(k) * 180 / std::acos(-1.0), reference::number(row, "phase_deg"), 1e-12,
                 "phase " + where);
  }
}

TEST(CreepLaw, ViscosityScalingIsTimeScaling)
{
  const CreepLaw law = laws::burgers_set("asphalt");
  for (const auto& row : reference::table("time_scaling.csv")) {
    const double x = reference::number(row, "x"), t = reference::number(row, "t");
    const CreepLaw faster = with_viscosities_scaled(law, x);
    expect_close(creep_compliance(faster, x * t), reference::number(row, "J_scaled_at_x_t_equals"),
                 1e-13, "J");
    expect_close(relaxation(relaxation_spectrum(faster), x * t),
                 reference::number(row, "G_scaled_at_x_t_equals"), 1e-13, "G");
  }
}

TEST(CreepLaw, ViscosityScalingByAPowerOfTwoIsExactToTheLastBit)
{
  const CreepLaw law = laws::wide();
  for (const double x : {0x1p-20, 0.5, 0x1p10})
    for (const double t : {1e-3, 0.7, 31.0, 4e3}) {
      EXPECT_EQ(creep_compliance(with_viscosities_scaled(law, x), x * t), creep_compliance(law, t));
      EXPECT_EQ(creep_compliance_integral(with_viscosities_scaled(law, x), x * t),
                x * creep_compliance_integral(law, t));
    }
}

TEST(CreepLaw, LimitsAreTakenAndImpossibleLawsRefused)
{
  const double inf = std::numeric_limits<double>::infinity();
  // a Kelvin dashpot without viscosity is a spring in series
  EXPECT_DOUBLE_EQ(creep_compliance(burgers(2, 3, 4, 0), 0), 1 / 2. + 1 / 4.);
  // without Kelvin branch: Maxwell; a very stiff branch comes to the same
  for (const double t : {0.1, 10.0}) {
    EXPECT_NEAR(creep_compliance(burgers(2, 3, inf, 5), t), 1 / 2. + t / 3, 1e-15);
    EXPECT_NEAR(creep_compliance(burgers(2, 3, 1e300, 5), t), 1 / 2. + t / 3, 1e-15);
    EXPECT_NEAR(relaxation(relaxation_spectrum(burgers(2, 3, 1e300, 5)), t),
                2 * std::exp(-2 * t / 3), 1e-15);
    EXPECT_NEAR(relaxation(relaxation_spectrum(burgers(2, 3, 4, inf)), t), 2 * std::exp(-2 * t / 3),
                1e-15);
  }
  // without dashpot the force relaxes to K_m K_k / (K_m + K_k)
  for (const double viscosity : {inf, 1e300})
    EXPECT_NEAR(relaxation(relaxation_spectrum(burgers(2, viscosity, 4, 5)), 1e3), 8. / 6, 1e-14);
  // a branch without spring is a dashpot
  EXPECT_NEAR(creep_compliance(burgers(2, 3, 0, 5), 7), 0.5 + 7 / 3. + 7 / 5., 1e-14);
  EXPECT_NEAR(creep_compliance(burgers(2, 3, 1e-300, 5), 7), 0.5 + 7 / 3. + 7 / 5., 1e-14);
  for (const auto& [km, cm, kk, ck] : {std::array{0., 3., 4., 5.},
                                       {2., 0., 4., 5.},
                                       {2., 3., -4., 5.},
                                       {2., 3., 4., -5.},
                                       {2., 3., 0., 0.},
                                       {NAN, 3., 4., 5.},
                                       {2., NAN, 4., 5.}})
    EXPECT_THROW(burgers(km, cm, kk, ck), std::invalid_argument);
  const std::vector<KelvinBranch> twins{{1, 2}, {3, 6}}; // equal retardation times
  const CreepLaw merged = make_creep_law(1, std::nullopt, twins);
  ASSERT_EQ(merged.branches.size(), 1u);
  EXPECT_NEAR(creep_compliance(merged, 1), 1 + (1 + 1 / 3.) * (1 - std::exp(-0.5)), 1e-15);
}

TEST(CreepLaw, RunsWithoutFloatingPointExceptions)
{
  std::feclearexcept(FE_ALL_EXCEPT);
  for (const char* name : {"unit", "asphalt", "stiff_fastK", "stiff_slowK"}) {
    const CreepLaw law = laws::burgers_set(name);
    const auto spectrum = relaxation_spectrum(law);
    for (double t = 1e-12; t < 1e12; t *= 10) {
      EXPECT_TRUE(std::isfinite(creep_compliance(law, t)));
      EXPECT_TRUE(std::isfinite(relaxation(spectrum, t)));
    }
  }
  EXPECT_FALSE(std::fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW));
}

TEST(CreepLaw, LateCreepKeepsItsDigits)
{
  // after 1e9 s everything but the dashpot is a constant
  const CreepLaw law = laws::burgers_set("asphalt");
  const double rest = creep_compliance(law, 1e9) - 1e9 / *law.maxwell_viscosity;
  EXPECT_NEAR(rest, 1 / 1e6 + 1 / 8e5, 1e-9 * creep_compliance(law, 1e9));
}

TEST(CreepLaw, ProportionalLawsAreRecognised)
{
  const CreepLaw law = laws::wide();
  EXPECT_NEAR(proportionality(law, scaled(law, 0.3)).value(), 0.3, 1e-15);
  EXPECT_FALSE(proportionality(law, with_viscosities_scaled(law, 2)));
  EXPECT_FALSE(proportionality(law, laws::burgers_set("asphalt")));
}

TEST(LawStep, DissipatesNothingInNoTimeUnderEitherScheme)
{
  const CreepLaw law = laws::wide();
  const int n_parts = 1 + int(law.branches.size());
  const double before[] = {0.7, 1e-7, -3e-7, 2e-6}, increment = 1e-6;
  for (const StepScheme scheme : {StepScheme::force_linear, StepScheme::displacement_linear})
    for (const double moment : {1e-40, 1e-20, 1e-12}) {
      const LawStep step = law_step(law, scheme, moment, n_parts);
      double after[4] = {};
      for (int p = 0; p < n_parts; ++p) {
        after[p] = step.gain[p] * increment;
        for (int q = 0; q < n_parts; ++q)
          after[p] += step.carry(p, q) * before[q];
      }
      const double dissipated = dissipated_energy(law, step, before, after, increment, 1);
      EXPECT_GE(dissipated, 0) << moment;
      EXPECT_LT(dissipated, 1e-4 * moment) << moment; // some N^2 over some 1e5 N s/m
    }
}
