#include "apps/checkpoint.h"
#include "tests/apps/interrupted.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

using apps::Finished;
using command::contains;
using command::mastic;
using command::with;
using interrupted::quick;
using interrupted::slow;
using interrupted::stopped;

namespace {

const std::string results = "results/long-0.5/", checkpoint = results + "checkpoint.h5";

struct Way {
  std::string solver, threads;
};

void PrintTo(const Way& way, std::ostream* stream)
{
  *stream << way.solver << " on " << way.threads << " threads";
}

std::vector<std::string> run_arguments(const std::string& threads,
                                       const std::vector<std::string>& settings = {})
{
  return with({"run", "long-0.5.scene", "--threads", threads}, settings);
}

std::vector<std::string> resume_arguments(const std::string& threads,
                                          const std::vector<std::string>& settings = {})
{
  return with({"run", "--resume", "results/long-0.5", "--threads", threads}, settings);
}

/// A run that was stopped after some checkpoints.
void make_stopped_run(const command::Folder& folder, const std::string& solver)
{
  interrupted::write_long_scene(folder, solver);
  const Finished run = stopped(folder, run_arguments("1", {slow}), checkpoint, 5, SIGTERM);
  ASSERT_EQ(run.exit_code, 4) << run.output;
}

class Resume : public ::testing::TestWithParam<Way> {};

} // namespace

TEST_P(Resume, GoesOnBitForBitAfterEachKindOfStop)
{
  const auto [solver, threads] = GetParam();
  const command::Folder whole, parts;
  interrupted::write_long_scene(whole, solver);
  const Finished reference = mastic(whole, run_arguments("1"));
  ASSERT_EQ(reference.exit_code, 0) << reference.output;

  interrupted::write_long_scene(parts, solver);
  Finished part = stopped(parts, run_arguments(threads, {slow}), checkpoint, 2, SIGTERM);
  EXPECT_EQ(part.exit_code, 4) << part.output;
  EXPECT_TRUE(contains(part.output, "long-0.5: interrupted at t = ")) << part.output;
  EXPECT_TRUE(contains(part.output, " s; to go on: mastic run --resume results/long-0.5\n"));
  EXPECT_FALSE(parts.has(results + "result.h5"));
  part = stopped(parts, resume_arguments(threads, {slow}), checkpoint, 5, SIGINT);
  EXPECT_EQ(part.exit_code, 4) << part.output;
  for (const int n : {1, 4, 7}) {
    part = stopped(parts, resume_arguments(threads, {slow}), checkpoint, n, SIGKILL);
    EXPECT_EQ(part.exit_code, 128 + SIGKILL) << part.output;
  }
  const Finished rest = mastic(parts, resume_arguments(threads, {quick}));
  EXPECT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_TRUE(contains(rest.output, "long-0.5: resumed from "));

  const std::string breakages = whole.read(results + "breakages.csv");
  EXPECT_GT(std::ranges::count(breakages, '\n'), 20);
  EXPECT_EQ(parts.read(results + "breakages.csv"), breakages);
  EXPECT_EQ(parts.read(results + "history.csv"), whole.read(results + "history.csv"));
  for (const char* table : {"particles", "bonds"})
    EXPECT_EQ(mastic(parts, {"export", "results/long-0.5", table}).output,
              mastic(whole, {"export", "results/long-0.5", table}).output);
  for (const std::string& name : parts.files("results"))
    EXPECT_FALSE(contains(name, "checkpoint")) << name;
}

INSTANTIATE_TEST_SUITE_P(Solvers, Resume,
                         ::testing::Values(Way{"events", "1"}, Way{"events", "2"},
                                           Way{"quasistatic", "1"}, Way{"quasistatic", "2"},
                                           Way{"auto", "1"}, Way{"dynamic", "1"},
                                           Way{"dynamic", "2"}),
                         [](const auto& way) {
                           return way.param.solver + way.param.threads + "Threads";
                         });

TEST(Checkpoint, TellsHowToGoOnAndIsGoneAtTheEnd)
{
  const command::Folder folder;
  make_stopped_run(folder, "events");
  const Finished info = mastic(folder, {"info", "results/long-0.5"});
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_EQ(info.output, checkpoint +
                             ": checkpoint\n  scene long-0.5, solver events\n  to go on: "
                             "mastic run --resume " +
                             checkpoint + "\n");
  EXPECT_EQ(mastic(folder, resume_arguments("1", {quick})).exit_code, 0);
  const Finished again = mastic(folder, resume_arguments("1"));
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_EQ(again.output, "error: results/long-0.5: there is no checkpoint in it; the run has come "
                          "to its end\n");
  const Finished other = mastic(folder, {"run", "--resume", results + "result.h5"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_EQ(other.output, "error: " + results + "result.h5: this is a result, not a checkpoint\n");
}

TEST(Checkpoint, GoesOnWithWhatItBeganWith)
{
  const command::Folder folder;
  make_stopped_run(folder, "events");
  const Finished other = mastic(folder, resume_arguments("1", {"Loading/Strain limit = 5 %"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_EQ(other.output, "error: --set \"Loading/Strain limit = 5 %\": a run goes on as it began; "
                          "with --resume only Output/ParaView, Output/Plots and Output/Checkpoint "
                          "interval can be set\n");
  std::vector<std::string> arguments = resume_arguments("1");
  arguments.insert(arguments.end(), {"--packing", "particles.csv"});
  const Finished packing = mastic(folder, arguments);
  EXPECT_EQ(packing.exit_code, 2);
  EXPECT_EQ(packing.output, "error: --packing: a run goes on with the packing it began with\n");
  folder.write("bonds.csv", folder.read("bonds.csv") + "# changed\n");
  const Finished changed = mastic(folder, resume_arguments("1"));
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_TRUE(contains(changed.output, "the files of particles or bonds have changed since the run "
                                       "began\n"));
}

TEST(Checkpoint, IfCutOffIsReplacedByTheOneBefore)
{
  const command::Folder folder;
  make_stopped_run(folder, "events");
  const std::string whole = folder.read(checkpoint);
  const std::filesystem::path file = folder / checkpoint;
  const std::size_t n_before =
      apps::read_checkpoint(file.string() + ".previous", {}).run.n_recorded;
  const std::size_t n_last = apps::read_checkpoint(file, {}).run.n_recorded;
  EXPECT_GT(n_last, n_before);
  for (int k = 0; k < 10; ++k) { // the first cut leaves nothing, the last all but one byte
    folder.write(checkpoint, whole.substr(0, k * (whole.size() - 1) / 9));
    EXPECT_EQ(apps::read_checkpoint(file, {}).run.n_recorded, n_before) << k;
  }
  std::filesystem::remove(file);
  EXPECT_EQ(apps::read_checkpoint(file, {}).run.n_recorded, n_before);
  const Finished rest = mastic(folder, resume_arguments("1", {quick}));
  EXPECT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_TRUE(contains(rest.output, "checkpoint.h5: there is no such file\nwarning: taking the "
                                    "checkpoint before it\n"))
      << rest.output;
}

TEST(Checkpoint, IfCutOffWithoutOneBeforeIsRefused)
{
  const command::Folder folder;
  make_stopped_run(folder, "events");
  const std::string whole = folder.read(checkpoint);
  std::filesystem::remove(folder / (checkpoint + ".previous"));
  for (const std::size_t length : {std::size_t(0), std::size_t(1000), whole.size() - 1}) {
    folder.write(checkpoint, whole.substr(0, length));
    EXPECT_THROW(apps::read_checkpoint(folder / checkpoint, {}), std::invalid_argument) << length;
  }
  const Finished refused = mastic(folder, resume_arguments("1"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.output,
            "error: " + checkpoint + ": this is not an HDF5 file, or it is damaged\n");
}

TEST(Checkpoint, WithFlippedBitsIsRefusedOrUnharmed)
{
  const command::Folder folder;
  make_stopped_run(folder, "events");
  const std::string whole = folder.read(checkpoint);
  const std::filesystem::path file = folder / checkpoint;
  std::filesystem::remove(file.string() + ".previous");
  const auto content = [&] {
    const apps::Resumed resumed = apps::read_checkpoint(file, {});
    const apps::RunInProgress& run = resumed.run;
    std::string text =
        apps::csv(apps::history_columns(apps::face_of(run.specimen.assembly), run.record.history)) +
        apps::csv(apps::breakage_columns(run.specimen.assembly, run.run->breakages()));
    return text + fmt::format("{} {}", run.n_recorded, run.run->response(run.run->time()).strain);
  };
  const std::string expected = content();
  int n_refused = 0;
  const int n_flips = 300;
  for (int k = 0; k < n_flips; ++k) {
    std::string damaged = whole;
    damaged[k * (whole.size() - 1) / (n_flips - 1)] ^= char(1 << k % 8);
    folder.write(checkpoint, damaged);
    try {
      EXPECT_EQ(content(), expected) << "flip " << k;
    } catch (const std::invalid_argument&) {
      ++n_refused;
    }
  }
  EXPECT_GT(n_refused, n_flips / 4);
}
