#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

/// A packing of a few spheres of nearly one size, quickly made.
const std::string small_packing = "subsection Specimen\n  set Particles = 75\n"
                                  "  set Diameter = 13 mm\n  set Height = 26 mm\n"
                                  "  set Grading = table\n"
                                  "  set Grading table = 3 mm: 0 %, 5 mm: 100 %\n"
                                  "  set Solid fraction = 0.6\nend\n"
                                  "subsection Output\n  set Plots = false\n"
                                  "  set History times = 3\nend\n"
                                  "subsection Strength\n  set Distribution = none\nend\n";

void expect_error(const command::Folder& folder, const std::vector<std::string>& arguments,
                  const std::string& message)
{
  const Finished done = mastic(folder, arguments);
  EXPECT_EQ(done.exit_code, 2) << done.output;
  EXPECT_EQ(done.output, message);
}

} // namespace

TEST(Command, RefusesUnknownVerbsOptionsAndFiles)
{
  const command::Folder folder;
  const std::string verbs = "; verbs: run, study, extract, calibrate, fit, check, pack, new, plot, "
                            "report, picture, keys, "
                            "export, info, card, point\n";
  expect_error(folder, {"runn"}, "error: there is no verb 'runn'; did you mean 'run'?" + verbs);
  expect_error(folder, {},
               "error: say what to do: run, study, extract, calibrate, fit, check, pack, new, "
               "plot, report, picture, keys, "
               "export, info, card, point; or see mastic --help\n");
  expect_error(folder, {"run", "a.scene", "--set", "Loading/End", "time = 5 s"},
               "error: The following argument was not expected: time = 5 s; settings need quotes: "
               "--set \"Loading/Axial stress = 500 kPa\"\n");
  expect_error(folder, {"help"}, "error: there is no verb 'help'" + verbs);
  expect_error(folder, {"run"}, "error: run needs either a scene file or --resume\n");
  expect_error(folder, {"run", "none.scene"}, "error: none.scene: there is no such file\n");
  expect_error(folder, {"check", "none.scene"}, "error: none.scene: there is no such file\n");
  expect_error(folder, {"check", "."}, "error: . is a folder, not a file\n");
  expect_error(folder, {"info", "."}, "error: .: there is no result.h5 in it\n");
  expect_error(folder, {"plot", "."}, "error: .: there are no results in it\n");
  expect_error(folder, {"run", "--resume", "none"}, "error: none: there is no such file\n");
  expect_error(
      folder, {"new", "kreep"},
      "error: there is no kind 'kreep' of scene; kinds: constant-rate, continuum, creep, cycles, "
      "dynamic, history, network, study; did you mean 'creep'?\n");
  folder.write("text.h5", "no HDF5");
  expect_error(folder, {"info", "text.h5"},
               "error: text.h5: this is not an HDF5 file, or it is damaged\n");
  const std::vector<std::vector<std::string>> incomplete{
      {"run", "--frobnicate"}, {"run", "a", "--threads", "two"}, {"check"}, {"export", "a"}};
  for (const std::vector<std::string>& arguments : incomplete)
    EXPECT_EQ(mastic(folder, arguments).exit_code, 2);
}

TEST(Command, ChecksItsOwnNewScenes)
{
  const command::Folder folder;
  networks::write_pair(folder);
  folder.write("particles.csv",
               "x_mm,y_mm,z_mm,r_mm,held,fz_N\n0,0,2,2,bottom,0\n0,0,6,2,free,-1\n");
  for (const std::string kind :
       {"creep", "constant-rate", "history", "cycles", "network", "dynamic", "study"}) {
    const Finished made = mastic(folder, {"new", kind});
    ASSERT_EQ(made.exit_code, 0);
    folder.write(kind + ".scene", made.output);
    const Finished check = mastic(folder, {"check", kind + ".scene"});
    EXPECT_EQ(check.exit_code, 0) << check.output;
    EXPECT_EQ(check.output, kind + ".scene: no errors, 0 warning(s)\n");
  }
  std::filesystem::remove(folder / "particles.csv");
  const Finished check = mastic(folder, {"check", "network.scene"});
  EXPECT_EQ(check.exit_code, 2);
  EXPECT_TRUE(contains(check.output, "particles.csv cannot be read")) << check.output;
}

TEST(Pack, MakesAPackingThatARunTakes)
{
  const command::Folder folder;
  folder.write("a.scene", small_packing);
  const Finished pack = mastic(folder, {"pack", "a.scene"});
  ASSERT_EQ(pack.exit_code, 0) << pack.output;
  EXPECT_TRUE(contains(pack.output, "  particles                      75\n")) << pack.output;
  EXPECT_TRUE(contains(pack.output, "written to a.packing.h5\n"));
  const Finished with_packing = mastic(
      folder, with({"run", "a.scene", "--packing", "a.packing.h5"}, {"Output/Folder = one"}));
  ASSERT_EQ(with_packing.exit_code, 0) << with_packing.output;
  const Finished without = mastic(folder, with({"run", "a.scene"}, {"Output/Folder = two"}));
  ASSERT_EQ(without.exit_code, 0) << without.output;
  EXPECT_EQ(folder.read("one/history.csv"), folder.read("two/history.csv"));

  const Finished csv = mastic(folder, {"pack", "a.scene", "-o", "a.csv"});
  ASSERT_EQ(csv.exit_code, 0) << csv.output;
  EXPECT_EQ(std::ranges::count(folder.read("a.csv"), '\n'), 76);
  const Finished from_file = mastic(
      folder, with({"check", "a.scene"}, {"Specimen/Source = file", "Specimen/File = a.csv"}));
  EXPECT_EQ(from_file.exit_code, 0) << from_file.output;
  const Finished info = mastic(folder, {"info", "a.packing.h5"});
  EXPECT_TRUE(contains(info.output, "a.packing.h5: packing\n  generated, seed 1\n")) << info.output;
}

TEST(Pack, RefusesWhatDoesNotFit)
{
  const command::Folder folder;
  folder.write("a.scene", small_packing);
  networks::write_pair(folder);
  ASSERT_EQ(mastic(folder, {"pack", "a.scene"}).exit_code, 0);
  expect_error(folder, {"pack", "a.scene", "-o", "a.txt"},
               "error: a.txt: packings are written as .h5 or .csv\n");
  expect_error(folder, {"pack", "net.scene"},
               "error: pack makes packings: the scene needs Source = generate\n");
  expect_error(folder, {"run", "net.scene", "--packing", "a.packing.h5"},
               "error: --packing: the scene reads its particles from a file already (Source = "
               "file)\n");
  const Finished other =
      mastic(folder, with({"run", "a.scene", "--packing", "a.packing.h5"}, {"Specimen/Seed = 2"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_TRUE(contains(other.output,
                       "error: a.packing.h5: this packing was made from other keys of "
                       "the section Specimen than the scene has"))
      << other.output;
}
