#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

/// Two bonded spheres under 100 kPa for 10 s with a law without dashpots: 1e-6 m/N.
const std::string elastic = networks::scene + R"(
subsection Bonds
  set Maxwell stiffness = 1e6 N/m
  set Maxwell viscosity = none
  set Kelvin stiffness  = none
  set Kelvin viscosity  = none
end
subsection Strength
  set Distribution = none
end
subsection Specimen
  set Gauge length = 4 mm
end
subsection Loading
  set Axial stress = 100 kPa
  set End time     = 10 s
end
)";

/// 100 kPa on a disk of 16 mm is 20.1 N, which shorten 4 mm by 20.1 um.
const std::string strain = "0.50265482457436691";

Finished run(const command::Folder& folder, const std::vector<std::string>& settings)
{
  networks::write_pair(folder);
  folder.write("net.scene", elastic);
  return mastic(folder, with({"run", "net.scene", "--quiet"}, settings));
}

} // namespace

TEST(Expect, SaysWhatIsMetAndKeepsTheExitCode)
{
  const command::Folder folder;
  const Finished done =
      run(folder, {"Expect/Values = axial_strain_percent at 3 s: " + strain +
                       ", particle 1 uz_mm at 10 s: -0.0201061929829747, bond 0 state at 0 s: 0",
                   "Expect/Curves = axial_strain_percent = " + strain + " + 0 * t",
                   "Expect/Tolerance = 1e-12", "Expect/Broken bonds = 0", "Expect/End = finished",
                   "Expect/Messages = 2 particles; solver linear"});
  EXPECT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "  met: end: finished\n")) << done.output;
  EXPECT_TRUE(contains(done.output, "  expectations: 8 of 8 met\n")) << done.output;
  EXPECT_TRUE(contains(folder.read("results/net/history.csv"), "\n3,")) << "a row at 3 s";
  EXPECT_TRUE(folder.read("results/net/checks.csv").starts_with("what,expected,found,error,"));
}

TEST(Expect, WhatIsNotMetIsExitCodeOne)
{
  const std::vector<std::string> wrong{"Expect/Values = axial_strain_percent at 3 s: 0.5",
                                       "Expect/Curves = time_s = 2 * t",
                                       "Expect/Broken bonds = 1",
                                       "Expect/End = lost equilibrium",
                                       "Expect/Break times = 1 s",
                                       "Expect/Messages = no such message",
                                       "Expect/End = refused",
                                       "Repeat/Settings = Loading/Axial stress = 101 kPa",
                                       "Repeat/Settings = Output/History times = 3"};
  for (const std::string& each : wrong) {
    const command::Folder folder;
    const Finished done = run(folder, {each});
    EXPECT_EQ(done.exit_code, 1) << each << '\n' << done.output;
    EXPECT_TRUE(contains(done.output, "NOT MET: ")) << done.output;
    EXPECT_EQ(mastic(folder, with({"run", "net.scene", "--unchecked"}, {each})).exit_code, 0);
  }
}

TEST(Expect, RefusalsCanBeExpected)
{
  const command::Folder folder;
  const std::vector<std::string> refused{"Expect/End = refused", "Expect/Messages = out of range",
                                         "Bonds/Maxwell stiffness = -1 N/m"};
  EXPECT_EQ(run(folder, refused).exit_code, 2);
  EXPECT_TRUE(contains(run(folder, refused).output, "expectations: 2 of 2 met"));
  const std::vector<std::string> by_files{"Expect/End = refused",
                                          "Expect/Messages = there are particles 0 to 1 only"};
  networks::write_pair(folder);
  folder.write("net.scene", elastic);
  folder.write("bonds.csv", "a,b\n0,7\n");
  EXPECT_EQ(mastic(folder, with({"run", "net.scene"}, by_files)).exit_code, 2);
}

TEST(Expect, WhatCannotBeReadIsAnError)
{
  const std::vector<std::pair<std::string, std::string>> cases{
      {"Expect/Values = axial_strain_percent: 3", "the time is missing"},
      {"Expect/Values = axial_strain_percent at 3 s", "one ':' is needed"},
      {"Expect/Values = breakage 0 bond at 1 s: 3", "a breakage has its own time"},
      {"Expect/Curves = 2 * t", "a curve looks like"},
      {"Expect/Curves = time_s = 2 * nonsense", "is not a formula of t"},
      {"Expect/Values = axial_strain_percnt at 1 s: 3", "did you mean 'axial_strain_percent'?"},
      {"Repeat/Settings = Loading/Nothing = 3", "Repeat: "}};
  for (const auto& [setting, message] : cases) {
    const command::Folder folder;
    const Finished done = run(folder, {setting});
    EXPECT_EQ(done.exit_code, 2) << done.output;
    EXPECT_TRUE(contains(done.output, message)) << done.output;
  }
}

TEST(Repeat, ComparesWithTheSameRunMadeAnotherWay)
{
  const command::Folder folder;
  const std::vector<std::vector<std::string>> same{
      {"Repeat/Settings = Solver = events", "Repeat/Tolerance = 1e-13", "Repeat/Compare = history"},
      {"Repeat/Settings = Loading/Axial stress = 200 kPa", "Repeat/Compare = history",
       "Repeat/Factors = axial_stress_kPa: 0.5, axial_strain_percent: 0.5, strain_rate_per_s: 0.5",
       "Strength/Rate exponent = 0"},
      {"Repeat/Threads = 1"}};
  for (const std::vector<std::string>& settings : same) {
    const Finished done = run(folder, settings);
    EXPECT_EQ(done.exit_code, 0) << done.output;
  }
}

TEST(Study, HardRunsScenesThatSayWhatTheyExpect)
{
  const command::Folder folder;
  networks::write_pair(folder);
  const std::string expect = "subsection Expect\n  set Values = axial_strain_percent at 3 s: ";
  folder.write("net.scene", elastic + expect + strain + "\nend\n");
  const Finished met = mastic(folder, {"study", "--hard", "."});
  EXPECT_EQ(met.exit_code, 0) << met.output;
  EXPECT_TRUE(contains(met.output, "1 of 1 cases met")) << met.output;
  folder.write("wrong.scene", elastic + expect + "2\nend\n");
  folder.write("silent.scene", elastic);
  const Finished done = mastic(folder, {"study", "--hard", "."});
  EXPECT_EQ(done.exit_code, 1) << done.output;
  EXPECT_TRUE(contains(done.output, "1 of 3 cases met")) << done.output;
  EXPECT_TRUE(contains(folder.read("results/hard/hard.csv"), "wrong,Small network,auto,1,"));
  EXPECT_TRUE(contains(folder.read("results/hard/hard.md"), "| NOT MET"));
  EXPECT_EQ(mastic(folder, {"study", "--hard", "nowhere"}).exit_code, 2);
  EXPECT_EQ(mastic(folder, {"study"}).exit_code, 2);
}
