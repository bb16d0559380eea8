#include "tests/apps/interrupted.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

const std::vector<std::string> stresses{"Study/Vary = Loading/Axial stress",
                                        "Study/Values = 1 kPa, -300 kPa, 0.8 MPa"};

std::vector<std::string> short_study(std::vector<std::string> settings)
{
  settings.insert(settings.begin(), {"Loading/End time = 10 s", "Output/History times = 5"});
  return with({"run", "net.scene", "--threads", "2"}, settings);
}

} // namespace

TEST(Study, RunsEachValueAsASceneOfItsOwn)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const Finished study = mastic(folder, short_study(stresses));
  ASSERT_EQ(study.exit_code, 0) << study.output;
  EXPECT_TRUE(contains(study.output, "net: study of 3 runs, 2 at a time\n"));
  EXPECT_TRUE(contains(study.output, "net: 3 of 3 runs finished, results in results/net\n"));
  const std::vector<std::string> found = folder.files("results/net");
  const std::set<std::string> files(found.begin(), found.end());
  std::set<std::string> expected{"runs.csv",    "statistics.csv", "study.h5",
                                 "study.scene", "summary.csv",    "variance.csv"};
  for (const std::string run : {"1-kPa", "run-300-kPa", "0.8-MPa"})
    for (const std::string& name :
         {run + ".scene", std::string("run.log"), std::string("result.h5"),
          std::string("history.csv"), std::string("breakages.csv")})
      expected.insert(run + "/" + name);
  expected.insert("1-kPa/complex_modulus.csv"); // no bond breaks there
  EXPECT_EQ(files, expected);
  EXPECT_EQ(folder.files().size(), expected.size() + 3) << "something was left beside the scene";

  const Finished single = mastic(
      folder, with(short_study({"Loading/Axial stress = 0.8 MPa"}), {"Output/Folder = single"}));
  ASSERT_EQ(single.exit_code, 0) << single.output;
  EXPECT_EQ(folder.read("single/history.csv"), folder.read("results/net/0.8-MPa/history.csv"));
  EXPECT_TRUE(contains(mastic(folder, {"info", "results/net/0.8-MPa"}).output,
                       "  name                 0.8-MPa\n"));
}

TEST(Study, FindsFilesThatItVaries)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  folder.write("other.csv", "a,b\n0,1\n");
  const Finished study = mastic(folder, short_study({"Study/Vary = Specimen/Bond file",
                                                     "Study/Values = bonds.csv, other.csv"}));
  EXPECT_EQ(study.exit_code, 2);
  EXPECT_TRUE(contains(study.output, "net: 1 of 2 runs finished, results in results/net\n"));
  EXPECT_TRUE(contains(study.output, "error: the specimen cannot carry the load: "))
      << study.output;
  EXPECT_TRUE(folder.has("results/net/bonds.csv/result.h5"));
  EXPECT_FALSE(folder.has("results/net/other.csv/result.h5"));
}

TEST(Study, SharesOnePackingUnlessItVariesIt)
{
  const command::Folder folder;
  folder.write("a.scene", "subsection Specimen\n  set Particles = 75\n  set Diameter = 13 mm\n"
                          "  set Height = 26 mm\n  set Grading = table\n"
                          "  set Grading table = 3 mm: 0 %, 5 mm: 100 %\n"
                          "  set Solid fraction = 0.6\nend\n"
                          "subsection Output\n  set Plots = false\n  set ParaView = false\n"
                          "  set History times = 3\nend\n"
                          "subsection Strength\n  set Distribution = none\nend\n");
  const Finished made = mastic(folder, {"pack", "a.scene", "-o", "a.h5"});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  const std::vector<std::string> temperatures{"Temperature/Shift law = WLF",
                                              "Study/Vary = Temperature/Temperature",
                                              "Study/Values = 10 degC, 30 degC"};
  const Finished study =
      mastic(folder, with({"run", "a.scene", "--packing", "a.h5"}, temperatures));
  EXPECT_EQ(study.exit_code, 0) << study.output;
  EXPECT_FALSE(folder.has("results/a/packing.h5"));
  const Finished own = mastic(folder, with({"run", "a.scene"}, temperatures));
  EXPECT_EQ(own.exit_code, 0) << own.output;
  EXPECT_TRUE(folder.has("results/a/packing.h5"));
  const Finished seeds =
      mastic(folder, with({"run", "a.scene", "--packing", "a.h5"},
                          {"Study/Vary = Specimen/Seed", "Study/Values = 1, 2"}));
  EXPECT_EQ(seeds.exit_code, 2);
  EXPECT_TRUE(
      contains(seeds.output, "error: --packing: the runs of this study do not share a packing\n"));
}

TEST(Study, SaysWhichValuesAreWrongBeforeItBegins)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  const std::vector<std::string> wrong{"Study/Vary = Loading/Axial stress",
                                       "Study/Values = 400 kPa, 5 m, much"};
  const std::string message =
      "Study: error: run '5 m': Axial stress = 5 m: 'm' cannot be converted to kPa; expected: in "
      "kPa\nStudy: error: run 'much': Axial stress = much: 'much' does not begin with a number; "
      "expected: in kPa\n";
  const Finished run = mastic(folder, short_study(wrong));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.output, message);
  const Finished check = mastic(folder, with({"check", "net.scene"}, wrong));
  EXPECT_EQ(check.exit_code, 2);
  EXPECT_TRUE(contains(check.output, message)) << check.output;
  const Finished key =
      mastic(folder, short_study({"Study/Vary = Loading/Axial stres", "Study/Values = 400 kPa"}));
  EXPECT_EQ(key.exit_code, 2);
  EXPECT_EQ(key.output, "Study: error: run '400 kPa': there is no key 'Axial stres' in section "
                        "'Loading'; did you mean 'Axial stress'?\n");
  const Finished together =
      mastic(folder, short_study({"Study/Vary = Loading/End time", "Study/Values = 10 s, 5 s",
                                  "Loading/Release time = 7 s"}));
  EXPECT_EQ(together.exit_code, 2);
  EXPECT_EQ(together.output,
            "Study: error: run '5 s': Release time: must come before the End time\n");
  EXPECT_FALSE(folder.has("results"));
}

TEST(Study, GoesOnAfterAnInterruption)
{
  const command::Folder whole, parts;
  interrupted::write_long_scene(whole, "events");
  interrupted::write_long_scene(parts, "events");
  const std::vector<std::string> seeds{"Study/Vary = Bonds/After breakage",
                                       "Study/Values = leave, pressed"};
  const std::vector<std::string> run{"run", "long-0.5.scene", "--threads", "1"};
  const Finished reference = mastic(whole, with(run, seeds));
  ASSERT_EQ(reference.exit_code, 0) << reference.output;

  const std::string folder = "results/long-0.5", checkpoint = "/checkpoint.h5";
  const Finished first = interrupted::stopped(parts, with(with(run, seeds), {interrupted::slow}),
                                              folder + "/leave" + checkpoint, 3, SIGTERM);
  EXPECT_EQ(first.exit_code, 4) << first.output;
  EXPECT_TRUE(
      contains(first.output, "long-0.5: interrupted; to go on: mastic run --resume " + folder));
  EXPECT_TRUE(contains(first.output, "leave: interrupted at t = "));
  EXPECT_FALSE(parts.has(folder + "/pressed/result.h5"));

  const std::vector<std::string> resume{"run", "--resume", folder, "--threads", "1"};
  const Finished second = interrupted::stopped(parts, with(resume, {interrupted::slow}),
                                               folder + "/leave" + checkpoint, 3, SIGINT);
  EXPECT_EQ(second.exit_code, 4) << second.output;
  const Finished last = mastic(parts, with(resume, {interrupted::quick}));
  EXPECT_EQ(last.exit_code, 0) << last.output;
  for (const std::string run_name : {"leave", "pressed"})
    for (const std::string table : {"/history.csv", "/breakages.csv"})
      EXPECT_EQ(parts.read(folder + "/" + run_name + table),
                whole.read(folder + "/" + run_name + table));
  EXPECT_NE(whole.read(folder + "/leave/history.csv"), whole.read(folder + "/pressed/history.csv"));

  const Finished again = mastic(parts, resume);
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_TRUE(contains(again.output, "leave: finished before\npressed: finished before\n"));
  const Finished other = mastic(parts, with(resume, {"Loading/Strain limit = 5 %"}));
  EXPECT_EQ(other.exit_code, 2);
}
