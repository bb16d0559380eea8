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

} // namespace

std::vector<std::string> make_figures(const std::vector<std::filesystem::path>& results,
                                      const std::filesystem::path& folder)
{
  Finished finished{"", 127};
  try {
    std::vector<std::string> command{python, (share_folder() / "plot.py").string(),
                                     folder.string()};
    for (const std::filesystem::path& each : results)
      command.push_back(each.string());
    finished = run_to_end(command);
  } catch (const std::runtime_error& problem) {
    finished.output = problem.what();
  }
  if (finished.exit_code != 0) {
    fmt::print(stderr, "warning: no figures: {}\n", trimmed(finished.output));
    return {};
  }
  std::vector<std::string> figures;
  for (const std::string& line : split(finished.output, '\n'))
    if (line.ends_with(".png")) // Python's own warnings come in the same pipe
      figures.push_back(line);
  return figures;
}

} // namespace apps
