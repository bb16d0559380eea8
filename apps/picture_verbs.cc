#include "apps/files.h"
#include "apps/plot.h"
#include "apps/quantity.h"
#include "apps/run.h"
#include "apps/study.h"
#include "apps/verbs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace apps {

namespace {

/// The result folders that a name stands for: one, or those of a study.
std::vector<std::filesystem::path> result_folders(const std::string& name)
{
  const std::filesystem::path path = existing(name);
  std::vector<std::filesystem::path> folders;
  if (!std::filesystem::is_directory(path))
    folders.push_back(absolute_folder(path.parent_path()));
  else if (std::filesystem::exists(path / "result.h5"))
    folders.push_back(path);
  else if (std::filesystem::exists(path / "runs.csv"))
    for (const auto& [run, code] : listed_runs(path))
      folders.push_back(path / run);
  else
    for (const auto& inside : std::filesystem::directory_iterator(path))
      folders.push_back(inside.path());
  std::erase_if(folders, [](const std::filesystem::path& folder) {
    return !std::filesystem::exists(folder / "result.h5");
  });
  if (folders.empty())
    throw std::invalid_argument(fmt::format("{}: there are no results in it", name));
  std::ranges::sort(folders, {}, [](const std::filesystem::path& p) { // 400-kPa before 1000-kPa
    return std::pair(std::atof(p.filename().c_str()), p);
  });
  return folders;
}

} // namespace

int plot_verb(const std::vector<std::string>& results, const std::string& output)
{
  std::vector<std::filesystem::path> folders;
  for (const std::string& each : results)
    for (std::filesystem::path& folder : result_folders(each))
      folders.push_back(std::move(folder));
  std::filesystem::path target = output;
  if (output.empty())
    target = std::filesystem::is_directory(results[0]) ? results[0] : folders[0].string();
  make_folder(target);
  const bool study = results.size() == 1 && std::filesystem::exists(target / "runs.csv");
  std::vector<std::string> figures;
  if (!study || folders.size() <= most_in_full)
    figures = make_figures(folders, target);
  if (study)
    for (std::string& figure : make_study_summary(target, true))
      figures.push_back(std::move(figure));
  for (const std::string& figure : figures)
    fmt::print("{}\n", figure);
  return figures.empty() ? exit_failure : exit_ok;
}

int report_verb(const std::vector<std::string>& results, const std::string& output)
{
  std::vector<std::filesystem::path> folders;
  for (const std::string& each : results) {
    const std::filesystem::path folder = existing(each);
    if (!std::filesystem::is_directory(folder))
      throw std::invalid_argument(fmt::format("{}: a report is made of folders", each));
    folders.push_back(folder);
  }
  const std::filesystem::path file =
      output.empty() ? folders.front() / "report.html" : std::filesystem::path(output);
  const std::optional<std::string> made = make_report(folders, file);
  if (made)
    fmt::print("{}\n", *made);
  return made ? exit_ok : exit_failure;
}

int picture_verb(const std::string& result, const std::string& output, const std::string& time,
                 double magnify)
{
  const std::filesystem::path folder = existing(result);
  if (!std::filesystem::exists(folder / "result.h5"))
    throw std::invalid_argument(fmt::format("{}: there is no result.h5 in it", result));
  PictureOptions options{"", magnify};
  if (!time.empty())
    options.time = fmt::format("{:.17g}", Units().parse(time, "s", "s"));
  const std::filesystem::path target = output.empty() ? folder : std::filesystem::path(output);
  make_folder(target);
  const std::vector<std::string> pictures = make_pictures(folder, target, options);
  for (const std::string& picture : pictures)
    fmt::print("{}\n", picture);
  return pictures.empty() ? exit_failure : exit_ok;
}

} // namespace apps
