#include "tests/apps/body_runs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using apps::Finished;
using body_runs::column;
using body_runs::on_two_ranks;
using command::contains;
using command::mastic;
using command::with;

namespace {

const std::string scene = R"(set Solver = continuum
subsection Specimen
  set Solid fraction = 0.62
  set Mean contacts = 6
  set Grading = table
  set Grading table = 2 mm: 0 %, 4 mm: 100 %
end
subsection Body
  set Shape = box
  set Edges = 20 mm, 20 mm, 40 mm
  set Cell size = 20 mm
  set Material = adaptive
end
subsection Volumes
  set Particles = 40
  set Families = 2
  set Breakage tolerance = 1e-8
end
subsection Strength
  set Distribution = Weibull
  set Modulus = 3
  set Scale = 20 N
end
subsection Loading
  set Test = creep
  set Axial stress = 400 kPa
  set End time = 200 s
end
subsection Continuum
  set Order = 1
  set Solver tolerance = 1e-11
end
subsection Output
  set Plots = false
  set ParaView = false
  set History times = 12
  set Frequencies = none
end
)";

std::string of_material(const std::string& material)
{
  std::string other = scene;
  return other.replace(other.find("adaptive"), 8, material);
}

std::vector<double> strains(const command::Folder& folder, const std::string& run)
{
  return column(folder, "results/" + run + "/history.csv", "axial_strain", "1");
}

/// The last number of a column by its whole name.
double last(const command::Folder& folder, const std::string& run, const std::string& name,
            const std::string& file = "volumes.csv")
{
  return body_runs::numbers(folder, "results/" + run + "/" + file, name).back();
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, double tolerance)
{
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k)
    EXPECT_NEAR(a[k], b[k], tolerance * std::abs(a.back())) << k;
}

} // namespace

TEST(Volumes, AdaptiveIsAllLiveAndTheLawBreaksNothing)
{
  const command::Folder folder;
  folder.write("adaptive.scene", scene);
  folder.write("live.scene", of_material("all live"));
  folder.write("law.scene", of_material("law only"));
  for (const char* name : {"adaptive.scene", "live.scene", "law.scene"}) {
    const Finished done =
        mastic(folder, with({"run", name, "--quiet"}, {"Output/ParaView = true"}));
    ASSERT_EQ(done.exit_code, 0) << done.output;
  }
  const auto adaptive = strains(folder, "adaptive");
  expect_same(strains(folder, "live"), adaptive, 1e-8);
  EXPECT_EQ(last(folder, "adaptive", "broken_bonds"), last(folder, "live", "broken_bonds"));
  EXPECT_GT(last(folder, "adaptive", "broken_bonds"), 16);
  EXPECT_EQ(last(folder, "live", "live_points"), 16);
  EXPECT_GT(adaptive.back(), 1.001 * strains(folder, "law").back());
  EXPECT_FALSE(folder.has("results/law/volumes.csv"));
  EXPECT_TRUE(contains(folder.read("results/adaptive/paraview/body_0001.vtu"), "stiffness_loss"));
  EXPECT_EQ(last(folder, "adaptive", "broken_bonds", "history.csv"),
            last(folder, "adaptive", "broken_bonds"));
}

TEST(Volumes, TwoRanksBreakTheSameBonds)
{
  const command::Folder one, two;
  for (const command::Folder* folder : {&one, &two})
    folder->write("creep.scene", scene);
  ASSERT_EQ(mastic(one, {"run", "creep.scene", "--quiet"}).exit_code, 0);
  const Finished done = on_two_ranks(two, {"run", "creep.scene", "--quiet"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  expect_same(strains(one, "creep"), strains(two, "creep"), 1e-7);
  EXPECT_EQ(last(one, "creep", "broken_bonds"), last(two, "creep", "broken_bonds"));
}

TEST(Volumes, GoOnAfterAnInterruptionOnAnotherNumberOfRanks)
{
  const command::Folder whole, parts;
  for (const command::Folder* folder : {&whole, &parts})
    folder->write("creep.scene", scene);
  const std::vector<std::string> settings{
      "Loading/Test = constant rate", "Loading/Strain rate = 1e-4 1/s", "Loading/End strain = 1 %",
      "Continuum/Step tolerance = 1e-7"};
  ASSERT_EQ(mastic(whole, with({"run", "creep.scene", "--quiet"}, settings)).exit_code, 0);
  std::vector<std::string> slow = settings;
  slow.push_back(interrupted::slow);
  const Finished stopped =
      interrupted::stopped(parts, with({"run", "creep.scene", "--quiet"}, slow),
                           "results/creep/checkpoint.h5", 30, SIGTERM);
  ASSERT_EQ(stopped.exit_code, 4) << stopped.output;
  const Finished resumed =
      on_two_ranks(parts, with({"run", "--resume", "results/creep"}, {interrupted::quick}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  expect_same(strains(whole, "creep"), strains(parts, "creep"), 1e-7);
  EXPECT_EQ(last(whole, "creep", "broken_bonds"), last(parts, "creep", "broken_bonds"));
}

TEST(Volumes, StudiesTellTheScatterOfWhatBreaks)
{
  const command::Folder folder;
  folder.write("seeds.scene",
               scene + "subsection Study\n  set Vary = Loading/Axial stress; Strength/Seed\n"
                       "  set Values = 400 kPa; 1, 11, 21\nend\n");
  const Finished done = mastic(folder, {"run", "seeds.scene", "--quiet"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  const std::string summary = "results/seeds/summary.csv";
  std::vector<double> broken = body_runs::numbers(folder, summary, "broken_bonds");
  ASSERT_EQ(broken.size(), 3u);
  std::ranges::sort(broken);
  EXPECT_GT(broken[0], 16);
  EXPECT_EQ(body_runs::numbers(folder, summary, "bonds")[0], 16 * 120);
  const std::string statistics = folder.read("results/seeds/statistics.csv");
  EXPECT_TRUE(contains(statistics, fmt::format("broken_bonds_at_common_time,3,{:g},", broken[1])))
      << statistics;
}

TEST(Volumes, ABodyThatComesApartSaysWhenAndWhere)
{
  const command::Folder folder;
  folder.write("creep.scene", scene);
  const Finished done =
      mastic(folder, with({"run", "creep.scene", "--quiet"},
                          {"Strength/Scale = 2 N", "Bonds/After breakage = leave"}));
  EXPECT_EQ(done.exit_code, 5) << done.output;
  EXPECT_TRUE(contains(done.output, "no equilibrium at t = ")) << done.output;
  EXPECT_TRUE(contains(done.output, "most strained at (")) << done.output;
  EXPECT_TRUE(folder.has("results/creep/history.csv"));
  EXPECT_TRUE(contains(mastic(folder, {"info", "results/creep"}).output, "lost equilibrium"));
}

TEST(Volumes, ADamagedCheckpointIsRefused)
{
  const command::Folder folder;
  folder.write("creep.scene", scene);
  const Finished stopped = interrupted::stopped(
      folder,
      with({"run", "creep.scene", "--quiet"},
           {"Loading/Test = constant rate", "Loading/Strain rate = 1e-4 1/s",
            "Loading/End strain = 1 %", "Continuum/Step tolerance = 1e-8", interrupted::slow}),
      "results/creep/checkpoint.h5", 30, SIGTERM);
  ASSERT_EQ(stopped.exit_code, 4) << stopped.output;
  const std::string whole = folder.read("results/creep/checkpoint.h5");
  folder.write("results/creep/checkpoint.h5", whole.substr(0, whole.size() / 2));
  folder.write("results/creep/checkpoint.h5.previous", whole.substr(0, whole.size() / 3));
  const Finished resumed = mastic(folder, {"run", "--resume", "results/creep"});
  EXPECT_EQ(resumed.exit_code, 2) << resumed.output;
}

TEST(Volumes, BadInputIsOneClearError)
{
  struct Case {
    std::vector<std::string> settings;
    std::string message;
  };
  const command::Folder folder;
  folder.write("creep.scene", scene);
  const Case cases[] = {
      {{"Body/Law = some.law"}, "the law of volumes is their own"},
      {{"Bonds/After breakage = friction"}, "know friction with Volumes/Solver"},
      {{"Strength/Distribution = none"}, "need Material = law only"},
      {{"Body/Shape = cylinder", "Body/Section = meridian"}, "not the same around an axis"},
      {{"Continuum/Refinement times = 5 s"}, "cannot be carried over"},
      {{"Volume element/Source = cut"}, "must be periodic"},
      {{"Volumes/Softening = as it is", "Body/Cell size = 10 mm", "Volumes/Particles = 300"},
       "would dissipate by the mesh"},
      {{"Body/Material = adaptve"}, "adaptive"}};
  for (const Case& each : cases) {
    const Finished done = mastic(folder, with({"run", "creep.scene"}, each.settings));
    EXPECT_EQ(done.exit_code, 2) << each.message << '\n' << done.output;
    EXPECT_TRUE(contains(done.output, each.message)) << each.message << '\n' << done.output;
    EXPECT_FALSE(folder.has("results/creep/history.csv"));
    EXPECT_EQ(mastic(folder, with({"check", "creep.scene"}, each.settings)).exit_code, 2);
  }
}
