#include "apps/study_reference.h"
#include "apps/work_precision.h"
#include "tests/apps/command.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace apps;
using command::contains;

namespace {

/// A finished run that takes so long and is so wrong.
StudyRow row(const std::string& solver, double value, double time, double error)
{
  StudyRow r;
  r.rung = {solver, solver == "dynamic" ? "viscosity scaling" : "", value, {}};
  if (solver == "dynamic")
    r.rung.settings = {"Dynamic/Viscosity scaling = " + std::to_string(value)};
  r.run.state = RunState::finished;
  r.run.solver_time = time;
  r.run.n_repetitions = 1;
  r.curve = RunCurve{"strain", {0, 1, 2}, {0, 1 + error, 2 + 2 * error}, {0, 0, 0}, std::nullopt};
  return r;
}

/// Three settings of one solver beside the exact one.
std::vector<StudyRow> measured()
{
  std::vector<StudyRow> rows{row("events", 0, 30, 0), row("dynamic", 1e-5, 1, 0.05),
                             row("dynamic", 1e-4, 10, 0.005), row("dynamic", 1e-3, 100, 0.0005)};
  measure_errors(rows, rows.front().rung);
  return rows;
}

LoadedScene scene(const std::vector<std::string>& settings = {})
{
  return load_scene_text("", "test", ".", settings);
}

} // namespace

TEST(WorkPrecision, MeasuresAllRowsAgainstTheReference)
{
  const std::vector<StudyRow> rows = measured();
  EXPECT_TRUE(rows[0].is_reference);
  EXPECT_FALSE(rows[1].is_reference);
  EXPECT_EQ(rows[0].errors.largest, 0);
  EXPECT_NEAR(*rows[1].errors.largest, 0.05, 1e-14);
  EXPECT_NEAR(*rows[3].errors.at_end, 0.0005, 1e-14);
}

TEST(WorkPrecision, CheapestIsTheFastestThatIsExactEnough)
{
  const std::vector<StudyRow> rows = measured();
  EXPECT_EQ(cheapest(rows, 0.1), &rows[1]);
  EXPECT_EQ(cheapest(rows, 0.01), &rows[2]);
  EXPECT_EQ(cheapest(rows, 0.001), &rows[0]) << "the reference itself is faster than the last";
  EXPECT_EQ(cheapest_text(rows),
            "  within 10 %: dynamic, viscosity scaling 1e-05, 1 s (error 5 %)\n"
            "  within 1 %: dynamic, viscosity scaling 0.0001, 10 s (error 0.5 %)\n"
            "  within 0.1 %: events, 30 s (the reference)\n");
}

TEST(WorkPrecision, NothingIsCheapestIfNothingIsExactEnough)
{
  const std::vector<StudyRow> all = measured(), rows(all.begin() + 1, all.begin() + 3);
  EXPECT_EQ(cheapest(rows, 0.001), nullptr);
  EXPECT_TRUE(contains(cheapest_text(rows), "within 0.1 %: none of these settings\n"));
}

TEST(WorkPrecision, RunsThatDidNotFinishAreNotCheap)
{
  std::vector<StudyRow> rows = measured();
  rows[1].run.state = RunState::over_budget;
  EXPECT_EQ(cheapest(rows, 0.1), &rows[2]);
}

TEST(WorkPrecision, RuptureMustAgree)
{
  std::vector<StudyRow> rows = measured();
  rows[0].curve->rupture_time = 2.5;
  for (StudyRow& each : rows)
    each.curve->rupture_time = 2.5;
  rows[1].curve->rupture_time.reset();
  rows[2].curve->rupture_time = 2.6;
  measure_errors(rows, rows[0].rung);
  EXPECT_FALSE(meets(rows[1], 0.1)) << "it does not rupture";
  EXPECT_TRUE(meets(rows[2], 0.1));
  EXPECT_FALSE(meets(rows[2], 0.01)) << "it ruptures four percent late";
  EXPECT_TRUE(meets(rows[3], 0.001));
}

TEST(WorkPrecision, TableHasUnitsInTheNamesOfItsColumns)
{
  std::vector<StudyRow> rows = measured();
  rows[1].run.state = RunState::refused;
  rows[1].run.message = "laws differ, so \"no\"";
  rows[1].curve.reset();
  const std::string csv = study_csv(rows, {rows[0].rung, "exact", 0.002}, {"net", "a machine", 2});
  const std::vector<std::string> lines = [&] {
    std::vector<std::string> all;
    for (std::size_t begin = 0, end; (end = csv.find('\n', begin)) != std::string::npos;
         begin = end + 1)
      all.push_back(csv.substr(begin, end - begin));
    return all;
  }();
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_TRUE(contains(lines[0], ",solver_wall_time_s,whole_wall_time_s,"));
  EXPECT_TRUE(contains(lines[0], ",largest_error_percent,"));
  EXPECT_TRUE(lines[1].starts_with("events,,,,finished,1,30,"));
  EXPECT_TRUE(contains(lines[1], ",0.1 %,2,a machine,"));
  EXPECT_TRUE(contains(lines[2], ",does not apply,"));
  EXPECT_TRUE(lines[2].ends_with(",\"laws differ, so \"\"no\"\"\"")) << lines[2];
  EXPECT_TRUE(contains(lines[3], ",10 %; 1 %,"));
  EXPECT_TRUE(contains(study_table(rows), "  dynamic: does not apply: laws differ, so \"no\"\n"));
}

TEST(StudyReference, IsTheCheapestSolverThatIsExact)
{
  std::vector<StudyRow> rows{row("linear", 0, 1, 0), row("events", 0, 2, 0)};
  for (StudyRow& each : rows)
    each.motion = 0.01;
  EXPECT_EQ(exact_reference(rows, scene())->rung.solver, "linear");
  rows[1].curve->n_broken.back() = 3;
  EXPECT_EQ(exact_reference(rows, scene())->rung.solver, "events");
  EXPECT_EQ(exact_reference(rows, scene())->left_out, 0.01);
  rows[0].motion = rows[1].motion = 0.05;
  EXPECT_FALSE(exact_reference(rows, scene())) << "the displacements are not small";
  EXPECT_TRUE(exact_reference(rows, scene({"Quasistatic/Geometry = small"})));
  rows.pop_back();
  rows[0].motion = 0.01;
  EXPECT_FALSE(exact_reference(rows, scene())) << "bonds may break";
  EXPECT_TRUE(exact_reference(rows, scene({"Strength/Distribution = none"})));
}

TEST(StudyReference, OfASolverWithAKnobIsItsMostExactSetting)
{
  const std::vector<StudyRow> rows = measured();
  EXPECT_EQ(named_reference(rows, "dynamic")->rung.value, 1e-3);
  EXPECT_FALSE(named_reference(rows, "quasistatic"));
}

TEST(SolverLadder, GoesFromCheapToExact)
{
  LadderOptions options;
  options.scalings = {1e-3, 1e-5, 1e-4};
  const std::vector<Ladder> ladders = solver_ladders(*scene().scene, options);
  ASSERT_EQ(ladders.size(), 5u);
  EXPECT_EQ(ladders[0].front().text(), "linear");
  EXPECT_EQ(ladders[1].front().text(), "events");
  EXPECT_EQ(ladders[2].front().text(), "quasistatic, strain per step 0.008");
  EXPECT_EQ(ladders[2].front().settings[1], "Quasistatic/Error tolerance = 0.016");
  EXPECT_EQ(ladders[3].front().text(), "quasistatic, breakage batch 256");
  EXPECT_EQ(ladders[4].front().value, 1e-5);
  EXPECT_EQ(ladders[4].back().value, 1e-3);
  EXPECT_EQ(solver_ladders(*scene({"Strength/Distribution = none"}).scene, options).size(), 4u);
}

TEST(SolverLadder, EqualSettingsShareAFolder)
{
  const std::vector<Ladder> ladders = solver_ladders(*scene().scene, {});
  EXPECT_EQ(ladders[2][4].folder(), ladders[3][2].folder()) << "the scene's own step and batch";
  EXPECT_NE(ladders[2][4].folder(), ladders[2][5].folder());
  const Rung finest = apps::finest(*scene().scene);
  EXPECT_EQ(finest.settings, (std::vector<std::string>{"Quasistatic/Strain per step = 5e-05",
                                                       "Quasistatic/Error tolerance = 0.0001",
                                                       "Quasistatic/Breakage batch = 1"}));
}

TEST(SolverLadder, RefusesSolversThatAreNotThere)
{
  LadderOptions options;
  options.solvers = {"linear", "event"};
  try {
    solver_ladders(*scene().scene, options);
    FAIL();
  } catch (const std::invalid_argument& problem) {
    EXPECT_TRUE(contains(problem.what(), "did you mean 'events'?")) << problem.what();
  }
}
