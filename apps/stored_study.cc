#include "apps/stored_study.h"

#include "apps/files.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <stdexcept>

namespace apps {

namespace {

constexpr const char* folder_mark = "# folder of the files that the scene names: ";
constexpr const char* name_mark = "# name: ";
constexpr const char* override_mark = "# --set ";

/// What is noted behind a mark in the head of a stored study, each time that it comes.
std::vector<std::string> noted(const std::string& text, const std::string& mark)
{
  std::vector<std::string> found;
  for (const std::string& line : split(text, '\n'))
    if (line.starts_with(trimmed(mark)))
      found.push_back(trimmed(line.substr(trimmed(mark).size())));
  return found;
}

std::string noted_once(const std::string& text, const std::string& mark)
{
  const std::vector<std::string> found = noted(text, mark);
  if (found.empty())
    throw std::invalid_argument(
        fmt::format("{}: '{}' is missing: was it changed?", study_file, mark));
  return found.front();
}

} // namespace

bool is_study(const std::filesystem::path& folder)
{
  return std::filesystem::exists(folder / study_file);
}

void store_study(const LoadedScene& scene, const std::filesystem::path& folder,
                 const std::vector<std::string>& overrides)
{
  std::string text = fmt::format("{}{}\n{}{}\n", folder_mark,
                                 absolute_folder(scene.folder).string(), name_mark, scene.name);
  for (const std::string& each : overrides)
    text += override_mark + each + '\n';
  write_text_file(folder / study_file, text + scene.schema->print(false));
}

StoredStudy read_study(const std::filesystem::path& folder,
                       const std::vector<std::string>& overrides)
{
  const std::string text = read_text_file(folder / study_file);
  std::vector<std::string> settings = overrides;
  settings.push_back("Output/Folder = " + folder.string());
  StoredStudy study{load_scene_text(text, study_file, noted_once(text, folder_mark), settings),
                    noted(text, override_mark)};
  study.scene.name = noted_once(text, name_mark);
  return study;
}

} // namespace apps
