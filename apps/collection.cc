#include "apps/collection.h"

#include "apps/checkpoint.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/plot.h"
#include "apps/stored_study.h"
#include "apps/study.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace apps {

namespace fs = std::filesystem;

namespace {

/// Name of the folder of a scene within the collection: that of its own results, or of its file.
std::string folder_name(const fs::path& file, const std::vector<std::string>& overrides)
{
  const LoadedScene loaded = load_scene(file, overrides);
  const fs::path own = loaded.has_errors() ? "" : loaded.scene->output.folder;
  return (own.filename().empty() ? file.stem() : own.filename()).string();
}

/// A scene of a collection, loaded as it is run.
LoadedScene member(const fs::path& file, const std::vector<std::string>& overrides,
                   const fs::path& folder)
{
  std::vector<std::string> settings = overrides;
  settings.push_back("Output/Folder = " + absolute_folder(folder).string());
  return load_scene(file, settings);
}

/// Goes on with a scene that was begun in a folder.
int go_on(const fs::path& folder, const RunOptions& options)
{
  if (is_study(folder))
    return run_study(read_study(folder, options.overrides).scene, options, true);
  if (has_checkpoint(folder))
    return resume_run(checkpoint_file(folder), options);
  fmt::print("{}: finished before\n", folder.filename().string());
  return exit_ok;
}

/// Does the work for one scene; an error is told and does not end the collection.
template <typename Work>
int code_of(const fs::path& file, const Work& work)
{
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "failed: {}: {}\n", file.stem().string(), error.what());
    return exit_input;
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "failed: {}: {}\n", file.stem().string(), error.what());
    return exit_failure;
  }
}

bool begun(const fs::path& folder)
{
  return is_study(folder) || has_checkpoint(folder) || fs::exists(folder / "result.h5");
}

/// Takes away what would make a scene count as begun.
void forget(const fs::path& folder)
{
  std::error_code ignored;
  fs::remove(folder / study_file, ignored);
  fs::remove(folder / "result.h5", ignored);
  remove_checkpoints(folder);
}

} // namespace

std::vector<fs::path> collected_scenes(const LoadedScene& scene)
{
  std::vector<fs::path> files;
  for (const std::string& each : split(scene.scene->study.scenes, ','))
    files.push_back(absolute_folder(scene.folder) / each);
  return files;
}

std::vector<Diagnostic> check_collection(const std::vector<fs::path>& scenes,
                                         const std::vector<std::string>& overrides)
{
  std::vector<Diagnostic> problems;
  const auto wrong = [&](const std::string& message) {
    problems.push_back({Diagnostic::Kind::error, "Study/Scene files", message});
  };
  std::vector<std::string> names;
  for (const fs::path& file : scenes) {
    if (!fs::is_regular_file(file)) {
      wrong(fmt::format("{}: there is no such file", file.string()));
      continue;
    }
    const std::string name = folder_name(file, overrides);
    if (std::ranges::find(names, name) != names.end())
      wrong(fmt::format("two scenes would have their results in a folder '{}'", name));
    names.push_back(name);
    const LoadedScene loaded = member(file, overrides, "results");
    for (Diagnostic each : loaded.diagnostics)
      problems.push_back(std::move(each));
    if (loaded.has_errors())
      continue;
    if (!loaded.scene->study.scenes.empty())
      wrong(fmt::format("{}: names other scenes itself", file.string()));
    std::vector<std::string> settings = overrides;
    settings.push_back("Output/Folder = results");
    for (Diagnostic& each : check_study_runs(file, settings, study_runs(*loaded.scene)))
      problems.push_back(std::move(each));
  }
  return problems;
}

int run_collection(const StoredStudy& stored, const RunOptions& options, bool resume)
{
  const LoadedScene& collection = stored.scene;
  const std::vector<fs::path> files = collected_scenes(collection);
  const fs::path folder = result_folder(collection);
  require_writable(folder);
  store_study(collection, folder, stored.overrides);
  fmt::print("{}: {} scenes, one after the other\n", collection.name, files.size());
  int worst = exit_ok;
  std::vector<fs::path> own_folders;
  for (const fs::path& file : files) {
    own_folders.push_back(folder / folder_name(file, stored.overrides));
    if (!resume)
      forget(own_folders.back());
  }
  for (std::size_t k = 0; k < files.size(); ++k) {
    const fs::path &file = files[k], &own = own_folders[k];
    const int code = code_of(file, [&] {
      if (resume && begun(own))
        return go_on(own, options);
      LoadedScene scene = member(file, stored.overrides, own);
      return study_runs(*scene.scene).empty() ? run_scene(std::move(scene), options)
                                              : run_study(std::move(scene), options, false);
    });
    worst = code == exit_lost_equilibrium ? worst : std::max(worst, code);
    if (interrupted()) {
      fmt::print("{}: interrupted; to go on: mastic run --resume {}\n", collection.name,
                 folder.string());
      return exit_interrupted;
    }
  }
  if (collection.scene->output.plots)
    if (const auto report = make_report(own_folders, folder / "report.html"))
      fmt::print("report {}\n", *report);
  fmt::print("{}: results in {}\n", collection.name, folder.string());
  return worst;
}

} // namespace apps
