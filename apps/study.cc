#include "apps/study.h"

#include "apps/checkpoint.h"
#include "apps/child_run.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/plot.h"
#include "apps/progress.h"
#include "apps/study_scene.h"
#include "apps/text.h"
#include "dem/hdf5_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

constexpr const char* study_scene = "study.scene";

/// A run that is going on.
struct Active {
  StudyRun run;
  ChildRun child;
};

bool has_result(const std::filesystem::path& folder)
{
  try {
    return dem::Hdf5File::open(folder / "result.h5").is_complete();
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// What all runs of a study have in common.
struct Setting {
  std::filesystem::path folder;
  std::optional<std::filesystem::path> packing;
  int n_threads; ///< of one run
  const std::vector<std::string>& overrides;
  bool resume;
};

/// The command of one run, whose scene is written into its folder.
std::vector<std::string> command_for(const StudyRun& run, const LoadedScene& scene,
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
  if (setting.packing)
    command.insert(command.end(), {"--packing", setting.packing->string()});
  return command;
}

/// Runs up to n at a time; calls finished(active, exit code) as they end.
class Pool {
public:
  Pool(std::filesystem::path folder, std::size_t n_runs, const RunOptions& options)
      : folder_(std::move(folder)), n_runs_(n_runs), options_(options),
        progress_(folder_.filename().string(), options.quiet, false)
  {
  }

  std::map<std::string, int> exit_codes; ///< by name

  void start(const StudyRun& run, const std::vector<std::string>& command)
  {
    active_.push_back({run, {start_child(command), "", 0, "", ""}});
  }
  std::size_t n_active() const { return active_.size(); }

  void wait_for_room(std::size_t most)
  {
    while (active_.size() > most) {
      std::vector<const ChildRun*> children;
      for (const Active& each : active_)
        children.push_back(&each.child);
      const std::vector<bool> ready = wait_for_output(children, 500);
      if (interrupted() && !told_children_) {
        for (const Active& each : active_)
          stop(each.child);
        told_children_ = true;
      }
      for (std::size_t k = active_.size(); k-- > 0;)
        if (ready[k] && !listen(active_[k].child))
          finish(k);
      tell();
    }
  }

private:
  void finish(std::size_t k)
  {
    Active& active = active_[k];
    const int code = wait_for(active.child.child);
    exit_codes[active.run.name] = code;
    progress_.finish();
    fmt::print("{}", active.child.log);
    std::fflush(stdout);
    write_text_file(folder_ / active.run.name / "run.log", active.child.log);
    active_.erase(active_.begin() + std::ptrdiff_t(k));
  }

  void tell()
  {
    double done = double(exit_codes.size());
    std::string states;
    for (const Active& each : active_) {
      done += each.child.fraction;
      states += fmt::format("{}{}: {}", states.empty() ? "" : "; ", each.run.name,
                            each.child.state.empty() ? "begins" : each.child.state);
    }
    progress_.update(done / double(n_runs_), states);
  }

  std::filesystem::path folder_;
  std::size_t n_runs_;
  const RunOptions& options_;
  Progress progress_;
  std::vector<Active> active_;
  bool told_children_ = false;
};

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

/// What is noted behind a mark in the head of a stored study.
std::string noted(const std::string& text, const std::string& mark)
{
  const std::size_t found = text.find(mark);
  if (found == std::string::npos)
    throw std::invalid_argument(
        fmt::format("{}: '{}' is missing: was it changed?", study_scene, mark));
  const std::size_t begin = found + mark.size();
  return text.substr(begin, text.find('\n', begin) - begin);
}

constexpr const char* folder_mark = "# folder of the files that the scene names: ";
constexpr const char* name_mark = "# name: ";

} // namespace

std::vector<StudyRun> study_runs(const Scene& scene)
{
  std::vector<StudyRun> runs;
  const std::string& vary = scene.study.vary;
  if (vary.empty())
    return runs;
  for (const std::string& value : split(scene.study.values, ',')) {
    std::string name = as_folder_name(value);
    while (std::ranges::find(runs, name, &StudyRun::name) != runs.end())
      name += "-";
    runs.push_back({name, value, vary + " = " + value});
  }
  return runs;
}

std::vector<Diagnostic> check_study_runs(const std::filesystem::path& scene_file,
                                         const std::vector<std::string>& overrides,
                                         const std::vector<StudyRun>& runs)
{
  std::vector<Diagnostic> problems;
  for (const StudyRun& run : runs) {
    std::vector<std::string> all = overrides;
    all.push_back(run.override_text);
    for (const Diagnostic& each : load_scene(scene_file, all).diagnostics)
      if (each.kind == Diagnostic::Kind::error)
        problems.push_back({each.kind, each.place == "--set" ? "Study" : each.place,
                            fmt::format("run '{}': {}", run.value, each.message)});
  }
  return problems;
}

int run_study(LoadedScene scene, const RunOptions& options, bool resume)
{
  const std::vector<StudyRun> runs = study_runs(*scene.scene);
  const std::filesystem::path folder = result_folder(scene);
  require_writable(folder);
  write_text_file(folder / study_scene,
                  fmt::format("{}{}\n{}{}\n{}", folder_mark, absolute_folder(scene.folder).string(),
                              name_mark, scene.name, scene.schema->print(false)));
  const int at_a_time = std::clamp(options.n_threads, 1, int(runs.size()));
  fmt::print("{}: study of {} runs, {} at a time\n", scene.name, runs.size(), at_a_time);
  std::vector<LoadedScene> scenes;
  for (const StudyRun& run : runs)
    scenes.push_back(scene_of_run(
        scene, run.name,
        {run.override_text, "Output/Folder = " + absolute_folder(folder / run.name).string()}));
  const Setting setting{folder, shared_packing(scenes, folder, options),
                        std::max(1, options.n_threads / at_a_time), options.overrides, resume};
  Pool pool(folder, runs.size(), options);
  for (std::size_t k = 0; k < runs.size() && !interrupted(); ++k) {
    if (resume && has_result(folder / runs[k].name)) {
      fmt::print("{}: finished before\n", runs[k].name);
      pool.exit_codes[runs[k].name] = exit_ok;
      continue;
    }
    std::error_code ignored;
    std::filesystem::remove(folder / runs[k].name / "result.h5", ignored);
    pool.wait_for_room(std::size_t(at_a_time) - 1);
    if (!interrupted())
      pool.start(runs[k], command_for(runs[k], scenes[k], setting));
  }
  pool.wait_for_room(0);

  std::vector<std::filesystem::path> results;
  for (const StudyRun& run : runs)
    if (has_result(folder / run.name))
      results.push_back(folder / run.name);
  if (interrupted()) {
    fmt::print("{}: interrupted; to go on: mastic run --resume {}\n", scene.name, folder.string());
    return exit_interrupted;
  }
  if (scene.scene->output.plots && !results.empty())
    for (const std::string& figure : make_figures(results, folder))
      fmt::print("figure {}\n", figure);
  fmt::print("{}: {} of {} runs finished, results in {}\n", scene.name, results.size(), runs.size(),
             folder.string());
  return worst_code(runs, pool.exit_codes);
}

int resume_study(const std::filesystem::path& folder, const RunOptions& options)
{
  refuse_other_options(options);
  const std::string text = read_text_file(folder / study_scene);
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back("Output/Folder = " + folder.string());
  LoadedScene scene = load_scene_text(text, study_scene, noted(text, folder_mark), overrides);
  scene.name = noted(text, name_mark);
  print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    return exit_input;
  return run_study(std::move(scene), options, true);
}

} // namespace apps
