#include "apps/plot.h"

#include "apps/files.h"
#include "apps/process.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <stdexcept>

namespace apps {

namespace {

/// Debian's own Python: another one that comes first on the path lacks Matplotlib.
constexpr const char* python = "/usr/bin/python3";

/// Runs one of the program's scripts; \return the files with an ending that it names.
std::vector<std::string> draw(const std::string& script, const std::vector<std::string>& arguments,
                              const std::string& ending = ".png")
{
  Finished finished{"", 127};
  try {
    std::vector<std::string> command{python, (share_folder() / script).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    finished = run_to_end(command);
  } catch (const std::runtime_error& problem) {
    finished.output = problem.what();
  }
  if (finished.exit_code != 0) {
    fmt::print(stderr, "warning: {}: {}\n", script, trimmed(finished.output));
    return {};
  }
  std::vector<std::string> figures;
  for (const std::string& line : split(finished.output, '\n'))
    if (line.ends_with(ending)) // Python's own warnings come in the same pipe
      figures.push_back(line);
    else if (line.starts_with("note: "))
      fmt::print(stderr, "{}\n", line);
  return figures;
}

} // namespace

std::vector<std::string> make_figures(const std::vector<std::filesystem::path>& results,
                                      const std::filesystem::path& folder)
{
  std::vector<std::string> arguments{folder.string()};
  for (const std::filesystem::path& each : results)
    arguments.push_back(each.string());
  return draw("plot.py", arguments);
}

std::vector<std::string> make_study_summary(const std::filesystem::path& folder, bool figures)
{
  std::vector<std::string> arguments{folder.string()};
  if (!figures)
    arguments.push_back("--tables");
  return draw("campaign.py", arguments);
}

std::optional<std::string> make_report(const std::vector<std::filesystem::path>& results,
                                       const std::filesystem::path& file)
{
  std::vector<std::string> arguments{file.string()};
  for (const std::filesystem::path& each : results)
    arguments.push_back(each.string());
  const std::vector<std::string> made = draw("report.py", arguments, ".html");
  return made.empty() ? std::nullopt : std::optional(made.front());
}

std::vector<std::string> make_pictures(const std::filesystem::path& result,
                                       const std::filesystem::path& folder,
                                       const PictureOptions& options)
{
  std::vector<std::string> arguments{folder.string(), result.string(), "--magnify",
                                     fmt::format("{}", options.magnify)};
  if (!options.time.empty())
    arguments.insert(arguments.end(), {"--time", options.time});
  return draw("specimen_picture.py", arguments);
}

std::vector<std::string> make_study_figure(const std::filesystem::path& folder)
{
  return draw("work_precision.py", {folder.string()});
}

std::vector<std::string> make_extraction_figures(const std::filesystem::path& folder)
{
  return draw("extraction.py", {folder.string()});
}

std::vector<std::string> make_calibration_figures(const std::filesystem::path& folder)
{
  return draw("calibration.py", {folder.string()});
}

std::vector<std::string> make_fit_figures(const std::filesystem::path& folder)
{
  return draw("fit.py", {folder.string()});
}

} // namespace apps
