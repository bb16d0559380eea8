#include "apps/load_case.h"
#include "apps/specimen.h"
#include "apps/specimen_run.h"
#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

using namespace apps;

namespace {

using Settings = std::vector<std::string>;

/// A lattice under load, ready to be run.
struct Case {
  LoadedScene scene;
  Specimen specimen;
  dem::Loading loading;

  Case(const command::Folder& folder, const Settings& settings)
      : scene(load_scene(folder / "net.scene", settings))
  {
    if (scene.has_errors())
      throw std::logic_error("the scene of the test is wrong");
    specimen = make_specimen(scene, make_packing(scene));
    loading = make_loading(*scene.scene, specimen.assembly.area, specimen.assembly.gauge_length);
  }
  SolverDecision decision() const
  {
    return choose_solver(*scene.scene, specimen.assembly, loading);
  }
  std::unique_ptr<SpecimenRun> run(SolverChoice solver) const
  {
    return make_run(solver, *scene.scene, specimen.assembly, loading, 1);
  }
};

/// "solver: reason" that a lattice gets.
std::string decision(const Settings& settings)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const SolverDecision found = Case(folder, settings).decision();
  return name_of(found.solver) + ": " + found.reason;
}

/// Responses at all history times.
std::vector<dem::Response> history(const Case& c, SolverChoice solver)
{
  const auto run = c.run(solver);
  std::vector<dem::Response> rows;
  for (const double time : history_times(*c.scene.scene, c.loading)) {
    while (!run->ended() && !run->reached(time))
      run->work_towards(time);
    rows.push_back(run->response(time));
  }
  return rows;
}

const std::string weak = "Loading/Axial stress = 1000 kPa", gentle = "Loading/Axial stress = 1 kPa";
const std::string not_proportional = "the bonds follow several laws that are not proportional, so "
                                     "that their forces depend on history";

} // namespace

TEST(SolverChoice, AutoTakesTheCheapestThatIsExact)
{
  EXPECT_EQ(decision({weak, "Strength/Distribution = none"}),
            "linear: laws are proportional and bonds do not break");
  EXPECT_EQ(decision({gentle}), "linear: laws are proportional and no bond reaches its strength");
  EXPECT_EQ(decision({weak}), "events: laws are proportional, bonds break and leave no friction; "
                              "above a strain of 1 % the quasi-static solver takes over");
  EXPECT_EQ(decision({gentle, "Loading/True stress = true"}),
            "events: laws are proportional; the force follows the strain (true stress)");
  EXPECT_EQ(decision({gentle, "Bonds/After breakage = friction"}),
            "linear: laws are proportional and no bond reaches its strength");
  EXPECT_EQ(decision({weak, "Bonds/After breakage = friction"}),
            "quasistatic: bonds break and keep friction");
  EXPECT_EQ(decision({gentle, "Bonds/After breakage = friction", "Strength/Distribution = none"}),
            "linear: laws are proportional and bonds do not break");
}

TEST(SolverChoice, AutoClimbsFromAnIntactSpecimenThatStrainsTooMuch)
{
  const Settings unbroken{weak, "Strength/Distribution = none", "Small strain = 0.05 %"};
  const std::string text = decision(unbroken);
  EXPECT_TRUE(command::contains(text, "events: laws are proportional and bonds do not break, but "
                                      "the strain reaches "))
      << text;
  const command::Folder folder;
  networks::write_lattice(folder);
  const Case c(folder, unbroken);
  const auto rows = history(c, SolverChoice::events);
  const auto linear = history(c, SolverChoice::linear);
  ASSERT_EQ(rows.size(), linear.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double strain = std::abs(linear[k].strain);
    EXPECT_NEAR(rows[k].strain, linear[k].strain, strain < 5e-4 ? 1e-12 : 3 * strain * strain);
  }
  EXPECT_GT(std::abs(linear.back().strain), 5e-4);
  EXPECT_NE(rows.back().strain, linear.back().strain); // geometry has changed
}

TEST(SolverChoice, AutoLooksAtTheLaws)
{
  const std::string law = "Bond law other/Classes = 0: 0";
  const Settings proportional{gentle,
                              law,
                              "Bond law other/Maxwell stiffness = 1.6e6 N/m",
                              "Bond law other/Maxwell viscosity = 4.1e8 N s/m",
                              "Bond law other/Kelvin stiffness = 2.5e5 N/m",
                              "Bond law other/Kelvin viscosity = 4.2e6 N s/m"};
  EXPECT_EQ(decision(proportional),
            "linear: laws are proportional and no bond reaches its strength");
  Settings other = proportional;
  other.back() = "Bond law other/Kelvin viscosity = 4.3e6 N s/m";
  EXPECT_EQ(decision(other), "quasistatic: " + not_proportional);
}

TEST(SolverChoice, TakesTheSolverThatTheSceneNames)
{
  EXPECT_EQ(decision({gentle, "Solver = events"}), "events: the scene asks for it");
  EXPECT_EQ(decision({gentle, "Solver = dynamic"}), "dynamic: the scene asks for it");
  EXPECT_EQ(decision({gentle, "Solver = linear", "Strength/Distribution = none"}),
            "linear: the scene asks for it");
  EXPECT_EQ(decision({weak, "Solver = linear"}),
            "linear: the scene asks for it (bonds are taken as unbreakable)");
}

TEST(SolverChoice, SaysWhyANamedSolverCannotBe)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Case c(
      folder, {gentle, "Bond law other/Classes = 0: 0", "Bond law other/Maxwell viscosity = none"});
  for (const SolverChoice solver : {SolverChoice::linear, SolverChoice::events}) {
    c.scene.scene->solver = solver;
    try {
      c.decision();
      FAIL() << name_of(solver);
    } catch (const std::invalid_argument& problem) {
      EXPECT_EQ(problem.what(),
                "Solver = " + name_of(solver) + ": " + not_proportional + "; use quasistatic");
    }
  }
}

TEST(SolverChoice, LinearAndEventsTellTheSameHistory)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const std::vector<Settings> tests{
      {"Loading/Release time = 30 s", "Loading/End time = 100 s"},
      {"Loading/Test = stress history",
       "Loading/Stress history = 0 s: 0 kPa, 10 s: 1 kPa, 20 s: 1 kPa, 20 s: 0.2 kPa, 50 s: 0 kPa"},
      {"Loading/Test = haversine", "Loading/Peak stress = 1 kPa", "Loading/Cycles = 5"},
      {"Loading/Test = block pulses", "Loading/Peak stress = 1 kPa", "Loading/Cycles = 5"},
      {"Loading/Test = sine", "Loading/Stress amplitude = 1 kPa", "Loading/Cycles = 5"},
      {"Loading/Test = constant rate", "Loading/Strain rate = 1e-6 1/s",
       "Loading/End strain = 0.01 %"},
      {"Loading/End time = 60 s", "Strength/Rate window = 0 s",
       "Strength/Rate window fraction = 0"}};
  for (Settings settings : tests) {
    settings.insert(settings.end(), {gentle, "Output/History times = 25"});
    const Case c(folder, settings);
    const auto linear = history(c, SolverChoice::linear), events = history(c, SolverChoice::events);
    ASSERT_EQ(linear.size(), events.size());
    ASSERT_GE(linear.size(), 25u);
    EXPECT_EQ(events.back().n_broken, 0);
    for (std::size_t k = 0; k < linear.size(); ++k) {
      const dem::Response &a = linear[k], &b = events[k];
      EXPECT_NEAR(a.force, b.force, 1e-9 * (0.1 + std::abs(b.force))) << settings[0] << b.time;
      EXPECT_NEAR(a.strain, b.strain, 1e-12) << settings[0] << b.time;
      EXPECT_NEAR(a.strain_rate, b.strain_rate, 1e-9 * std::abs(b.strain_rate) + 1e-14)
          << settings[0] << b.time;
      EXPECT_NEAR(a.strength_factor, b.strength_factor, 1e-7 * b.strength_factor)
          << settings[0] << b.time;
      EXPECT_NEAR(a.compliance, b.compliance, 1e-9 * b.compliance);
    }
  }
}

TEST(SolverChoice, UnbreakableBondsGoThroughEachSolver)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Case c(folder, {weak, "Strength/Distribution = none", "Loading/End time = 10 s",
                        "Output/History times = 3", "Dynamic/Viscosity scaling = 0.001"});
  const double linear = history(c, SolverChoice::linear).back().strain;
  EXPECT_NEAR(history(c, SolverChoice::events).back().strain, linear, 1e-9 * std::abs(linear));
  EXPECT_NEAR(history(c, SolverChoice::dynamic).back().strain, linear, 0.05 * std::abs(linear));
}
