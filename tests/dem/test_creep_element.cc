#include "dem/creep_element.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace dem;

namespace {

/// Marches a force history in n equal steps; returns the displacement at the end.
double creep(const CreepLaw& law, const std::function<double(double)>& force, double t_end, int n)
{
  CreepState<double> state = virgin_state(law);
  state.elastic = force(0) / law.maxwell_stiffness;
  for (int k = 0; k < n; ++k) {
    const double a = t_end * k / n, b = t_end * (k + 1) / n;
    state = creep_step(law, state, (force(b) - force(a)) / law.maxwell_stiffness, b - a);
  }
  return displacement(state);
}

/// The same with prescribed displacement; returns the force.
double relax(const CreepLaw& law, const std::function<double(double)>& displacement, double t_end,
             int n)
{
  const auto spectrum = relaxation_spectrum(law);
  RelaxationState state(spectrum.size(), 0.0);
  state = relaxation_step(spectrum, state, displacement(0), 0);
  for (int k = 0; k < n; ++k) {
    const double a = t_end * k / n, b = t_end * (k + 1) / n;
    state = relaxation_step(spectrum, state, displacement(b) - displacement(a), b - a);
  }
  return force(state);
}

double observed_order(double coarse, double fine)
{
  return std::log2(coarse / fine);
}

} // namespace

TEST(CreepElement, AlgorithmicStiffnessMatchesTheTable)
{
  for (const auto& row : reference::table("algorithmic_stiffness.csv")) {
    const CreepLaw law = laws::burgers_set(row.at("set"));
    const double h = reference::number(row, "h");
    const double k = reference::number(row, "K_Jlin"), g = reference::number(row, "K_Glin");
    EXPECT_NEAR(force_linear_stiffness(law, h), k, 1e-13 * k) << row.at("set") << " h " << h;
    EXPECT_NEAR(displacement_linear_stiffness(relaxation_spectrum(law), h), g, 1e-13 * g)
        << row.at("set") << " h " << h;
  }
}

TEST(CreepElement, RecoveryMatchesTheTable)
{
  for (const auto& row : reference::table("burgers_recovery.csv")) {
    const CreepLaw law = laws::burgers_set(row.at("set"));
    CreepState<double> state = virgin_state(law);
    state.elastic = 1 / law.maxwell_stiffness;
    const double t_unload = reference::number(row, "t_unload"), t = reference::number(row, "t");
    state = creep_step(law, state, 0.0, t_unload);
    state.elastic = 0;
    state = creep_step(law, state, 0.0, t - t_unload);
    const double expected = reference::number(row, "u_per_F");
    EXPECT_NEAR(displacement(state), expected, 1e-13 * expected) << row.at("set") << " t " << t;
  }
}

TEST(CreepElement, EnergyHistoryMatchesTheTableOverStepsFrom1e_6To100)
{
  const CreepLaw law = laws::burgers_set("unit");
  CreepState<double> state = virgin_state(law);
  double work = 0;
  for (const auto& row : reference::table("burgers_energy_history.csv")) {
    const double h = reference::number(row, "h"), before = law.maxwell_stiffness * state.elastic;
    const double f = reference::number(row, "f"), u_before = displacement(state);
    const CreepState<double> start = state;
    state = creep_step(law, state, (f - before) / law.maxwell_stiffness, h);
    // work of a linear force: integral of f du, by parts with the exact integral of u
    const double slope = (f - before) / h;
    double integral_u = h * (start.elastic + start.viscous) +
                        0.5 * h * (f - before) / law.maxwell_stiffness +
                        h * h * (before / 2 + (f - before) / 6) / *law.maxwell_viscosity;
    for (std::size_t k = 0; k < law.branches.size(); ++k) {
      const auto [stiffness, viscosity] = law.branches[k];
      const double x = h * stiffness / viscosity;
      const double phi3 = x > 1e-3 ? (0.5 - phi2(x)) / x : 1 / 6. - x / 24 + x * x / 120;
      integral_u += h * (start.kelvin[k] * phi1(x) +
                         h / viscosity * (before * phi2(x) + (f - before) * phi3));
    }
    work += f * displacement(state) - before * u_before - slope * integral_u;
    const double tolerance = 1e-12;
    const auto expect = [&](double found, const char* column) {
      const double expected = reference::number(row, column);
      EXPECT_NEAR(found, expected, tolerance * std::max(1.0, std::abs(expected)))
          << column << " at t = " << row.at("t");
    };
    expect(displacement(state), "u");
    expect(state.kelvin[0], "uk");
    expect(state.viscous, "um");
    expect(work, "work");
    expect(free_energy(law, state), "free_energy");
    expect(work - free_energy(law, state), "dissipated");
  }
}

TEST(CreepElement, IsExactForAnyStepWhereItClaimsToBe)
{
  for (const CreepLaw& law : {laws::burgers_set("asphalt"), laws::wide()}) {
    const auto spectrum = relaxation_spectrum(law);
    const double t = 120;
    for (const int n : {1, 3, 64}) {
      const double step = creep(
          law, [](double) { return 2.0; }, t, n);
      EXPECT_NEAR(step, 2 * creep_compliance(law, t), 1e-14 * step);
      const double ramp = creep(
          law, [](double s) { return 0.5 * s; }, t, n);
      EXPECT_NEAR(ramp, 0.5 * creep_compliance_integral(law, t), 1e-14 * ramp);
      const double held = relax(
          law, [](double) { return 2.0; }, t, n);
      EXPECT_NEAR(held, 2 * relaxation(spectrum, t), 1e-14 * law.maxwell_stiffness);
      const double pulled = relax(
          law, [](double s) { return 0.5 * s; }, t, n);
      EXPECT_NEAR(pulled, 0.5 * relaxation_integral(spectrum, t), 1e-13 * pulled);
    }
  }
}

TEST(CreepElement, OtherHistoriesConvergeWithSecondOrder)
{
  for (const auto& row : reference::table("burgers_sine_transient.csv")) {
    if (row.at("set") != "asphalt" && row.at("set") != "unit")
      continue;
    const CreepLaw law = laws::burgers_set(row.at("set"));
    const double omega = reference::number(row, "omega"), t = reference::number(row, "t");
    const double cycles = omega * t / 6.283;
    if (cycles < 0.1 || cycles > 20)
      continue;
    const auto sine = [&](double s) { return std::sin(omega * s); };
    const int n = int(64 * std::max(1.0, cycles));
    const double u = reference::number(row, "u_for_f_sin"),
                 f = reference::number(row, "f_for_u_sin");
    const double scale_u = std::abs(u) + 1 / law.maxwell_stiffness;
    const double error_u = std::abs(creep(law, sine, t, n) - u);
    const double error_u_fine = std::abs(creep(law, sine, t, 2 * n) - u);
    EXPECT_LT(error_u, 2e-3 * scale_u);
    if (error_u_fine > 1e-9 * scale_u) {
      EXPECT_NEAR(observed_order(error_u, error_u_fine), 2, 0.2) << "omega " << omega << " t " << t;
    }
    const double error_f = std::abs(relax(law, sine, t, n) - f);
    const double error_f_fine = std::abs(relax(law, sine, t, 2 * n) - f);
    EXPECT_LT(error_f, 2e-3 * law.maxwell_stiffness);
    if (error_f_fine > 1e-9 * law.maxwell_stiffness) {
      EXPECT_NEAR(observed_order(error_f, error_f_fine), 2, 0.2) << "omega " << omega << " t " << t;
    }
  }
}

TEST(CreepElement, ErrorsAreThoseOfTheWorkPrecisionTable)
{
  const CreepLaw law = laws::burgers_set("asphalt");
  const double t = 120, period = 120; // four retardation times
  const double omega = 2 * std::acos(-1.0) / period;
  for (const auto& row : reference::table("integrator_errors.csv")) {
    const int n = int(reference::number(row, "n_steps"));
    const double expected = reference::number(row, "error");
    if (row.at("case") == "relax" && row.at("scheme") == "JL")
      continue; // the force-driven element is not used with held displacement
    if (row.at("case") == "creep" && row.at("scheme") == "GL")
      continue;
    if (row.at("case") == "sine_f" && row.at("scheme") == "JL") {
      const double exact = creep(
          law, [&](double s) { return std::sin(omega * s); }, t, 1 << 18);
      const double found = creep(
          law, [&](double s) { return std::sin(omega * s); }, t, n);
      EXPECT_NEAR(std::abs(found - exact) / creep_compliance(law, t), expected, 0.02 * expected);
    }
    if (row.at("case") == "sine_u" && row.at("scheme") == "GL") {
      const double exact = relax(
          law, [&](double s) { return std::sin(omega * s); }, t, 1 << 18);
      const double found = relax(
          law, [&](double s) { return std::sin(omega * s); }, t, n);
      EXPECT_NEAR(std::abs(found - exact) / law.maxwell_stiffness, expected, 0.02 * expected);
    }
  }
}

TEST(CreepElement, ManyStepsGiveTheSameAsOne)
{
  const CreepLaw law = laws::burgers_set("asphalt");
  for (const auto& [n, tolerance] : {std::pair{10000, 1e-12}, {1000000, 1e-10}})
    EXPECT_NEAR(creep(
                    law, [](double) { return 1.0; }, 3000, n) /
                    creep_compliance(law, 3000),
                1, tolerance);
}

TEST(CreepElement, StepsCompose)
{
  const CreepLaw law = laws::wide();
  CreepState<double> state = virgin_state(law);
  state.elastic = 3e-6;
  state.kelvin = {1e-7, 2e-7, -1e-7};
  const auto once = creep_step(law, state, 5e-6, 7.0);
  const auto twice = creep_step(law, creep_step(law, state, 5e-6 * 3 / 7, 3.0), 5e-6 * 4 / 7, 4.0);
  EXPECT_NEAR(displacement(once), displacement(twice), 1e-13 * displacement(once));
}

TEST(CreepElement, DoesNotDependOnTheUnits)
{
  // Length in mm, mass in g, time in minutes.
  const double length = 1e-3, mass = 1e-3, time = 60;
  const double stiffness = mass / (time * time), viscosity = mass / time,
               force = length * mass / (time * time);
  const CreepLaw law = laws::burgers_set("asphalt");
  const CreepLaw other =
      burgers(1e6 / stiffness, 1.6e8 / viscosity, 8e5 / stiffness, 2.4e7 / viscosity);
  const auto sine = [](double s) { return std::sin(0.01 * s); };
  EXPECT_NEAR(creep(
                  other, [&](double s) { return sine(s * time) / force; }, 50 / time, 16) *
                  length,
              creep(law, sine, 50, 16), 1e-19);
}
