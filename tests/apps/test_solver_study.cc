#include "tests/apps/interrupted.h"

#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

using Row = std::map<std::string, std::string>;

std::vector<std::string> cells(const std::string& line)
{
  std::vector<std::string> found(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      found.emplace_back();
    else
      found.back() += c;
  }
  return found;
}

/// The rows of a study by solver and value: "dynamic 0.001".
std::map<std::string, Row> rows(const std::string& text)
{
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = cells(line);
  std::map<std::string, Row> found;
  while (std::getline(lines, line)) {
    const std::vector<std::string> values = cells(line);
    Row row;
    for (std::size_t k = 0; k < names.size(); ++k)
      row[names[k]] = values.at(k);
    found[row["value"].empty() ? row["solver"] : row["solver"] + " " + row["value"]] = row;
  }
  return found;
}

double number(const Row& row, const std::string& column)
{
  return std::stod(row.at(column));
}

/// A study of the lattice for ten seconds of creep.
std::vector<std::string> study(const std::vector<std::string>& options,
                               const std::vector<std::string>& settings = {})
{
  std::vector<std::string> arguments{"study", "--quiet"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  arguments.push_back("net.scene"); // last: options with several values must not take it
  return with(with(arguments, {"Loading/End time = 10 s", "Output/History times = 20"}), settings);
}

} // namespace

TEST(SolverStudy, ExplicitSolverConvergesToTheClosedForm)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Finished done = mastic(
      folder,
      study({"--solvers", "linear,events,dynamic", "--scalings", "1e-3,1e-5,1e-4"},
            {"Loading/Axial stress = 1 kPa", "Output/Plots = true", "Output/First time = 1 s"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "reference: linear: closed form, for no bond breaks;"));
  EXPECT_TRUE(contains(done.output, "\n  within 10 %: "));
  EXPECT_TRUE(folder.has("results/net-study/work_precision.png")) << done.output;
  EXPECT_FALSE(folder.has("results/net"));

  std::map<std::string, Row> found = rows(folder.read("results/net-study/study.csv"));
  ASSERT_EQ(found.size(), 5u);
  EXPECT_EQ(found["linear"]["is_reference"], "1");
  EXPECT_EQ(number(found["linear"], "largest_error_percent"), 0);
  EXPECT_LT(number(found["events"], "largest_error_percent"), 1e-8);
  double last = 1e9;
  for (const char* scaling : {"1e-05", "0.0001", "0.001"}) {
    const Row& row = found[std::string("dynamic ") + scaling];
    const double error = number(row, "largest_error_percent");
    EXPECT_LT(error, 0.5 * last) << scaling;
    EXPECT_EQ(row.at("which_rupture"), "neither");
    EXPECT_GT(number(row, "whole_wall_time_s"), number(row, "solver_wall_time_s"));
    EXPECT_EQ(number(row, "unknowns"), number(found["dynamic 1e-05"], "unknowns"));
    EXPECT_EQ(row.at("threads"), "1");
    EXPECT_NE(row.at("machine"), "");
    last = error;
  }
  EXPECT_LT(last, 2);
  EXPECT_NEAR(number(found["dynamic 0.001"], "steps") / number(found["dynamic 0.0001"], "steps"),
              10, 0.1);
  EXPECT_EQ(found["linear"]["solves"], "1");
}

TEST(SolverStudy, EventsAreTheReferenceWhereBondsBreak)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Finished done =
      mastic(folder, study({"--solvers", "linear,dynamic", "--scalings", "1e-3", "--repeat", "2"},
                           {"Loading/Axial stress = 400 kPa"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "reference: events: exact from breakage to breakage;"));
  EXPECT_FALSE(folder.has("results/net-study/work_precision.png")) << "the scene wants no plots";
  std::map<std::string, Row> found = rows(folder.read("results/net-study/study.csv"));
  ASSERT_EQ(found.size(), 3u) << "the reference is a row even if it was not asked for";
  EXPECT_GT(number(found["events"], "broken_bonds"), 0);
  EXPECT_EQ(number(found["linear"], "error_of_broken_bonds_percent"), 100);
  EXPECT_EQ(found["dynamic 0.001"]["repetitions"], "2");
  EXPECT_LT(number(found["dynamic 0.001"], "error_of_broken_bonds_percent"), 100);
}

TEST(SolverStudy, ListsWhatDoesNotApplyAndWhatTakesTooLong)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Finished done =
      mastic(folder, study({"--solvers", "events,dynamic", "--reference", "dynamic", "--scalings",
                            "1e-5,0.5,1", "--budget", "2 s"},
                           {"Bonds/After breakage = friction"}));
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "\n  events: does not apply: After breakage: friction needs"))
      << done.output;
  EXPECT_TRUE(
      contains(done.output, "\n  dynamic, viscosity scaling 0.5: over budget: ended after"));
  EXPECT_TRUE(contains(done.output, "\n  dynamic, viscosity scaling 1: not started: the setting "
                                    "before it took too long\n"));
  EXPECT_TRUE(contains(done.output, "reference: dynamic, viscosity scaling 1e-05: "));
  EXPECT_FALSE(folder.has("results/net-study/dynamic-1"));
  EXPECT_FALSE(folder.has("results/net-study/dynamic-0.5/result.h5"));
  EXPECT_FALSE(folder.has("results/net-study/dynamic-0.5/checkpoint.h5"));
  std::map<std::string, Row> found = rows(folder.read("results/net-study/study.csv"));
  EXPECT_EQ(found["dynamic 0.5"]["state"], "over budget");
  EXPECT_EQ(found["dynamic 0.5"]["largest_error_percent"], "");
}

TEST(SolverStudy, GoesOnAfterAnInterruption)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const std::vector<std::string> begun =
      study({"--solvers", "linear,dynamic", "--scalings", "1e-5,1", "--budget", "2 s"},
            {"Loading/Axial stress = 1 kPa"});
  std::vector<std::string> patient = begun;
  for (std::string& word : patient)
    if (word == "2 s")
      word = "600 s";
  const apps::Child child = apps::start_child(command::line(folder, patient));
  interrupted::wait_until(
      [&] { return folder.has("results/net-study/dynamic-1/dynamic-1.scene"); });
  ::kill(child.pid, SIGINT);
  const Finished first = apps::read_to_end(child);
  EXPECT_EQ(first.exit_code, 4) << first.output;
  EXPECT_TRUE(contains(first.output, "net: interrupted; to go on, start the same study again: runs "
                                     "that have finished are kept in results/net-study\n"));
  EXPECT_FALSE(folder.has("results/net-study/dynamic-1/checkpoint.h5"));

  const std::string before = folder.read("results/net-study/dynamic-1e-05/times.csv");
  const Finished second = mastic(folder, begun);
  EXPECT_EQ(second.exit_code, 0) << second.output;
  EXPECT_TRUE(contains(second.output, "  linear: solved in "));
  EXPECT_TRUE(contains(second.output, "dynamic, viscosity scaling 1e-05: solved in "));
  EXPECT_TRUE(contains(second.output, ", kept from before\n"));
  EXPECT_EQ(folder.read("results/net-study/dynamic-1e-05/times.csv"), before);

  const Finished third =
      mastic(folder, study({"--solvers", "linear"}, {"Loading/Axial stress = 2 kPa"}));
  EXPECT_EQ(third.exit_code, 0) << third.output;
  EXPECT_FALSE(contains(third.output, "kept from before")) << "the scene is another";
}

TEST(SolverStudy, RefusesWhatItCannotDo)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Finished solver = mastic(folder, study({"--solvers", "linear,dynamics"}));
  EXPECT_EQ(solver.exit_code, 2);
  EXPECT_EQ(solver.output, "error: there is no solver 'dynamics'; solvers: linear, events, "
                           "quasistatic, dynamic; did you mean 'dynamic'?\n");
  EXPECT_EQ(mastic(folder, study({"--budget", "3 m"})).exit_code, 2);
  EXPECT_EQ(mastic(folder, study({"--reference", "truth"})).exit_code, 2);
  EXPECT_EQ(mastic(folder, {"study", "none.scene"}).exit_code, 2);
  EXPECT_FALSE(folder.has("results"));
}
