#include "apps/study.h"

#include "apps/checkpoint.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/measured.h"
#include "apps/plot.h"
#include "apps/run_pool.h"
#include "apps/stored_study.h"
#include "apps/study_scene.h"
#include "apps/text.h"
#include "dem/hdf5_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

bool has_result(const std::filesystem::path& folder)
{
  try {
    return dem::Hdf5File::open(folder / "result.h5").is_complete();
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// Tables and figures that a study leaves beside its runs.
constexpr const char* leavings[] = {"runs.csv",
                                    "summary.csv",
                                    "statistics.csv",
                                    "variance.csv",
                                    "study.h5",
                                    "damage.csv",
                                    "strain_time.png",
                                    "strain_rate.png",
                                    "breakage.png",
                                    "stress_strain.png",
                                    "permanent_strain.png",
                                    "damage.png",
                                    "compliance_growth.png",
                                    "compliance.png",
                                    "complex_modulus.png",
                                    "displacement_time.png",
                                    "displacement_rate.png",
                                    "volumes.png",
                                    "strain_reduced_time.png",
                                    "master_curve.png",
                                    "strain_time_band.png",
                                    "breakage_band.png",
                                    "rupture_times.png",
                                    "stress_strain_band.png"};

/// Takes away what an earlier study left in the folder, so that nothing of it counts as of this
/// one.
void clear(const std::filesystem::path& folder, const std::vector<StudyRun>& runs)
{
  std::error_code ignored;
  for (const char* name : leavings)
    std::filesystem::remove(folder / name, ignored);
  for (const StudyRun& run : runs) {
    for (const char* name : {"result.h5", "run.log"})
      std::filesystem::remove(folder / run.name / name, ignored);
    remove_checkpoints(folder / run.name);
  }
}

/// The exit code with which a run ended in an earlier part of the study.
int code_before(const std::map<std::string, int>& listed, const std::filesystem::path& folder,
                const StudyRun& run)
{
  if (const auto found = listed.find(run.name); found != listed.end() && found->second >= 0)
    return found->second;
  const dem::Hdf5File file = dem::Hdf5File::open(folder / run.name / "result.h5");
  return file.text_attribute("", "end") == name_of(dem::RunEnd::lost_equilibrium)
             ? int(exit_lost_equilibrium)
             : int(exit_ok);
}

/// What all runs of a study have in common.
struct Setting {
  std::filesystem::path folder;
  int n_threads; ///< of one run
  const std::vector<std::string>& overrides;
  bool resume;
};

/// The command of one run, whose scene is written into its folder.
std::vector<std::string> command_for(const StudyRun& run, const LoadedScene& scene,
                                     const std::optional<std::filesystem::path>& packing,
                                     const Setting& setting)
{
  const std::filesystem::path own = setting.folder / run.name;
  std::vector<std::string> command = run_command(setting.n_threads);
  if (setting.resume && has_checkpoint(own)) {
    command.insert(command.end(), {"--resume", checkpoint_file(own).string()});
    for (const std::string& each : setting.overrides)
      command.insert(command.end(), {"--set", each});
    return command;
  }
  const std::filesystem::path file = own / (run.name + ".scene");
  remove_checkpoints(own);
  write_text_file(file, scene.schema->print(false));
  command.push_back(file.string());
  if (packing)
    command.insert(command.end(), {"--packing", packing->string()});
  return command;
}

/// The exit code of a study from those of its runs; those that did not start count as interrupted.
int worst_code(const std::vector<StudyRun>& runs, const std::map<std::string, int>& exit_codes)
{
  int worst = exit_ok;
  for (const StudyRun& run : runs) {
    const auto code = exit_codes.find(run.name);
    const int ended = code == exit_codes.end() ? int(exit_interrupted) : code->second;
    if (ended > exit_lost_equilibrium) // killed
      worst = std::max(worst, int(exit_failure));
    else if (ended != exit_lost_equilibrium)
      worst = std::max(worst, ended);
  }
  return worst;
}

std::vector<LoadedScene> scenes_of(const LoadedScene& study, const std::vector<StudyRun>& runs,
                                   const std::filesystem::path& folder)
{
  std::vector<LoadedScene> scenes;
  for (const StudyRun& run : runs) {
    std::vector<std::string> settings = run.settings();
    settings.push_back("Output/Folder = " + absolute_folder(folder / run.name).string());
    if (runs.size() > most_in_full)
      settings.push_back("Output/Plots = false");
    scenes.push_back(scene_of_run(study, run.name, settings));
  }
  return scenes;
}

/// A cell of a CSV table, in quotes.
std::string quoted(const std::string& text)
{
  std::string cell = "\"";
  for (const char c : text)
    cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + '"';
}

/// The runs of a study, what was varied, and how each ended, for those who read its results.
void write_runs(const std::filesystem::path& folder, const std::vector<StudyRun>& runs,
                const std::map<std::string, int>& exit_codes)
{
  std::string table = "run,exit_code,statement";
  for (const auto& level : runs.front().levels)
    table += ',' + quoted(level.first);
  table += '\n';
  for (const StudyRun& run : runs) {
    const std::filesystem::path log = folder / run.name / "run.log";
    const auto code = exit_codes.find(run.name);
    table += fmt::format(
        "{},{},{}", run.name, code == exit_codes.end() ? -1 : code->second,
        quoted(std::filesystem::exists(log) ? last_statement(read_text_file(log)) : "not started"));
    for (const auto& level : run.levels)
      table += ',' + quoted(level.second);
    table += '\n';
  }
  write_text_file(folder / "runs.csv", table);
}

/// Names the runs that failed, each with its reason.
void tell_failures(const std::filesystem::path& folder, const std::vector<StudyRun>& runs,
                   const std::map<std::string, int>& exit_codes)
{
  for (const StudyRun& run : runs) {
    const int code = exit_codes.at(run.name);
    if (code != exit_ok && code != exit_lost_equilibrium)
      fmt::print(stderr, "failed: {} (exit code {}): {}\n", run.name, code,
                 last_statement(read_text_file(folder / run.name / "run.log")));
  }
}

/// Tables and figures of a study that has come to its end.
void summarise(const LoadedScene& scene, const std::filesystem::path& folder,
               const std::vector<StudyRun>& runs)
{
  std::vector<std::filesystem::path> results;
  for (const StudyRun& run : runs)
    if (has_result(folder / run.name))
      results.push_back(folder / run.name);
  const bool plots = scene.scene->output.plots;
  std::vector<std::string> figures;
  if (plots && !results.empty() && runs.size() <= most_in_full)
    figures = make_figures(results, folder);
  if (!results.empty())
    for (std::string& figure : make_study_summary(folder, plots))
      figures.push_back(std::move(figure));
  for (const std::string& figure : figures)
    fmt::print("figure {}\n", figure);
  fmt::print("{}: {} of {} runs finished, results in {}\n", scene.name, results.size(), runs.size(),
             folder.string());
}

} // namespace

std::vector<StudyRun> study_runs(const Scene& scene)
{
  return combined_runs(scene.study.vary, scene.study.values);
}

std::map<std::string, int> listed_runs(const std::filesystem::path& folder)
{
  std::map<std::string, int> codes;
  if (!std::filesystem::exists(folder / "runs.csv"))
    return codes;
  std::vector<std::string> lines = split(read_text_file(folder / "runs.csv"), '\n');
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::vector<std::string> cells = split(lines[k], ','); // the first two hold no commas
    if (cells.size() > 2)
      codes[cells[0]] = std::atoi(cells[1].c_str());
  }
  return codes;
}

std::vector<Diagnostic> check_study_runs(const std::filesystem::path& scene_file,
                                         const std::vector<std::string>& overrides,
                                         const std::vector<StudyRun>& runs)
{
  std::vector<Diagnostic> problems;
  for (const StudyRun& run : runs) {
    std::vector<std::string> all = overrides;
    for (const std::string& setting : run.settings())
      all.push_back(setting);
    const auto tell = [&](const std::string& place, const std::string& message) {
      problems.push_back(
          {Diagnostic::Kind::error, place, fmt::format("run '{}': {}", run.value, message)});
    };
    const LoadedScene loaded = load_scene(scene_file, all);
    for (const Diagnostic& each : loaded.diagnostics)
      if (each.kind == Diagnostic::Kind::error)
        tell(each.place == "--set" ? "Study" : each.place, each.message);
    if (loaded.has_errors())
      continue;
    try {
      measured_curve(loaded);
    } catch (const std::invalid_argument& problem) {
      tell("Output/Measured", problem.what());
    }
  }
  return problems;
}

int run_study(LoadedScene scene, const RunOptions& options, bool resume)
{
  const std::vector<StudyRun> runs = study_runs(*scene.scene);
  const std::filesystem::path folder = result_folder(scene);
  require_writable(folder);
  store_study(scene, folder, options.overrides);
  const int at_a_time = std::clamp(options.n_threads, 1, int(runs.size()));
  fmt::print("{}: study of {} runs, {} at a time\n", scene.name, runs.size(), at_a_time);
  if (!resume)
    clear(folder, runs);
  const std::map<std::string, int> listed = listed_runs(folder);
  const std::vector<LoadedScene> scenes = scenes_of(scene, runs, folder);
  const auto packings = study_packings(scenes, folder, options);
  const Setting setting{folder, std::max(1, options.n_threads / at_a_time), options.overrides,
                        resume};
  RunPool pool(folder, runs.size(), options, runs.size() > most_in_full);
  for (std::size_t k = 0; k < runs.size() && !interrupted(); ++k) {
    if (resume && has_result(folder / runs[k].name)) {
      fmt::print("{}: finished before\n", runs[k].name);
      pool.count_as_finished(runs[k], code_before(listed, folder, runs[k]));
      continue;
    }
    std::error_code ignored;
    std::filesystem::remove(folder / runs[k].name / "result.h5", ignored);
    pool.wait_for_room(std::size_t(at_a_time) - 1);
    if (!interrupted())
      pool.start(runs[k], command_for(runs[k], scenes[k], packings[k], setting));
  }
  pool.wait_for_room(0);
  write_runs(folder, runs, pool.exit_codes());
  if (interrupted()) {
    fmt::print("{}: interrupted; to go on: mastic run --resume {}\n", scene.name, folder.string());
    return exit_interrupted;
  }
  tell_failures(folder, runs, pool.exit_codes());
  summarise(scene, folder, runs);
  return worst_code(runs, pool.exit_codes());
}

} // namespace apps
