#include "tests/apps/networks.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::mastic_in_shell;
using command::with;

namespace {

/// A run of two spheres into a folder.
std::vector<std::string> run_into(const std::string& folder)
{
  return with({"run", "net.scene"}, {"Output/Folder = " + folder, "Loading/End time = 5 s"});
}

int n_errors(const std::string& output)
{
  int n = 0;
  for (std::size_t at = 0; (at = output.find("error: ", at)) != std::string::npos; ++at)
    ++n;
  return n;
}

bool has_part(const command::Folder& folder)
{
  for (const std::string& name : folder.files())
    if (name.ends_with(".part"))
      return true;
  return false;
}

} // namespace

TEST(OutputFolder, ThatIsAFileIsRefusedAtOnce)
{
  const command::Folder folder;
  networks::write_pair(folder);
  const std::string file = (folder / "particles.csv").string();
  for (const std::string& name : {std::string("particles.csv"), std::string("particles.csv/out")}) {
    const Finished run = mastic(folder, run_into(name));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.output,
              "error: " + name + ": results go into a folder, but " + file + " is a file\n");
  }
  const Finished study =
      mastic(folder, with(run_into("particles.csv"),
                          {"Study/Vary = Loading/Axial stress", "Study/Values = 1 kPa, 2 kPa"}));
  EXPECT_EQ(study.exit_code, 2);
  EXPECT_EQ(n_errors(study.output), 1) << study.output;
}

TEST(OutputFolder, ThatCannotBeMadeIsOneErrorBeforeTheRun)
{
  const command::Folder folder;
  networks::write_pair(folder);
  const Finished run = mastic(folder, run_into("/proc/mastic-results"));
  EXPECT_NE(run.exit_code, 0);
  EXPECT_EQ(n_errors(run.output), 1) << run.output;
  EXPECT_TRUE(contains(run.output, "/proc/mastic-results")) << run.output;
  EXPECT_FALSE(contains(run.output, "ended at")) << run.output;
}

TEST(OutputFolder, ThatIsReadOnlyIsRefusedAtOnce)
{
  using std::filesystem::perms;
  const command::Folder folder;
  networks::write_pair(folder);
  std::filesystem::create_directory(folder / "out");
  std::filesystem::permissions(folder.path(), perms(0755));
  std::filesystem::permissions(folder / "out", perms(0555));
  // The system administrator may write everywhere: be somebody else.
  const std::string somebody =
      ::geteuid() == 0 ? "setpriv --reuid 65534 --regid 65534 --clear-groups " : "";
  const Finished run = mastic_in_shell(folder, "exec " + somebody + "\"$@\"", run_into("out"));
  if (run.exit_code == 126 || run.exit_code == 127)
    GTEST_SKIP() << "nobody else may run the program: " << run.output;
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.output, "error: out: results cannot be written there: you may not write in " +
                            (folder / "out").string() + "\n");
}

// A limit on the size of a file stands for a full disk: the write fails in the same place.

TEST(FullDisk, LeavesNoHalfResult)
{
  const command::Folder folder;
  networks::write_lattice(folder);
  for (const std::string blocks : {"1", "20", "100"}) {
    const Finished run = mastic_in_shell(
        folder, "trap '' XFSZ; ulimit -f " + blocks + "; exec \"$@\"", run_into("out"));
    EXPECT_EQ(run.exit_code, 3) << blocks << run.output;
    EXPECT_EQ(n_errors(run.output), 1) << run.output;
    EXPECT_TRUE(contains(run.output, "cannot be written")) << run.output;
    EXPECT_FALSE(folder.has("out/result.h5"));
    EXPECT_FALSE(has_part(folder)) << blocks;
  }
}

TEST(FullDisk, IsToldByCommandsThatPrint)
{
  const command::Folder folder;
  networks::write_pair(folder);
  const Finished little =
      mastic_in_shell(folder, "exec \"$@\" > /dev/full", {"check", "net.scene"});
  EXPECT_EQ(little.exit_code, 3);
  EXPECT_EQ(little.output, "error: the output cannot be written; is the disk full?\n");
  const Finished much = mastic_in_shell(folder, "exec \"$@\" > /dev/full", {"new", "creep"});
  EXPECT_EQ(much.exit_code, 3);
  EXPECT_EQ(much.output, "error: cannot write to file: No space left on device\n");
}
