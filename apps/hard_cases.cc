#include "apps/hard_cases.h"

#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/process.h"
#include "apps/run_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace apps {

namespace {

namespace fs = std::filesystem;

constexpr double time_limit = 120; ///< of one case [s]

/// One row of the table.
struct HardCase {
  std::string name, title, solver;
  std::string expected, found;
  double error = 0, tolerance = 0; ///< of the check that came nearest to its tolerance
  std::size_t n_checks = 0;
  double seconds = 0;
  std::string verdict;

  bool met() const { return verdict == "met"; }
};

std::vector<fs::path> scenes_of(const fs::path& folder)
{
  std::vector<fs::path> scenes;
  if (!fs::is_directory(folder))
    throw std::invalid_argument(fmt::format("{}: there is no such folder", folder.string()));
  for (const auto& file : fs::directory_iterator(folder))
    if (file.path().extension() == ".scene")
      scenes.push_back(file.path());
  std::ranges::sort(scenes);
  return scenes;
}

/// The scenes that come with the program.
fs::path hard_folder()
{
  const fs::path share = share_folder();
  for (const fs::path& folder : {share / "hard", share.parent_path() / "scenes/hard"})
    if (fs::is_directory(folder))
      return folder;
  throw std::runtime_error(fmt::format("there are no hard cases in {}", share.string()));
}

/// The exit code that goes with an end.
int code_of(ExpectedEnd end)
{
  switch (end) {
  case ExpectedEnd::lost_equilibrium:
    return exit_lost_equilibrium;
  case ExpectedEnd::refused:
    return exit_input;
  case ExpectedEnd::failed:
    return exit_failure;
  default:
    return exit_ok;
  }
}

/// Error over tolerance; exact checks that are met come last.
double severity(const Check& check)
{
  return check.tolerance > 0 ? check.error / check.tolerance : check.error > 0 ? 1e300 : 0;
}

void judge(HardCase& row, const Finished& done, ExpectedEnd end, const fs::path& folder)
{
  const std::vector<Check> checks = read_checks(folder);
  row.n_checks = checks.size();
  const auto worst = std::ranges::max_element(checks, {}, severity);
  if (worst != checks.end()) {
    row.expected = worst->what + ": " + worst->expected;
    row.found = worst->found;
    row.error = worst->error;
    row.tolerance = worst->tolerance;
  }
  const bool right_code = done.exit_code == code_of(end) ||
                          (end == ExpectedEnd::any && done.exit_code == exit_lost_equilibrium);
  if (done.timed_out)
    row.verdict = fmt::format("NOT MET: not done within {:g} s", time_limit);
  else if (!right_code)
    row.verdict = fmt::format("NOT MET: exit code {}", done.exit_code);
  else
    row.verdict = !checks.empty() && std::ranges::all_of(checks, &Check::met) ? "met" : "NOT MET";
}

HardCase run_case(const fs::path& file, const fs::path& results, const RunOptions& options)
{
  const LoadedScene scene = load_scene(file, options.overrides);
  const fs::path folder = absolute_folder(results) / scene.name;
  HardCase row;
  row.name = scene.name;
  row.title = scene.scene->title;
  row.solver = name_of(scene.scene->solver);
  fs::remove_all(folder);
  std::vector<std::string> command{
      own_executable().string(),        "run", file.string(), "--quiet", "--threads",
      std::to_string(options.n_threads)};
  std::vector<std::string> settings = options.overrides;
  settings.insert(settings.end(), {"Output/Folder = " + folder.string(), "Output/Plots = false",
                                   "Output/ParaView = false"});
  for (const std::string& each : settings)
    command.insert(command.end(), {"--set", each});
  const auto start = std::chrono::steady_clock::now();
  const Finished done = run_to_end(command, time_limit);
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  judge(row, done, scene.scene->expect.end, folder);
  make_folder(folder);
  write_text_file(folder / "run.log", done.output);
  return row;
}

std::string short_text(const std::string& text, std::size_t most)
{
  return text.size() <= most ? text : text.substr(0, most - 3) + "...";
}

std::string markdown(const std::vector<HardCase>& rows)
{
  std::string text =
      "| case | what | solver | checks | nearest to its tolerance: expected | found "
      "| error | tolerance | s | verdict |\n|---|---|---|---|---|---|---|---|---|---|"
      "\n";
  for (const HardCase& row : rows)
    text +=
        fmt::format("| {} | {} | {} | {} | {} | {} | {:.2g} | {:g} | {:.1f} | {} |\n", row.name,
                    row.title, row.solver, row.n_checks, short_text(row.expected, 60),
                    short_text(row.found, 24), row.error, row.tolerance, row.seconds, row.verdict);
  return text;
}

std::string table_csv(const std::vector<HardCase>& rows)
{
  std::string text = "case,what,solver,checks,expected,found,error,tolerance,time_s,verdict\n";
  for (const HardCase& row : rows) {
    std::string title = row.title;
    std::ranges::replace(title, ',', ';');
    text += fmt::format("{},{},{},{},{},{},{:.3g},{:g},{:.2f},{}\n", row.name, title, row.solver,
                        row.n_checks, row.expected, row.found, row.error, row.tolerance,
                        row.seconds, row.verdict);
  }
  return text;
}

} // namespace

int run_hard_cases(const std::string& folder, const RunOptions& options)
{
  const fs::path results = "results/hard";
  require_writable(results);
  std::vector<HardCase> rows;
  for (const fs::path& file : scenes_of(folder.empty() ? hard_folder() : fs::path(folder))) {
    if (interrupted())
      return exit_interrupted;
    rows.push_back(run_case(file, results, options));
    const HardCase& row = rows.back();
    fmt::print("{:<34} {:<12} {:5.1f} s  {}\n", row.name, row.solver, row.seconds, row.verdict);
    std::fflush(stdout);
  }
  const auto n_met = std::ranges::count_if(rows, &HardCase::met);
  write_text_file(results / "hard.csv", table_csv(rows));
  write_text_file(results / "hard.md", markdown(rows));
  fmt::print("\n{}\n{} of {} cases met; table in {} and hard.csv, all checks in checks.csv of each "
             "case\n",
             markdown(rows), n_met, rows.size(), (results / "hard.md").string());
  return std::size_t(n_met) == rows.size() && n_met > 0 ? exit_ok : exit_not_met;
}

} // namespace apps
