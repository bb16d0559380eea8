#include "apps/cycles.h"
#include "apps/load_case.h"
#include "apps/specimen.h"
#include "apps/specimen_run.h"
#include "tests/apps/networks.h"
#include "tests/apps/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

using namespace apps;

namespace {

using Settings = std::vector<std::string>;

/// Two bonded spheres under pulses.
struct Case {
  command::Folder folder;
  LoadedScene scene;
  Specimen specimen;
  dem::Loading loading;

  explicit Case(const Settings& settings)
  {
    networks::write_pair(folder);
    scene = load_scene(folder / "net.scene", settings);
    if (scene.has_errors())
      throw std::logic_error("the scene of the test is wrong");
    specimen = make_specimen(scene, make_packing(scene));
    loading = make_loading(*scene.scene, specimen.assembly.area, specimen.assembly.gauge_length);
  }
  /// Columns of the table of cycles after a run.
  std::map<std::string, std::vector<double>> cycles(SolverChoice solver) const
  {
    const auto run = make_run(solver, *scene.scene, specimen.assembly, loading, 1);
    RunRecord record;
    for (const double time : history_times(*scene.scene, loading)) {
      while (!run->ended() && !run->reached(time))
        run->work_towards(time);
      if (run->ended() && run->time() < time)
        break;
      record.history.push_back(run->response(time));
    }
    std::map<std::string, std::vector<double>> columns;
    for (const Column& column : cycle_columns(*scene.scene, record))
      columns[column.name] = column.values;
    return columns;
  }
  /// Strain in percent under a stress of 1 Pa for a time, or since a time.
  double strain(double time) const
  {
    const dem::Assembly& a = specimen.assembly;
    return time < 0 ? 0
                    : 100 * a.area * dem::creep_compliance(a.laws[0].creep, time) / a.gauge_length;
  }
};

std::vector<long> recorded(const Settings& settings)
{
  const LoadedScene scene = scenes::load("", settings);
  EXPECT_FALSE(scene.has_errors());
  return recorded_cycles(*scene.scene);
}

const Settings blocks{"Loading/Test = block pulses", "Loading/Peak stress = 100 kPa",
                      "Loading/Contact share = 0.1", "Loading/Loading time = 2 s",
                      "Loading/Rest time = 3 s",     "Loading/Cycles = 12",
                      "Strength/Distribution = none"};

} // namespace

TEST(Cycles, AreAllRecordedIfThereAreNotTooMany)
{
  const std::vector<long> found = recorded({"Loading/Test = sine", "Loading/Cycles = 200"});
  ASSERT_EQ(found.size(), 200u);
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_EQ(found[k], long(k) + 1);
}

TEST(Cycles, AreRecordedInGrowingStepsIfThereAreMany)
{
  const std::vector<long> found = recorded({"Loading/Test = haversine", "Loading/Cycles = 10000"});
  ASSERT_EQ(found.size(), 200u);
  EXPECT_EQ(found.back(), 10000);
  for (long k = 1; k <= 20; ++k)
    EXPECT_EQ(found[std::size_t(k) - 1], k);
  for (std::size_t k = 1; k < found.size(); ++k)
    EXPECT_LE(double(found[k]), std::max(1.06 * double(found[k - 1]), double(found[k - 1]) + 1));
  EXPECT_EQ(recorded({"Loading/Test = haversine", "Loading/Cycles = 10000",
                      "Output/Spacing = linear", "Output/History times = 4"}),
            (std::vector<long>{2500, 5000, 7500, 10000}));
}

TEST(Cycles, AreSeenAtAllPointsOfTheLoad)
{
  const Case c({"Loading/Test = haversine", "Loading/Cycles = 3", "Loading/Points per pulse = 4"});
  const std::vector<double> times = history_times(*c.scene.scene, c.loading);
  ASSERT_EQ(times.size(), 1u + 3 * 7);
  const double first[] = {0, 0.025, 0.05, 0.075, 0.1, 0.15625, 0.325, 1, 1.025};
  for (std::size_t k = 0; k < std::size(first); ++k)
    EXPECT_NEAR(times[k], first[k], 1e-15);
  EXPECT_EQ(times.back(), 3);
}

TEST(Cycles, OfBlocksFollowTheClosedForm)
{
  const Case c(blocks);
  for (const SolverChoice solver : {SolverChoice::linear, SolverChoice::events}) {
    const auto found = c.cycles(solver);
    ASSERT_EQ(found.at("cycle").size(), 12u);
    for (std::size_t n = 0; n < 12; ++n) {
      const auto expected = [&](double time) {
        double sum = 10e3 * c.strain(time);
        for (std::size_t k = 0; k <= n; ++k)
          sum += 90e3 * (c.strain(time - 5.0 * double(k)) -
                         (time > 5.0 * double(k) + 2 ? c.strain(time - 5.0 * double(k) - 2) : 0));
        return sum;
      };
      const double end = 5.0 * double(n + 1), peak = expected(end - 3), rest = expected(end);
      EXPECT_EQ(found.at("time_s")[n], end);
      EXPECT_NEAR(found.at("peak_strain_percent")[n], peak, 1e-10 * peak);
      EXPECT_NEAR(found.at("permanent_strain_percent")[n], rest, 1e-10 * rest);
      EXPECT_NEAR(found.at("resilient_strain_percent")[n], peak - rest, 1e-9 * peak);
    }
  }
}

TEST(Cycles, UnderTensionHaveTheirPeaksOnTheOtherSide)
{
  Settings tension = blocks;
  tension[1] = "Loading/Peak stress = -100 kPa";
  const auto pushed = Case(blocks).cycles(SolverChoice::linear);
  const auto pulled = Case(tension).cycles(SolverChoice::linear);
  for (const char* name : {"peak", "permanent", "resilient"})
    for (std::size_t n = 0; n < 12; ++n)
      EXPECT_EQ(pulled.at(std::string(name) + "_strain_percent")[n],
                -pushed.at(std::string(name) + "_strain_percent")[n]);
}

TEST(Cycles, LeaveThePermanentStrainOfTheDashpotAfterLongRests)
{
  // Kelvin branches recover between the pulses; the dashpot keeps half of amplitude x time.
  const Case c({"Loading/Test = haversine", "Loading/Cycles = 5", "Loading/Contact share = 0",
                "Loading/Rest time = 2000 s", "Loading/Points per pulse = 4"});
  const dem::Assembly& a = c.specimen.assembly;
  const double per_cycle =
      100 * 600e3 * a.area * 0.05 / *a.laws[0].creep.maxwell_viscosity / a.gauge_length;
  const auto found = c.cycles(SolverChoice::linear);
  for (int n = 0; n < 5; ++n)
    EXPECT_NEAR(found.at("permanent_strain_percent")[std::size_t(n)], (n + 1) * per_cycle,
                1e-9 * per_cycle);
}

TEST(Cycles, ThatWereNotCompletedAreLeftOut)
{
  Settings settings = blocks;
  settings.push_back("Loading/Strain limit = 1 %");
  const Case endless(blocks);
  const auto all = endless.cycles(SolverChoice::events);
  const double limit = all.at("peak_strain_percent")[6];
  settings.back() = "Loading/Strain limit = " + std::to_string(limit) + " %";
  const auto some = Case(settings).cycles(SolverChoice::events);
  EXPECT_NEAR(double(some.at("cycle").size()), 6.5, 0.6);
  EXPECT_LT(some.at("cycle").size(), 8u);
}

TEST(Cycles, AreATableOfTheResult)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Finished done = command::mastic(
      folder, command::with({"run", "net.scene", "--quiet"},
                            {"Loading/Test = haversine", "Loading/Cycles = 30",
                             "Loading/Peak stress = 100 kPa", "Output/Folder = out"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const std::string table = folder.read("out/cycles.csv");
  EXPECT_TRUE(table.starts_with("cycle,time_s,peak_strain_percent,permanent_strain_percent,"
                                "resilient_strain_percent,broken_bonds\n1,1,"));
  EXPECT_EQ(std::ranges::count(table, '\n'), 31);
  EXPECT_EQ(command::mastic(folder, {"export", "out", "cycles"}).output, table);
}
