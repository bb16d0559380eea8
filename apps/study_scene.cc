#include "apps/study_scene.h"

#include "apps/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <stdexcept>

namespace apps {

std::string as_folder_name(const std::string& value)
{
  std::string name;
  for (const char c : value)
    name += std::isalnum(static_cast<unsigned char>(c)) || c == '.' ? c : '-';
  const bool plain = !name.empty() && std::isalnum(static_cast<unsigned char>(name.front()));
  return plain ? name : "run" + name; // no hidden folders, none that looks like an option
}

LoadedScene scene_of_run(const LoadedScene& study, const std::string& name,
                         std::vector<std::string> settings)
{
  settings.insert(settings.end(), {"Study/Vary =", "Study/Values ="});
  const std::string text = study.schema->print(false), file_name = name + ".scene";
  const LoadedScene varied = load_scene_text(text, file_name, study.folder, settings);
  const auto full_name = [&](const std::string& file) {
    return file.empty() ? "" : (absolute_folder(study.folder) / file).string();
  };
  settings.push_back("Specimen/File = " + full_name(varied.scene->specimen.file));
  settings.push_back("Specimen/Bond file = " + full_name(varied.scene->specimen.bond_file));
  settings.push_back("Body/Law = " + full_name(varied.scene->continuum.body.law_file));
  settings.push_back("Body/Mesh file = " + full_name(varied.scene->continuum.body.mesh_file));
  for (const auto& [region, law] : varied.scene->continuum.regions)
    settings.push_back(fmt::format("Region {}/Law = {}", region, full_name(law)));
  return load_scene_text(text, file_name, study.folder, settings);
}

std::optional<std::filesystem::path> shared_packing(const std::vector<LoadedScene>& scenes,
                                                    const std::filesystem::path& folder,
                                                    const RunOptions& options)
{
  const std::string recipe = packing_recipe(*scenes.front().scene);
  if (scenes.front().scene->solver == SolverChoice::continuum)
    return std::nullopt;
  const bool shared = std::ranges::all_of(scenes, [&](const LoadedScene& each) {
    return each.scene->specimen.source == SpecimenSource::generate &&
           packing_recipe(*each.scene) == recipe;
  });
  if (options.packing && !shared)
    throw std::invalid_argument("--packing: the runs of this study do not share a packing");
  if (!shared)
    return std::nullopt;
  const std::filesystem::path file = options.packing.value_or(folder / "packing.h5");
  try {
    read_packing(file, recipe);
    fmt::print("packing: {} is up to date\n", file.string());
  } catch (const std::invalid_argument&) {
    if (options.packing)
      throw;
    fmt::print("packing: {} spheres ...\n", scenes.front().scene->specimen.n_particles);
    std::fflush(stdout);
    const Packing packing = make_packing(scenes.front());
    write_packing(file, packing, recipe);
    fmt::print("{}", packing_report(*scenes.front().scene, packing));
  }
  return file;
}

} // namespace apps
