#include "apps/study_scene.h"

#include "apps/files.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

/// The file of a packing: the one given, or one that is up to date or made now.
std::filesystem::path stored_packing(const LoadedScene& scene, const std::string& recipe,
                                     const std::filesystem::path& own,
                                     const std::optional<std::filesystem::path>& given)
{
  const std::filesystem::path file = given.value_or(own);
  try {
    read_packing(file, recipe);
    fmt::print("packing: {} is up to date\n", file.string());
  } catch (const std::invalid_argument&) {
    if (given)
      throw;
    fmt::print("packing: {} spheres ...\n", scene.scene->specimen.n_particles);
    std::fflush(stdout);
    const Packing packing = make_packing(scene);
    write_packing(file, packing, recipe);
    fmt::print("{}", packing_report(*scene.scene, packing));
  }
  return file;
}

} // namespace

LoadedScene scene_of_run(const LoadedScene& study, const std::string& name,
                         std::vector<std::string> settings)
{
  settings.insert(settings.end(), {"Study/Vary =", "Study/Values =", "Study/Scene files ="});
  const std::string text = study.schema->print(false), file_name = name + ".scene";
  const LoadedScene varied = load_scene_text(text, file_name, study.folder, settings);
  const auto full_name = [&](const std::string& file) {
    return file.empty() ? "" : (absolute_folder(study.folder) / file).string();
  };
  settings.push_back("Specimen/File = " + full_name(varied.scene->specimen.file));
  settings.push_back("Specimen/Bond file = " + full_name(varied.scene->specimen.bond_file));
  settings.push_back("Output/Measured = " + full_name(varied.scene->output.measured));
  settings.push_back("Body/Law = " + full_name(varied.scene->continuum.body.law_file));
  settings.push_back("Body/Mesh file = " + full_name(varied.scene->continuum.body.mesh_file));
  for (const auto& [region, law] : varied.scene->continuum.regions)
    settings.push_back(fmt::format("Region {}/Law = {}", region, full_name(law)));
  return load_scene_text(text, file_name, study.folder, settings);
}

std::vector<std::optional<std::filesystem::path>>
study_packings(const std::vector<LoadedScene>& scenes, const std::filesystem::path& folder,
               const RunOptions& options)
{
  std::map<std::string, std::vector<std::size_t>> runs_of; // by recipe
  for (std::size_t k = 0; k < scenes.size(); ++k)
    if (scenes[k].scene->solver != SolverChoice::continuum &&
        scenes[k].scene->specimen.source == SpecimenSource::generate)
      runs_of[packing_recipe(*scenes[k].scene)].push_back(k);
  const bool one = runs_of.size() == 1 && runs_of.begin()->second.size() == scenes.size();
  if (options.packing && !one)
    throw std::invalid_argument("--packing: the runs of this study do not share a packing");
  std::vector<std::optional<std::filesystem::path>> files(scenes.size());
  for (const auto& [recipe, runs] : runs_of) {
    if (runs.size() < 2 && !one)
      continue; // made by the run itself
    const LoadedScene& first = scenes[runs.front()];
    const std::string name = one ? "packing.h5" : fmt::format("packing-of-{}.h5", first.name);
    const auto file = stored_packing(first, recipe, folder / name, options.packing);
    for (const std::size_t k : runs)
      files[k] = file;
  }
  return files;
}

} // namespace apps
