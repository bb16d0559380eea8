#include "fem/law_file.h"
#include "tests/apps/networks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;

namespace {

/// D(t) [1/GPa] with two retardation times.
double measured(double t)
{
  return 0.8 + 2e-3 * t + 1.5 * (1 - std::exp(-t / 0.5)) + 4 * (1 - std::exp(-t / 60));
}

void write_measured(const command::Folder& folder)
{
  std::string text = "time [s],creep compliance [1/GPa]\n";
  for (int k = 0; k <= 40; ++k) {
    const double t = 1e-2 * std::pow(10, k / 8.0);
    text += fmt::format("{},{}\n", t, measured(t));
  }
  folder.write("creep.csv", text);
}

} // namespace

TEST(Calibrate, ThePackingWithTheNewLawCreepsAsMeasured)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  write_measured(folder);
  const Finished done =
      mastic(folder, {"calibrate", "net.scene", "creep.csv", "-o", "out", "--accuracy", "1e-3"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_TRUE(contains(done.output, "check: with this law the specimen gives")) << done.output;
  // a run of the specimen with the section that was written
  folder.write("check.scene",
               "include net.scene\ninclude out/bonds.inc\n"
               "set Solver = linear\nsubsection Loading\n  set Axial stress = 1 kPa\n"
               "  set End time = 100 s\nend\nsubsection Output\n"
               "  set Folder = check\nend\n");
  const Finished run = mastic(folder, {"run", "check.scene"});
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const Finished table = mastic(folder, {"export", "check", "history"});
  int n = 0;
  std::istringstream lines(table.output);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::vector<double> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');)
      cells.push_back(cell.empty() ? NAN : std::stod(cell));
    if (cells.size() < 5 || cells[0] < 1e-2)
      continue;
    EXPECT_NEAR(cells[4] / measured(cells[0]), 1, 5e-3) << line;
    ++n;
  }
  EXPECT_GT(n, 10);
}

TEST(Calibrate, OfVolumeElementsGivesALawThatExtractReturns)
{
  const command::Folder folder;
  write_measured(folder);
  folder.write("rve.scene",
               "subsection Specimen\n  set Particles = 60\n  set Solid fraction = 0.62\n"
               "end\nsubsection Strength\n  set Distribution = none\nend\n"
               "subsection Volume element\n  set Realisations = 2\n  set Symmetry = "
               "isotropic\nend\nsubsection Output\n  set Plots = false\nend\n");
  const Finished done = mastic(folder, {"calibrate", "rve.scene", "creep.csv", "-o", "out",
                                        "--from", "element", "--accuracy", "1e-6"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  folder.write("law.scene", "include rve.scene\ninclude out/bonds.inc\n");
  const Finished extracted = mastic(folder, {"extract", "law.scene", "-o", "law"});
  ASSERT_EQ(extracted.exit_code, 0) << extracted.output;
  const fem::LawRecord record = fem::law_from_text(folder.read("law/law.law"), "law.law");
  for (const double t : {0.0, 0.3, 10.0, 900.0})
    EXPECT_NEAR(1e9 * fem::compliance(record.law, t)(0, 0) / measured(t), 1, 1e-6) << t;
}

TEST(Calibrate, SaysWhatIsWrong)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  write_measured(folder);
  const Finished branches =
      mastic(folder, {"calibrate", "net.scene", "creep.csv", "--branches", "many"});
  EXPECT_EQ(branches.exit_code, 2);
  EXPECT_TRUE(contains(branches.output, "--branches: 'many' is neither")) << branches.output;
  const Finished data = mastic(folder, {"calibrate", "net.scene", "none.csv"});
  EXPECT_EQ(data.exit_code, 2);
  EXPECT_FALSE(folder.has("results"));
}
