#include "apps/solver_study.h"

#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/machine.h"
#include "apps/plot.h"
#include "apps/progress.h"
#include "apps/study_reference.h"
#include "apps/study_scene.h"
#include "apps/timed_run.h"
#include "apps/work_precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace apps {

namespace {

/// Budget of what may become the reference, over that of the others.
constexpr double reference_patience = 10;

void say(const std::string& line)
{
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

std::string outcome_text(const TimedRun& run)
{
  if (run.state != RunState::finished)
    return name_of(run.state) + (run.message.empty() ? "" : ": " + run.message);
  return fmt::format("solved in {}{}", duration_text(run.solver_time),
                     run.kept ? ", kept from before" : "");
}

/// Takes into a row what its finished run has left.
void read_result(StudyRow& row, const std::filesystem::path& folder)
{
  const dem::Hdf5File result = open_stored(folder / "result.h5", "result");
  row.curve = read_run_curve(result);
  row.motion = largest_motion(result);
  for (const char* what : {"unknowns", "bonds", "steps", "solves", "factorisations"})
    try {
      row.counts[what] = result.number_attribute("", what);
    } catch (const std::runtime_error&) { // a solver that does not count it
    }
}

/// The rows of a study as they are filled, each rung run once.
class Rows {
public:
  Rows(TimedRuns runs, bool quiet) : runs_(std::move(runs)), quiet_(quiet) {}

  /// The row of a rung; runs it if that has not been done.
  StudyRow row(const Rung& rung, double patience = 1)
  {
    const auto known = std::ranges::find_if(
        done_, [&](const StudyRow& each) { return each.rung.folder() == rung.folder(); });
    StudyRow row;
    if (known != done_.end())
      row = *known;
    else {
      TimedRuns runs = runs_;
      runs.budget *= patience;
      Progress progress(rung.text(), quiet_, false);
      row.run = run_timed(rung, runs, [&](double fraction, const std::string& state) {
        progress.update(fraction, state.empty() ? "begins" : state);
      });
      progress.finish();
      say(fmt::format("  {}: {}", rung.text(), outcome_text(row.run)));
      if (row.run.state == RunState::finished)
        read_result(row, runs_.folder / rung.folder());
    }
    row.rung = rung;
    if (known == done_.end())
      done_.push_back(row);
    return row;
  }

  /// The rows of a ladder, up to the first rung that takes too long or that the solver refuses.
  std::vector<StudyRow> ladder(const Ladder& rungs)
  {
    std::vector<StudyRow> rows;
    RunState state = RunState::finished;
    for (const Rung& rung : rungs) {
      if (interrupted() || state == RunState::refused)
        break;
      StudyRow next;
      if (state == RunState::over_budget) {
        next.rung = rung;
        next.run.message = "the setting before it took too long";
      } else
        next = row(rung);
      if (next.run.state != RunState::not_started)
        state = next.run.state;
      rows.push_back(std::move(next));
    }
    return rows;
  }

private:
  TimedRuns runs_;
  bool quiet_;
  std::vector<StudyRow> done_;
};

/// Rows of a study and what they are measured against.
struct Findings {
  std::vector<StudyRow> rows;
  std::optional<StudyReference> reference;
};

bool has(const std::vector<StudyRow>& rows, const Rung& rung)
{
  return std::ranges::any_of(
      rows, [&](const StudyRow& row) { return row.rung.folder() == rung.folder(); });
}

/// A reference that is not one of the rungs becomes one.
void include(Findings& findings, const StudyRow& row, const StudyReference& reference)
{
  findings.reference = reference;
  if (!has(findings.rows, reference.rung))
    findings.rows.insert(findings.rows.begin(), row);
}

/// Looks for the best reference there is, once the ladders have been run.
void find_reference(Findings& findings, Rows& rows, const LoadedScene& scene,
                    const std::vector<StudyRow>& candidates, const std::string& asked)
{
  if (asked == "auto")
    if (const auto exact = exact_reference(candidates, scene)) {
      const StudyRow row = rows.row(exact->rung);
      return include(findings, row, *exact);
    }
  if (asked == "auto" || asked == "quasistatic") {
    const StudyReference finest = finest_reference(scene);
    const StudyRow row = rows.row(finest.rung, reference_patience);
    if (row.curve)
      return include(findings, row, finest);
  }
  for (const char* solver : {"quasistatic", "dynamic", "events", "linear"})
    if (!findings.reference && (asked == solver || asked == "auto"))
      findings.reference = named_reference(findings.rows, solver);
}

/// Runs everything.
Findings run_all(const std::vector<Ladder>& ladders, Rows& rows, const LoadedScene& scene,
                 const std::string& reference)
{
  std::vector<StudyRow> candidates;
  const bool particles = scene.scene->solver != SolverChoice::continuum;
  for (const char* solver : {"linear", "events"})
    if (particles && !interrupted() && (reference == "auto" || reference == solver))
      candidates.push_back(rows.row(plain_rung(solver), reference_patience));
  Findings findings;
  for (const Ladder& rungs : ladders)
    for (StudyRow& row : rows.ladder(rungs))
      findings.rows.push_back(std::move(row));
  for (const StudyRow& row : candidates) // asked for as the reference only
    if (reference == row.rung.solver && !has(findings.rows, row.rung))
      findings.rows.insert(findings.rows.begin(), row);
  if (!interrupted())
    find_reference(findings, rows, scene, candidates, reference);
  return findings;
}

/// What the errors are of.
std::string quantity_of(const std::vector<StudyRow>& rows)
{
  for (const StudyRow& row : rows)
    if (row.curve)
      return row.curve->quantity;
  return "strain";
}

/// Prints and writes what was found. \return the exit code
int report(Findings findings, const LoadedScene& scene, const std::filesystem::path& folder,
           int n_threads)
{
  if (findings.reference)
    measure_errors(findings.rows, findings.reference->rung);
  const StudyReference reference =
      findings.reference.value_or(StudyReference{{"none", "", 0, {}}, "", std::nullopt});
  write_text_file(folder / "study.csv",
                  study_csv(findings.rows, reference, {scene.name, machine_name(), n_threads}));
  say("");
  if (findings.reference)
    say(fmt::format("reference: {}: {}", reference.rung.text(), reference.reason));
  say(fmt::format(
      "error: largest difference of the {0} at the history times that both reached, over "
      "the largest {0};\n  at end: at the last of these times, over the {0} there; "
      "broken: of the number of broken bonds then;\n  rupture: of its time\n{1}, {2} "
      "thread(s)\n",
      quantity_of(findings.rows), machine_name(), n_threads));
  fmt::print("{}", study_table(findings.rows));
  say(fmt::format("\ncheapest settings:\n{}\ntable {}", cheapest_text(findings.rows),
                  (folder / "study.csv").string()));
  if (reference.left_out.value_or(0) > accuracies.back())
    say(fmt::format(
        "note: marks below the {:.2g} % that the reference leaves out say how near a run "
        "is to it, not to the truth",
        100 * *reference.left_out));
  if (scene.scene->output.plots)
    for (const std::string& figure : make_study_figure(folder))
      say("figure " + figure);
  if (!findings.reference) {
    fmt::print(stderr, "error: none of the runs can serve as a reference: there are no errors\n");
    return exit_failure;
  }
  return exit_ok;
}

/// The packing of the runs, made once.
std::optional<std::filesystem::path> packing_of(const LoadedScene& scene,
                                                const std::filesystem::path& folder,
                                                const SolverStudyOptions& options)
{
  if (scene.scene->solver == SolverChoice::continuum)
    return std::nullopt;
  RunOptions run_options;
  if (!options.packing.empty())
    run_options.packing = absolute_folder(options.packing);
  std::vector<LoadedScene> scenes;
  scenes.push_back(scene_of_run(scene, "packing", {}));
  return study_packings(scenes, folder, run_options).front();
}

void tell_load()
{
  if (load_average() > 0.5 * n_processors())
    say(fmt::format("  note: the machine is busy (load {:.1f} on {} processors): times will be "
                    "longer than they need to be",
                    load_average(), n_processors()));
}

} // namespace

int study_verb(const std::string& file, const SolverStudyOptions& options)
{
  if (!std::filesystem::exists(file))
    throw std::invalid_argument(file + ": there is no such file");
  const LoadedScene scene = load_scene(file, options.overrides);
  print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    return exit_input;
  const double budget = Units().parse(options.budget, "s", "s");
  const std::vector<Ladder> ladders = solver_ladders(*scene.scene, options.ladders);
  const std::filesystem::path folder =
      options.output.empty() ? result_folder(scene).string() + "-study" : options.output;
  require_writable(folder);
  make_folder(folder);
  say(fmt::format("{}: study of solvers, {} thread(s), {} for each run", scene.name,
                  options.n_threads, duration_text(budget)));
  if (!scene.scene->study.vary.empty())
    say("  note: the section Study of the scene is left out");
  ::setenv("OMP_NUM_THREADS", std::to_string(options.n_threads).c_str(), 1);
  tell_load();
  Rows rows({scene, absolute_folder(folder), packing_of(scene, absolute_folder(folder), options),
             options.n_threads, options.n_repetitions, budget},
            options.quiet);
  Findings findings = run_all(ladders, rows, scene, options.reference);
  if (interrupted()) {
    say(fmt::format("{}: interrupted; to go on, start the same study again: runs that have "
                    "finished are kept in {}",
                    scene.name, folder.string()));
    return exit_interrupted;
  }
  return report(std::move(findings), scene, folder, options.n_threads);
}

} // namespace apps
