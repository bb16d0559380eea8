#include "apps/repeat.h"

#include "apps/checkpoint.h"
#include "apps/files.h"
#include "apps/process.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <thread>

namespace apps {

namespace {

namespace fs = std::filesystem;

/// The scene of the second run, with full names of its files, written beside its results.
fs::path write_scene(const LoadedScene& scene, const fs::path& folder)
{
  const RepeatedRun& repeat = scene.scene->repeat;
  const std::string text = scene.schema->print(false), name = "repeat.scene";
  const auto loaded = [&](const std::vector<std::string>& settings) {
    return repeat.scene.empty() ? load_scene_text(text, name, scene.folder, settings)
                                : load_scene(scene.folder / repeat.scene, settings);
  };
  std::vector<std::string> settings = split(repeat.settings, ';');
  const LoadedScene varied = loaded(settings);
  const auto full_name = [&](const std::string& file) {
    return file.empty() ? "" : (absolute_folder(varied.folder) / file).string();
  };
  settings.insert(settings.end(),
                  {"Specimen/File = " + full_name(varied.scene->specimen.file),
                   "Specimen/Bond file = " + full_name(varied.scene->specimen.bond_file),
                   "Output/Folder = " + absolute_folder(folder).string(), "Output/Plots = false",
                   "Output/ParaView = false",
                   "Output/Measured =", "Repeat/Scene =", "Repeat/Settings =", "Repeat/Threads = 0",
                   "Repeat/Interruptions = 0"}); // once is enough
  const LoadedScene second = loaded(settings);
  for (const Diagnostic& each : second.diagnostics)
    if (each.kind == Diagnostic::Kind::error)
      throw std::invalid_argument(fmt::format("Repeat: {}: {}", each.place, each.message));
  const fs::path file = folder / name;
  write_text_file(file, second.schema->print(false));
  return file;
}

void require_end(const Finished& done)
{
  if (done.exit_code != exit_ok && done.exit_code != exit_lost_equilibrium)
    throw std::runtime_error("Repeat: the second run failed: " + done.output);
}

/// Lets a run write a checkpoint that was not there before, and stops it.
Finished stopped(const std::vector<std::string>& command, const fs::path& checkpoint)
{
  std::error_code none;
  const fs::file_time_type before = fs::last_write_time(checkpoint, none);
  const Child child = start_child(command);
  siginfo_t state{};
  const auto runs = [&] {
    return ::waitid(P_PID, id_t(child.pid), &state, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           state.si_pid == 0;
  };
  while (runs() &&
         (!fs::exists(checkpoint, none) || fs::last_write_time(checkpoint, none) == before))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child.pid, SIGTERM);
  return read_to_end(child);
}

/// Stops and resumes a run; says at what times. \return how often it could be stopped
long run_with_interruptions(std::vector<std::string> command, const fs::path& folder, long n)
{
  const std::string slow = "Output/Checkpoint interval = 1e-9 s";
  const std::vector<std::string> resume{command[0],    "run",     "--resume",  folder.string(),
                                        "--unchecked", "--quiet", "--threads", command.back()};
  remove_checkpoints(folder);
  for (long k = 0; k < n; ++k) {
    command.insert(command.end(), {"--set", slow});
    const Finished done = stopped(command, checkpoint_file(folder));
    if (done.exit_code != exit_interrupted) {
      require_end(done);
      return k;
    }
    fmt::print("  repeated: {}", done.output.substr(done.output.rfind("interrupted")));
    command = resume;
  }
  command.insert(command.end(), {"--set", "Output/Checkpoint interval = 60 s"});
  require_end(run_to_end(command));
  return n;
}

using Factors = std::map<std::string, double>;

Factors factors_of(const std::string& text)
{
  Factors factors;
  for (const std::string& each : split(text, ',')) {
    const std::vector<std::string> two = split(each, ':');
    if (two.size() != 2)
      throw std::invalid_argument(
          fmt::format("Repeat/Factors: '{}' is not of the form 'column: factor'", each));
    factors[two[0]] = Units().parse(two[1], "1", "1");
  }
  return factors;
}

/// Largest difference of a column over its largest value.
Check column_check(const std::string& table, const Column& one, const Column& other, double factor,
                   double tolerance)
{
  Check check{fmt::format("repeated {} {}", table, one.name), "", "", 0, tolerance};
  if (one.values.size() != other.values.size())
    return exact_check(check.what + ": rows", std::to_string(other.values.size()),
                       std::to_string(one.values.size()));
  double largest = 0, most = -1;
  for (const double value : other.values)
    largest = std::max(largest, std::isnan(value) ? 0 : std::abs(factor * value));
  for (std::size_t k = 0; k < one.values.size(); ++k) {
    const double expected = factor * other.values[k], found = one.values[k];
    double difference = expected == found || (std::isnan(expected) && std::isnan(found))
                            ? 0
                            : std::abs(expected - found);
    if (std::isnan(difference))
      difference = std::numeric_limits<double>::infinity();
    if (difference > most) {
      most = difference;
      check.expected = std::isnan(expected) ? "nothing" : shortest(expected);
      check.found = std::isnan(found) ? "nothing" : shortest(found);
    }
  }
  check.error = most > 0 ? most / (largest > 0 ? largest : 1) : 0;
  return check;
}

/// Tables of the second run beside those of the first.
class Comparer {
public:
  Comparer(const RunInProgress& run, const fs::path& folder)
      : run_(run), repeat_(run.scene.scene->repeat), factors_(factors_of(repeat_.factors)),
        file_(open_stored(folder / "result.h5", "result"))
  {
  }

  std::vector<Check> checks()
  {
    const dem::Assembly& assembly = run_.specimen.assembly;
    if (repeat_.compare != Comparison::breakages)
      compare("history", history_columns(face_of(assembly), run_.record.history),
              stored_columns(file_, "history"));
    const std::vector<Column> broken = breakage_columns(assembly, run_.run->breakages());
    const std::vector<Column> other = stored_columns(file_, "breakages");
    if (repeat_.compare == Comparison::everything)
      compare("breakages", broken, other);
    else
      for (const char* name : {"time_s", "pass", "bond"})
        if (name != std::string("bond") || repeat_.compare == Comparison::breakages)
          compare("breakages", {column_of(broken, name)}, {column_of(other, name)});
    if (repeat_.compare == Comparison::everything)
      compare_snapshots();
    return std::move(checks_);
  }

private:
  void compare_snapshots()
  {
    const Snapshot& mine = run_.record.snapshots.back();
    const Snapshot other = read_snapshot(file_, "snapshots/" + file_.members("snapshots").back());
    const dem::Assembly& assembly = run_.specimen.assembly;
    const auto fields = [](std::vector<Column> columns, std::size_t n) { // without what is given
      columns.erase(columns.begin(), columns.begin() + std::ptrdiff_t(n));
      return columns;
    };
    if (mine.displacement.size() != other.displacement.size() ||
        mine.force.size() != other.force.size()) {
      checks_.push_back(exact_check("repeated particles and bonds", "as many", "more or fewer"));
      return;
    }
    compare("particle", fields(particle_columns(assembly.particles, mine), 5),
            fields(particle_columns(assembly.particles, other), 5));
    compare("bond", fields(bond_columns(assembly.bonds.ends, mine), 3),
            fields(bond_columns(assembly.bonds.ends, other), 3));
  }

  void compare(const std::string& table, const std::vector<Column>& one,
               const std::vector<Column>& other)
  {
    for (const Column& column : one) {
      const auto factor = factors_.find(column.name);
      checks_.push_back(column_check(table, column, column_of(other, column.name),
                                     factor == factors_.end() ? 1 : factor->second,
                                     repeat_.tolerance));
    }
  }

  const RunInProgress& run_;
  const RepeatedRun& repeat_;
  Factors factors_;
  dem::Hdf5File file_;
  std::vector<Check> checks_;
};

} // namespace

std::vector<Check> check_repetition(const RunInProgress& run, const fs::path& results,
                                    const RunOptions& options)
{
  const RepeatedRun& repeat = run.scene.scene->repeat;
  const fs::path folder = absolute_folder(results) / "repeat";
  const long n_threads = repeat.n_threads > 0 ? repeat.n_threads : options.n_threads;
  const std::vector<std::string> command{own_executable().string(),
                                         "run",
                                         write_scene(run.scene, folder).string(),
                                         "--unchecked",
                                         "--quiet",
                                         "--threads",
                                         std::to_string(n_threads)};
  std::vector<Check> checks;
  if (repeat.n_interruptions > 0)
    checks.push_back(exact_check(
        "interruptions", std::to_string(repeat.n_interruptions),
        std::to_string(run_with_interruptions(command, folder, repeat.n_interruptions))));
  else
    require_end(run_to_end(command));
  for (Check& each : Comparer(run, folder).checks())
    checks.push_back(std::move(each));
  return checks;
}

} // namespace apps
