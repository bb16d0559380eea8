#include "apps/timed_run.h"

#include "apps/checkpoint.h"
#include "apps/child_run.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/machine.h"
#include "apps/progress.h"
#include "apps/study_scene.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <stdexcept>

namespace apps {

namespace {

namespace fs = std::filesystem;

/// Wall time after which a child that was asked to stop is ended [s].
constexpr double patience = 10;

constexpr const char* times_file = "times.csv";
constexpr const char* times_header =
    "state,solver_wall_time_s,whole_wall_time_s,fraction_of_work\n";

class Clock {
public:
  double seconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// One repetition of a run.
struct Repetition {
  RunState state;
  double solver_time, whole_time, fraction;
  std::string message;
};

/// Nothing beside the solution takes time, and no checkpoint falls into it.
std::vector<std::string> settings_of(const Rung& rung, const fs::path& folder)
{
  std::vector<std::string> settings = rung.settings;
  settings.insert(settings.end(),
                  {"Solver = " + rung.solver, "Dynamic/Audit = false", "Output/Plots = false",
                   "Output/ParaView = false", "Output/Snapshot times = none",
                   "Output/Checkpoint interval = 1e9 s",
                   "Output/Folder = " + absolute_folder(folder).string()});
  return settings;
}

/// Everything that a run follows from, as text: runs with equal texts are the same.
std::string origin_of(const LoadedScene& scene, const TimedRuns& runs)
{
  return fmt::format("mastic " MASTIC_VERSION " ({})\n{}\n{} thread(s)\n{}\n{}", MASTIC_REVISION,
                     machine_name(), runs.n_threads, files_fingerprint(scene),
                     scene.schema->print(false));
}

/// True if what is in a folder was made by this program from the same.
bool is_same(const fs::path& folder, const std::string& origin)
{
  try {
    return read_text_file(folder / "origin.txt") == origin &&
           fs::last_write_time(folder / "origin.txt") > fs::last_write_time(own_executable());
  } catch (const std::exception&) {
    return false;
  }
}

/// The repetitions noted in a folder.
std::vector<Repetition> noted(const fs::path& folder)
{
  std::vector<Repetition> found;
  if (!fs::exists(folder / times_file))
    return found;
  for (const std::string& line : split(read_text_file(folder / times_file), '\n')) {
    const std::vector<std::string> cells = split(line, ',');
    if (cells.size() != 4 || (cells[0] != "finished" && cells[0] != "over budget"))
      continue;
    found.push_back({cells[0] == "finished" ? RunState::finished : RunState::over_budget,
                     std::atof(cells[1].c_str()), std::atof(cells[2].c_str()),
                     std::atof(cells[3].c_str()), ""});
  }
  return found;
}

void note(const fs::path& folder, const std::vector<Repetition>& repetitions)
{
  std::string text = times_header;
  for (const Repetition& each : repetitions)
    text += fmt::format("{},{},{},{}\n", name_of(each.state), each.solver_time, each.whole_time,
                        each.fraction);
  write_text_file(folder / times_file, text);
}

/// The last line of a log that names an error, without what comes before the message.
std::string error_in(const std::string& log)
{
  std::string found = "it ended without a word";
  for (const std::string& line : split(log, '\n'))
    if (const std::size_t mark = line.find("error: "); mark != std::string::npos)
      found = line.substr(mark + 7);
  return found;
}

std::string over_budget_text(double time, double fraction)
{
  const std::string estimate = fraction > 0.01 ? fmt::format("; all of it would take about {}",
                                                             duration_text(time / fraction))
                                               : "";
  return fmt::format("ended after {} with {:.0f} % of the work done{}", duration_text(time),
                     100 * fraction, estimate);
}

/// What a child has come to.
Repetition ended(int exit_code, const ChildRun& run, const fs::path& folder, double time)
{
  if (exit_code == exit_ok || exit_code == exit_lost_equilibrium) {
    const dem::Hdf5File result = open_stored(folder / "result.h5", "result");
    return {RunState::finished, result.number_attribute("", "wall_time_s"), time, 1, ""};
  }
  if (interrupted())
    return {RunState::interrupted, 0, time, run.fraction, "interrupted"};
  const RunState state = exit_code == exit_input ? RunState::refused : RunState::failed;
  return {state, 0, time, run.fraction,
          exit_code > 128 ? fmt::format("it was ended by signal {}", exit_code - 128)
                          : error_in(run.log)};
}

/// Runs a command once, for no longer than the budget.
Repetition once(const std::vector<std::string>& command, const fs::path& folder, double budget,
                const Tell& tell)
{
  const Clock clock;
  ChildRun run{start_child(command), "", 0, "", ""};
  std::optional<double> asked_to_stop;
  bool over = false;
  for (bool going = true; going;) {
    if (wait_for_output({&run}, 200)[0])
      going = listen(run);
    tell(run.fraction, run.state);
    over = over || clock.seconds() > budget;
    if (!asked_to_stop && (over || interrupted())) {
      stop(run);
      asked_to_stop = clock.seconds();
    }
    if (going && asked_to_stop && clock.seconds() > *asked_to_stop + patience)
      kill(run);
  }
  const int exit_code = wait_for(run.child);
  const double time = clock.seconds();
  write_text_file(folder / "run.log", run.log);
  Repetition found = ended(exit_code, run, folder, time);
  if (over && found.state != RunState::finished && found.state != RunState::interrupted)
    found = {RunState::over_budget, 0, time, run.fraction, ""};
  remove_checkpoints(folder);
  return found;
}

double median(std::vector<double> values)
{
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n == 0 ? 0 : 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// The repetitions as one run.
TimedRun together(const std::vector<Repetition>& repetitions)
{
  TimedRun run;
  std::vector<double> solver, whole;
  for (const Repetition& each : repetitions) {
    solver.push_back(each.solver_time);
    whole.push_back(each.whole_time);
    run.state = each.state;
    run.message = each.state == RunState::over_budget
                      ? over_budget_text(each.whole_time, each.fraction)
                      : each.message;
    run.fraction = each.fraction;
  }
  run.n_repetitions = int(repetitions.size());
  run.solver_time = median(solver);
  run.whole_time = median(whole);
  return run;
}

/// The repetitions that need not be made again: those that finished; or one that took too long, if
/// it had as much time as there is now.
std::vector<Repetition> kept(const fs::path& folder, const std::string& origin, double budget)
{
  std::vector<Repetition> found;
  if (is_same(folder, origin))
    found = noted(folder);
  std::erase_if(found, [&](const Repetition& each) {
    return each.state == RunState::over_budget && each.whole_time < budget;
  });
  if (!found.empty() && found.front().state == RunState::finished &&
      !fs::exists(folder / "result.h5"))
    found.clear();
  return found;
}

} // namespace

std::string name_of(RunState state)
{
  switch (state) {
  case RunState::finished:
    return "finished";
  case RunState::refused:
    return "does not apply";
  case RunState::over_budget:
    return "over budget";
  case RunState::not_started:
    return "not started";
  case RunState::interrupted:
    return "interrupted";
  default:
    return "failed";
  }
}

TimedRun run_timed(const Rung& rung, const TimedRuns& runs, const Tell& tell)
{
  const fs::path own = runs.folder / rung.folder();
  const LoadedScene scene = scene_of_run(runs.scene, rung.folder(), settings_of(rung, own));
  for (const Diagnostic& each : scene.diagnostics)
    if (each.kind == Diagnostic::Kind::error)
      return together({{RunState::refused, 0, 0, 0, each.message}});
  const std::string origin = origin_of(scene, runs);
  std::vector<Repetition> repetitions = kept(own, origin, runs.budget);
  const bool all_kept = !repetitions.empty();
  if (repetitions.empty()) {
    std::error_code ignored;
    fs::remove(own / "result.h5", ignored);
    fs::remove(own / times_file, ignored);
    write_text_file(own / "origin.txt", origin);
  }
  const fs::path file = own / (rung.folder() + ".scene");
  write_text_file(file, scene.schema->print(false));
  std::vector<std::string> command = run_command(runs.n_threads);
  command.insert(command.end(), {file.string(), "--unchecked"}); // errors are the study's to judge
  if (runs.packing)
    command.insert(command.end(), {"--packing", runs.packing->string()});
  while (!interrupted() && int(repetitions.size()) < runs.n_repetitions &&
         (repetitions.empty() || repetitions.back().state == RunState::finished)) {
    const Repetition last = once(command, own, runs.budget, tell);
    if (last.state != RunState::finished)
      repetitions.clear(); // the run as a whole is what this one is
    repetitions.push_back(last);
    if (last.state == RunState::finished || last.state == RunState::over_budget)
      note(own, repetitions);
  }
  TimedRun run = together(repetitions);
  run.kept = all_kept;
  if (interrupted() && int(repetitions.size()) < runs.n_repetitions)
    run.state = RunState::interrupted;
  return run;
}

} // namespace apps
