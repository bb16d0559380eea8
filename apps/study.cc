#include "apps/study.h"

#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/plot.h"
#include "apps/process.h"
#include "apps/progress.h"
#include "apps/text.h"
#include "dem/hdf5_file.h"

#include <fmt/format.h>

#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>

namespace apps {

namespace {

constexpr const char* study_scene = "study.scene";
constexpr const char* packing_file = "packing.h5";

/// A run that is going on, and what it has said so far.
struct Active {
  StudyRun run;
  Child child;
  std::string unread; ///< the beginning of a line
  std::string log;
  double fraction = 0;
  std::string state;
};

bool has_result(const std::filesystem::path& folder)
{
  try {
    return dem::Hdf5File::open(folder / "result.h5").is_complete();
  } catch (const std::runtime_error&) {
    return false;
  }
}

/// A value as a part of a file name: "400 kPa" is "400-kPa".
std::string as_file_name(const std::string& value)
{
  std::string name;
  for (const char c : value)
    name += std::isalnum(static_cast<unsigned char>(c)) || c == '.' ? c : '-';
  return name;
}

/// The command of one run.
std::vector<std::string> command_for(const StudyRun& run, const std::filesystem::path& folder,
                                     const std::filesystem::path& scene, bool with_packing,
                                     bool resume)
{
  const std::filesystem::path own = folder / run.name;
  std::vector<std::string> command{own_executable().string(), "run", "--report"};
  if (resume && std::filesystem::exists(own / "checkpoint.h5")) {
    command.insert(command.end(), {"--resume", (own / "checkpoint.h5").string()});
    return command;
  }
  command.push_back(scene.string());
  command.insert(command.end(), {"--set", run.override_text});
  command.insert(command.end(), {"--set", "Output/Folder = " + own.string()});
  command.insert(command.end(), {"--set", "Study/Vary =", "--set", "Study/Values ="});
  if (with_packing)
    command.insert(command.end(), {"--packing", (folder / packing_file).string()});
  return command;
}

/// Takes in what a child has written; \return false when it has ended.
bool listen(Active& active)
{
  char buffer[4096];
  const ssize_t n = ::read(active.child.output, buffer, sizeof buffer);
  if (n < 0 && errno == EINTR)
    return true;
  if (n <= 0)
    return false;
  active.unread.append(buffer, std::size_t(n));
  for (std::size_t end; (end = active.unread.find('\n')) != std::string::npos;) {
    const std::string line = active.unread.substr(0, end);
    active.unread.erase(0, end + 1);
    if (line.starts_with("progress ")) {
      active.fraction = std::atof(line.c_str() + 9);
      active.state = line.substr(std::min(line.size(), line.find(' ', 9) + 1));
    } else
      active.log += line + '\n';
  }
  return true;
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
    active_.push_back({run, start_child(command), "", "", 0, ""});
  }
  std::size_t n_active() const { return active_.size(); }

  void wait_for_room(std::size_t most)
  {
    while (active_.size() > most) {
      std::vector<pollfd> ready;
      for (const Active& each : active_)
        ready.push_back({each.child.output, POLLIN, 0});
      ::poll(ready.data(), ready.size(), 500);
      if (interrupted() && !told_children_) {
        for (const Active& each : active_)
          ::kill(each.child.pid, SIGTERM);
        told_children_ = true;
      }
      for (std::size_t k = active_.size(); k-- > 0;)
        if (ready[k].revents != 0 && !listen(active_[k]))
          finish(k);
      tell();
    }
  }

private:
  void finish(std::size_t k)
  {
    Active& active = active_[k];
    const int code = wait_for(active.child);
    exit_codes[active.run.name] = code;
    progress_.finish();
    fmt::print("{}", active.log);
    std::fflush(stdout);
    write_text_file(folder_ / active.run.name / "run.log", active.log);
    active_.erase(active_.begin() + std::ptrdiff_t(k));
  }

  void tell()
  {
    double done = double(exit_codes.size());
    std::string states;
    for (const Active& each : active_) {
      done += each.fraction;
      states += fmt::format("{}{}: {}", states.empty() ? "" : "; ", each.run.name,
                            each.state.empty() ? "begins" : each.state);
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

/// The packing that all runs share, unless the study varies it.
bool prepare_packing(const LoadedScene& scene, const std::filesystem::path& folder)
{
  const bool generated = scene.scene->specimen.source == SpecimenSource::generate;
  if (!generated || scene.scene->study.vary.starts_with("Specimen/"))
    return false;
  const std::string recipe = packing_recipe(*scene.scene);
  const std::filesystem::path file = folder / packing_file;
  try {
    read_packing(file, recipe);
    fmt::print("packing: {} is up to date\n", file.string());
  } catch (const std::runtime_error&) {
    fmt::print("packing: {} spheres ...\n", scene.scene->specimen.n_particles);
    std::fflush(stdout);
    const Packing packing = make_packing(scene);
    write_packing(file, packing, recipe);
    fmt::print("{}", packing_report(*scene.scene, packing));
  }
  return true;
}

} // namespace

std::vector<StudyRun> study_runs(const Scene& scene)
{
  std::vector<StudyRun> runs;
  const std::string& vary = scene.study.vary;
  if (vary.empty())
    return runs;
  const std::string key = vary.substr(vary.rfind('/') + 1);
  for (const std::string& value : split(scene.study.values, ','))
    runs.push_back({as_file_name(value), vary + " = " + value});
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
    for (Diagnostic& each : load_scene(scene_file, all).diagnostics)
      if (each.place == "--set" && each.kind == Diagnostic::Kind::error) {
        each.place = "Study/Values";
        problems.push_back(each);
      }
  }
  return problems;
}

int run_study(LoadedScene scene, const RunOptions& options, bool resume)
{
  const std::vector<StudyRun> runs = study_runs(*scene.scene);
  const std::filesystem::path folder = result_folder(scene);
  std::filesystem::create_directories(folder);
  write_text_file(folder / study_scene,
                  fmt::format("# folder of the files that the scene names: {}\n# name: {}\n{}",
                              std::filesystem::absolute(scene.folder).string(), scene.name,
                              scene.schema->print(false)));
  fmt::print("{}: study of {} runs, {} at a time\n", scene.name, runs.size(), options.n_threads);
  const bool with_packing = prepare_packing(scene, folder);

  // The children read the scene as it stands now, next to the files it names.
  const std::filesystem::path child_scene =
      std::filesystem::absolute(scene.folder) / fmt::format(".{}.{}.scene", scene.name, ::getpid());
  write_text_file(child_scene, scene.schema->print(false));
  Pool pool(folder, runs.size(), options);
  for (const StudyRun& run : runs) {
    if (interrupted())
      break;
    if (resume && has_result(folder / run.name)) {
      fmt::print("{}: finished before\n", run.name);
      pool.exit_codes[run.name] = exit_ok;
      continue;
    }
    std::error_code ignored;
    std::filesystem::remove(folder / run.name / "result.h5", ignored);
    pool.wait_for_room(std::size_t(std::max(1, options.n_threads)) - 1);
    if (!interrupted())
      pool.start(run, command_for(run, folder, child_scene, with_packing, resume));
  }
  pool.wait_for_room(0);
  std::filesystem::remove(child_scene);

  int worst = exit_ok;
  std::vector<std::filesystem::path> results;
  for (const StudyRun& run : runs) {
    const auto code = pool.exit_codes.find(run.name);
    const int ended = code == pool.exit_codes.end() ? exit_interrupted : code->second;
    if (ended != exit_ok && ended != exit_lost_equilibrium)
      worst = std::max(worst, ended);
    if (has_result(folder / run.name))
      results.push_back(folder / run.name);
  }
  if (interrupted()) {
    fmt::print("{}: interrupted; to go on: mastic run --resume {}\n", scene.name, folder.string());
    return exit_interrupted;
  }
  if (scene.scene->output.plots && !results.empty())
    for (const std::string& figure : make_figures(results, folder))
      fmt::print("figure {}\n", figure);
  fmt::print("{}: {} of {} runs finished, results in {}\n", scene.name, results.size(),
             runs.size(), folder.string());
  return worst;
}

int resume_study(const std::filesystem::path& folder, const RunOptions& options)
{
  const std::string text = read_text_file(folder / study_scene);
  const auto after = [&](const std::string& mark) {
    const std::size_t begin = text.find(mark) + mark.size();
    return text.substr(begin, text.find('\n', begin) - begin);
  };
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back("Output/Folder = " + folder.string());
  LoadedScene scene = load_scene_text(text, after("# name: ") + ".scene",
                                      after("the scene names: "), overrides);
  print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    return exit_input;
  return run_study(std::move(scene), options, true);
}

} // namespace apps
