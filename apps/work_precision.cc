#include "apps/work_precision.h"

#include "apps/progress.h"
#include "apps/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace apps {

namespace {

bool within(const std::optional<double>& error, double accuracy)
{
  return error && *error <= accuracy;
}

/// A relative error in percent, with two digits.
std::string percent(const std::optional<double>& error)
{
  if (!error)
    return "-";
  if (*error == 0)
    return "0";
  return *error < 0.995 ? fmt::format("{:.2g} %", 100 * *error)
                        : fmt::format("{:.0f} %", 100 * *error);
}

std::string count(const StudyRow& row, const char* what)
{
  const auto found = row.counts.find(what);
  return found == row.counts.end() ? "-" : fmt::format("{:.0f}", found->second);
}

std::string rupture_text(const RunErrors& errors)
{
  switch (errors.ruptures) {
  case Ruptures::both:
    return percent(errors.rupture);
  case Ruptures::only_run:
    return "only here";
  case Ruptures::only_reference:
    return "none here";
  default:
    return "none";
  }
}

/// A wall time with three digits, milliseconds if it is short.
std::string seconds_text(double seconds)
{
  return seconds < 0.1 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

/// Rows of cells in columns as wide as they need to be; the first two to the left.
std::string aligned(const std::vector<std::vector<std::string>>& rows)
{
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k)
      widths[k] = std::max(widths[k], row[k].size());
  std::string text;
  for (const auto& row : rows) {
    std::string line = " ";
    for (std::size_t k = 0; k < row.size(); ++k)
      line += k < 2 ? fmt::format(" {:<{}}", row[k], widths[k] + 1)
                    : fmt::format(" {:>{}}", row[k], widths[k] + 1);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// A cell of CSV.
std::string quoted(const std::string& text)
{
  if (text.find_first_of(",\"\n") == std::string::npos)
    return text;
  std::string cell = "\"";
  for (const char c : text)
    cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

/// A number of CSV: full precision, empty if there is none.
std::string number(const std::optional<double>& value, double factor = 1)
{
  return value && std::isfinite(*value) ? shortest(factor * *value) : "";
}

std::optional<double> count_of(const StudyRow& row, const std::string& what)
{
  const auto found = row.counts.find(what);
  return found == row.counts.end() ? std::nullopt : std::optional(found->second);
}

/// "10 %; 1 %": the accuracies for which a row is the cheapest.
std::string accuracies_won(const std::vector<StudyRow>& rows, const StudyRow& row)
{
  std::string text;
  for (const double accuracy : accuracies)
    if (cheapest(rows, accuracy) == &row)
      text += fmt::format("{}{:g} %", text.empty() ? "" : "; ", 100 * accuracy);
  return text;
}

const char* rupture_word(Ruptures ruptures)
{
  switch (ruptures) {
  case Ruptures::both:
    return "both";
  case Ruptures::only_run:
    return "only here";
  case Ruptures::only_reference:
    return "only the reference";
  default:
    return "neither";
  }
}

/// The cells of one row of CSV that come from its run.
std::vector<std::string> run_cells(const StudyRow& row)
{
  const bool finished = row.run.state == RunState::finished;
  const auto if_finished = [&](double value) {
    return finished ? std::optional(value) : std::nullopt;
  };
  std::string settings;
  for (const std::string& each : row.rung.settings)
    settings += (settings.empty() ? "" : "; ") + each;
  return {row.rung.solver,
          row.rung.knob,
          row.rung.knob.empty() ? "" : shortest(row.rung.value),
          settings,
          name_of(row.run.state),
          row.is_reference ? "1" : "0",
          number(if_finished(row.run.solver_time)),
          row.run.n_repetitions > 0 ? shortest(row.run.whole_time) : "",
          std::to_string(row.run.n_repetitions)};
}

/// Those that come from the comparison.
std::vector<std::string> error_cells(const StudyRow& row)
{
  if (!row.curve)
    return std::vector<std::string>(9);
  const RunErrors& e = row.errors;
  const std::vector<double>& broken = row.curve->n_broken;
  return {row.curve->quantity,
          number(e.last_time),
          number(e.largest, 100),
          number(e.at_end, 100),
          broken.empty() ? "" : shortest(broken.back()),
          number(e.broken, 100),
          number(row.curve->rupture_time),
          number(e.rupture, 100),
          rupture_word(e.ruptures)};
}

} // namespace

bool meets(const StudyRow& row, double accuracy)
{
  if (row.run.state != RunState::finished || !within(row.errors.largest, accuracy))
    return false;
  return row.errors.ruptures == Ruptures::neither ||
         (row.errors.ruptures == Ruptures::both && within(row.errors.rupture, accuracy));
}

const StudyRow* cheapest(const std::vector<StudyRow>& rows, double accuracy)
{
  const StudyRow* best = nullptr;
  for (const StudyRow& row : rows)
    if (meets(row, accuracy) && (!best || row.run.solver_time < best->run.solver_time))
      best = &row;
  return best;
}

void measure_errors(std::vector<StudyRow>& rows, const Rung& reference)
{
  const auto is_reference = [&](const StudyRow& row) {
    return row.curve && row.rung.folder() == reference.folder();
  };
  const auto found = std::ranges::find_if(rows, is_reference);
  for (StudyRow& row : rows) {
    row.is_reference = is_reference(row);
    if (row.curve && found != rows.end())
      row.errors = compare(*row.curve, *found->curve);
  }
}

std::string study_table(const std::vector<StudyRow>& rows)
{
  std::vector<std::vector<std::string>> table{{"solver", "setting", "solved in", "with start",
                                               "error", "at end", "broken", "rupture", "steps",
                                               "solves"}};
  std::string others;
  std::set<std::string> refused;
  for (const StudyRow& row : rows) {
    if (row.run.state != RunState::finished) {
      const bool whole_solver = row.run.state == RunState::refused;
      if (!whole_solver || refused.insert(row.rung.solver).second)
        others += fmt::format("  {}: {}{}{}\n", whole_solver ? row.rung.solver : row.rung.text(),
                              name_of(row.run.state), row.run.message.empty() ? "" : ": ",
                              row.run.message);
      continue;
    }
    std::string setting =
        row.rung.knob.empty() ? "-" : fmt::format("{} {}", row.rung.knob, shortest(row.rung.value));
    if (row.is_reference)
      setting += " (reference)";
    table.push_back({row.rung.solver, setting, seconds_text(row.run.solver_time),
                     seconds_text(row.run.whole_time), percent(row.errors.largest),
                     percent(row.errors.at_end), percent(row.errors.broken),
                     rupture_text(row.errors), count(row, "steps"), count(row, "solves")});
  }
  return aligned(table) + others;
}

std::string cheapest_text(const std::vector<StudyRow>& rows)
{
  std::string text;
  for (const double accuracy : accuracies) {
    text += fmt::format("  within {:g} %: ", 100 * accuracy);
    const StudyRow* best = cheapest(rows, accuracy);
    if (best)
      text += fmt::format("{}, {} ({})\n", best->rung.text(), seconds_text(best->run.solver_time),
                          best->is_reference ? "the reference"
                                             : "error " + percent(best->errors.largest));
    else
      text += "none of these settings\n";
  }
  return text;
}

std::string study_csv(const std::vector<StudyRow>& rows, const StudyReference& reference,
                      const StudyProvenance& provenance)
{
  std::string text =
      "solver,knob,value,settings,state,is_reference,solver_wall_time_s,whole_wall_time_s,"
      "repetitions,quantity,compared_up_to_s,largest_error_percent,error_at_end_percent,"
      "broken_bonds,error_of_broken_bonds_percent,rupture_time_s,error_of_rupture_time_percent,"
      "which_rupture,unknowns,bonds,steps,solves,factorisations,cheapest_for,threads,machine,"
      "program,revision,scene,reference,left_out_by_reference_percent,message\n";
  for (const StudyRow& row : rows) {
    std::vector<std::string> cells = run_cells(row);
    for (std::string& cell : error_cells(row))
      cells.push_back(std::move(cell));
    for (const char* what : {"unknowns", "bonds", "steps", "solves", "factorisations"})
      cells.push_back(number(count_of(row, what)));
    for (const std::string& cell :
         {accuracies_won(rows, row), std::to_string(provenance.n_threads), provenance.machine,
          std::string("mastic " MASTIC_VERSION), std::string(MASTIC_REVISION), provenance.scene,
          reference.rung.text(), number(reference.left_out, 100), row.run.message})
      cells.push_back(cell);
    std::string line;
    for (const std::string& cell : cells)
      line += (line.empty() ? "" : ",") + quoted(cell);
    text += line + "\n";
  }
  return text;
}

} // namespace apps
