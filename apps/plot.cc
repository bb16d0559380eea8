#include "apps/plot.h"

#include "apps/files.h"
#include "apps/process.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

namespace apps {

namespace {

/// Debian's own Python: another one that comes first on the path lacks Matplotlib.
constexpr const char* python = "/usr/bin/python3";

} // namespace

std::vector<std::string> make_figures(const std::vector<std::filesystem::path>& results,
                                      const std::filesystem::path& folder)
{
  std::vector<std::string> command{python, (share_folder() / "plot.py").string(), folder.string()};
  for (const std::filesystem::path& each : results)
    command.push_back(each.string());
  Finished finished{"", 127};
  try {
    finished = run_to_end(command);
  } catch (const std::runtime_error&) {
    finished.output = "it cannot be started";
  }
  if (finished.exit_code != 0) {
    fmt::print(stderr, "warning: no figures: {} said: {}\n", python, trimmed(finished.output));
    return {};
  }
  return split(finished.output, '\n');
}

} // namespace apps
