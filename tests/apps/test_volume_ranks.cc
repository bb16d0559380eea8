#include "tests/apps/body_runs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>

using apps::Finished;
using body_runs::numbers;
using body_runs::on_two_ranks;
using command::contains;
using command::mastic;
using command::with;

namespace {

/// A beam that is clamped at its bottom and bent at its top: bonds break at the bottom, which is
/// one rank's.
const std::string scene = R"(set Solver = continuum
subsection Specimen
  set Solid fraction = 0.62
  set Mean contacts = 6
  set Grading = table
  set Grading table = 2 mm: 0 %, 4 mm: 100 %
end
subsection Body
  set Shape = box
  set Edges = 20 mm, 20 mm, 80 mm
  set Cell size = 10 mm
  set Material = adaptive
end
subsection Boundary bottom
  set Displacement = 0 mm, 0 mm, 0 mm
end
subsection Boundary top
  set Traction = 20 kPa, 0 kPa, 0 kPa
end
subsection Volumes
  set Particles = 150
  set Breakage tolerance = 0.02
end
subsection Strength
  set Distribution = Weibull
  set Modulus = 3
  set Scale = 40 N
end
subsection Loading
  set Test = boundary loads
  set End time = 200 s
end
subsection Continuum
  set Order = 1
  set Solver tolerance = 1e-12
end
subsection Probes
  set Points = 10 mm, 10 mm, 80 mm, 15 mm, 10 mm, 5 mm
end
subsection Output
  set Plots = false
  set ParaView = false
  set History times = 12
  set Frequencies = none
end
)";

const std::string never = "Volumes/Balance = 0";

const std::string environment = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
                                "OMPI_MCA_mpi_yield_when_idle=1; ";

/// How often a run has shared its cells out anew, by its own account.
int n_sharings(const std::string& output)
{
  std::smatch found;
  const std::regex line("cells shared out anew ([0-9]+) time");
  return std::regex_search(output, found, line) ? std::stoi(found[1]) : 0;
}

void expect_same(const command::Folder& a, const command::Folder& b)
{
  const std::string probes = "results/beam/probes.csv";
  for (const char* name : {"strain_zz_percent", "ux_mm"}) {
    const auto one = numbers(a, probes, name), other = numbers(b, probes, name);
    ASSERT_EQ(one.size(), other.size());
    double largest = 0;
    for (const double each : one)
      largest = std::max(largest, std::abs(each));
    for (std::size_t k = 0; k < one.size(); ++k)
      EXPECT_NEAR(one[k], other[k], 1e-9 * largest) << name << ' ' << k;
  }
  const std::string volumes = "results/beam/volumes.csv";
  EXPECT_EQ(numbers(a, volumes, "broken_bonds"), numbers(b, volumes, "broken_bonds"));
}

} // namespace

TEST(VolumeRanks, SharingCellsOutAnewChangesNothing)
{
  const command::Folder balanced, fixed;
  for (const command::Folder* folder : {&balanced, &fixed})
    folder->write("beam.scene", scene);
  const Finished done = on_two_ranks(balanced, {"run", "beam.scene", "--threads", "1"});
  ASSERT_EQ(done.exit_code, 0) << done.output;
  EXPECT_GT(n_sharings(done.output), 0) << done.output;
  const Finished other =
      on_two_ranks(fixed, with({"run", "beam.scene", "--threads", "1"}, {never}));
  ASSERT_EQ(other.exit_code, 0) << other.output;
  EXPECT_EQ(n_sharings(other.output), 0);
  EXPECT_TRUE(contains(other.output, "costs of the ranks: largest over mean"));
  expect_same(balanced, fixed);
}

TEST(VolumeRanks, GoOnAfterTheirCellsWereSharedOutAnew)
{
  const command::Folder whole, parts;
  for (const command::Folder* folder : {&whole, &parts})
    folder->write("beam.scene", scene);
  ASSERT_EQ(mastic(whole, {"run", "beam.scene"}).exit_code, 0);
  std::vector<std::string> line{
      "/bin/sh", "-c",
      environment + "exec mpirun --oversubscribe -np 2 \"$@\" >" + (parts / "log").string(), "sh"};
  for (const std::string& word : command::line(
           parts, with({"run", "beam.scene", "--threads", "1", "--quiet"}, {interrupted::slow})))
    line.push_back(word);
  const apps::Child child = apps::start_child(line);
  const std::string checkpoint = "results/beam/checkpoint.h5";
  interrupted::wait_until(
      [&] { return parts.has("log") && contains(parts.read("log"), "shared out anew"); });
  std::error_code none;
  const auto then = std::filesystem::last_write_time(parts / checkpoint, none);
  interrupted::wait_until([&] {
    return parts.has(checkpoint) &&
           std::filesystem::last_write_time(parts / checkpoint, none) != then;
  });
  ::kill(child.pid, SIGTERM);
  EXPECT_NE(apps::read_to_end(child).exit_code, 0);
  EXPECT_FALSE(parts.has("results/beam/history.csv"));
  const Finished resumed =
      mastic(parts, with({"run", "--resume", "results/beam"}, {interrupted::quick}));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.output;
  expect_same(whole, parts);
}

TEST(VolumeRanks, AFileThatCannotBeWrittenEndsAllWithOneMessage)
{
  const command::Folder folder;
  folder.write("beam.scene", scene);
  std::filesystem::create_directories(folder / "results/beam/checkpoint.h5.part"); // in its way
  const Finished done = command::mastic_in_shell(
      folder, environment + "exec timeout 60 mpirun --oversubscribe -np 2 \"$@\"",
      with({"run", "beam.scene", "--quiet"}, {interrupted::slow}));
  EXPECT_EQ(done.exit_code, 3) << done.output;
  const std::string message = "checkpoint.h5: the file cannot be written";
  const std::size_t first = done.output.find(message);
  EXPECT_NE(first, std::string::npos) << done.output;
  EXPECT_EQ(done.output.find(message, first + 1), std::string::npos) << done.output;
  EXPECT_FALSE(folder.has("results/beam/checkpoint.h5"));
  EXPECT_FALSE(folder.has("results/beam/history.csv"));
}

TEST(VolumeRanks, ARankThatFailsAloneEndsAllWithItsMessage)
{
  const command::Folder folder;
  folder.write("beam.scene", scene);
  const Finished done = command::mastic_in_shell(
      folder,
      environment + "folder=$3; shift 3; exec timeout 60 mpirun --oversubscribe -np 1 env -C "
                    "$folder \"$@\" : -np 1 env -C / \"$@\"",
      {"run", "beam.scene", "--quiet"});
  EXPECT_EQ(done.exit_code, 2) << done.output;
  EXPECT_TRUE(contains(done.output, "error on one rank: beam.scene: there is no such file"))
      << done.output;
  EXPECT_FALSE(folder.has("results/beam/history.csv"));
}
