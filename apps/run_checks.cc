#include "apps/run_checks.h"

#include "apps/files.h"
#include "apps/text.h"

#include <deal.II/base/function_parser.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t most_lines = 12;

ExpectedEnd end_of(dem::RunEnd end)
{
  switch (end) {
  case dem::RunEnd::strain_limit:
    return ExpectedEnd::strain_limit;
  case dem::RunEnd::lost_equilibrium:
    return ExpectedEnd::lost_equilibrium;
  default:
    return ExpectedEnd::finished;
  }
}

/// The item whose time is nearest.
template <typename Items>
std::size_t nearest_in_time(const Items& items, double time)
{
  const auto distance = [&](const auto& item) { return std::abs(item.time - time); };
  return std::size_t(std::ranges::min_element(items, {}, distance) - items.begin());
}

/// The number that is expected of a history, or not-a-number if the run did not come so far.
double history_value(const std::vector<Column>& history, const ExpectedValue& v)
{
  const std::vector<double>& times = column_of(history, "time_s").values;
  if (v.time > times.back() * (1 + 1e-9))
    return std::nan("");
  const auto distance = [&](double time) { return std::abs(time - v.time); };
  const auto nearest_time = std::ranges::min_element(times, {}, distance);
  return column_of(history, v.column).values[std::size_t(nearest_time - times.begin())];
}

/// The tables of a run, made once.
class Tables {
public:
  explicit Tables(const RunInProgress& run)
      : run_(run), history_(history_columns(face_of(run.specimen.assembly), run.record.history)),
        breakages_(breakage_columns(run.specimen.assembly, run.run->breakages()))
  {
  }

  const std::vector<Column>& history() const { return history_; }

  /// The number that is expected, or not-a-number if the run did not come so far.
  double find(const ExpectedValue& v)
  {
    using Table = ExpectedValue::Table;
    if (v.table == Table::history)
      return history_value(history_, v);
    if (v.table != Table::breakages && v.time > run_.record.history.back().time * (1 + 1e-9))
      return std::nan("");
    const std::vector<double>& values =
        column_of(v.table == Table::breakages ? breakages_ : fields(v), v.column).values;
    return v.row < values.size() ? values[v.row] : std::nan("");
  }

private:
  const std::vector<Column>& fields(const ExpectedValue& v)
  {
    const std::size_t k = nearest_in_time(run_.record.snapshots, v.time);
    const bool particles = v.table == ExpectedValue::Table::particles;
    auto& made = fields_[{k, particles}];
    if (made.empty())
      made = particles
                 ? particle_columns(run_.specimen.assembly.particles, run_.record.snapshots[k])
                 : bond_columns(run_.specimen.assembly.bonds.ends, run_.record.snapshots[k]);
    return made;
  }

  const RunInProgress& run_;
  std::vector<Column> history_, breakages_;
  std::map<std::pair<std::size_t, bool>, std::vector<Column>> fields_;
};

Check number_check(const std::string& what, double expected, double found, double base,
                   double tolerance)
{
  const double difference = std::abs(found - expected);
  return {what, shortest(expected), std::isnan(found) ? "nothing" : shortest(found),
          std::isnan(difference) ? infinity
          : base > 0             ? difference / base
                                 : difference,
          tolerance};
}

double base_of(double expected, double largest, ErrorBase base)
{
  return base == ErrorBase::value && expected != 0 ? std::abs(expected) : largest;
}

void check_values(const Expectations& expect,
                  const std::function<double(const ExpectedValue&)>& find,
                  std::vector<Check>& checks)
{
  std::map<std::string, double> largest; // by column
  for (const ExpectedValue& v : expect.values)
    largest[v.column] = std::max(largest[v.column], std::abs(v.value));
  for (const ExpectedValue& v : expect.values)
    checks.push_back(number_check(v.name, v.value, find(v),
                                  base_of(v.value, largest[v.column], expect.base),
                                  expect.tolerance));
}

/// A formula of t at many times.
std::vector<double> evaluated(const std::string& formula, const std::vector<double>& times)
{
  std::vector<double> values;
  try {
    dealii::FunctionParser<1> function;
    function.initialize("t", formula, {{"pi", std::acos(-1.0)}});
    for (const double time : times)
      values.push_back(function.value(dealii::Point<1>(time)));
  } catch (const dealii::ExceptionBase&) {
    throw std::invalid_argument(fmt::format("Expect/Curves: '{}' is not a formula of t", formula));
  }
  return values;
}

/// One check per curve: that of its worst time.
void check_curve(const ExpectedCurve& curve, const Expectations& expect,
                 const std::vector<Column>& history, std::vector<Check>& checks)
{
  const std::vector<double>& times = column_of(history, "time_s").values;
  const std::vector<double>& found = column_of(history, curve.column).values;
  const std::vector<double> expected = evaluated(curve.formula, times);
  double largest = 0;
  for (const double value : expected)
    largest = std::max(largest, std::abs(value));
  Check worst{curve.column + " on its curve", "", "no rows", infinity, expect.tolerance};
  double most = -1;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Check check = number_check(
        fmt::format("{} on its curve at {:.6g} s", curve.column, times[k]), expected[k], found[k],
        base_of(expected[k], largest, expect.base), expect.tolerance);
    if (times[k] >= expect.from && check.error > most) {
      most = check.error;
      worst = check;
    }
  }
  checks.push_back(worst);
}

void check_breakages(const Expectations& expect, const std::vector<dem::Breakage>& breakages,
                     std::vector<Check>& checks)
{
  const std::size_t n = breakages.size();
  const auto count = [&](const std::string& what, std::size_t expected) {
    checks.push_back(exact_check(what, std::to_string(expected), std::to_string(n)));
  };
  if (expect.n_broken)
    count("broken bonds", std::size_t(*expect.n_broken));
  if (!expect.break_times.empty())
    count("number of break times", expect.break_times.size());
  if (!expect.break_order.empty())
    count("number of broken bonds in order", expect.break_order.size());
  const double last = expect.break_times.empty() ? 0 : expect.break_times.back();
  for (std::size_t k = 0; k < std::min(n, expect.break_times.size()); ++k)
    checks.push_back(number_check(
        fmt::format("time of breakage {}", k), expect.break_times[k], breakages[k].time,
        base_of(expect.break_times[k], last, expect.base), expect.tolerance));
  for (std::size_t k = 0; k < std::min(n, expect.break_order.size()); ++k)
    checks.push_back(exact_check(fmt::format("bond of breakage {}", k),
                                 shortest(expect.break_order[k]),
                                 std::to_string(breakages[k].bond)));
}

void check_messages(const Expectations& expect, const std::string& said, std::vector<Check>& checks)
{
  for (const std::string& message : split(expect.messages, ';')) {
    const bool found = said.find(message) != std::string::npos;
    checks.push_back(exact_check("message", message, found ? message : "other messages"));
  }
}

/// A text as a cell: tables are split at commas.
std::string cell(std::string text)
{
  std::ranges::replace(text, ',', ';');
  std::ranges::replace(text, '\n', ' ');
  return text;
}

std::string line_of(const Check& check)
{
  if (check.expected == check.found)
    return fmt::format("{}: {}", check.what, check.expected);
  return fmt::format("{}: expected {}, found {}, error {:.2g} of {:.2g} allowed", check.what,
                     check.expected, check.found, check.error, check.tolerance);
}

} // namespace

Check exact_check(const std::string& what, const std::string& expected, const std::string& found)
{
  return {what, expected, found, expected == found ? 0.0 : infinity, 0};
}

const Column& column_of(const std::vector<Column>& columns, const std::string& name)
{
  std::vector<std::string> names;
  for (const Column& column : columns) {
    if (column.name == name)
      return column;
    names.push_back(column.name);
  }
  const std::string close = nearest(name, names);
  throw std::invalid_argument(fmt::format("Expect: the table has no column '{}'{}", name,
                                          close.empty() ? "" : "; did you mean '" + close + "'?"));
}

std::vector<Check> check_run(const RunInProgress& run)
{
  const Expectations& expect = run.scene.scene->expect;
  std::vector<Check> checks;
  if (expect.end != ExpectedEnd::any)
    checks.push_back(exact_check("end", name_of(expect.end), name_of(end_of(run.run->end()))));
  Tables tables(run);
  check_values(
      expect, [&](const ExpectedValue& v) { return tables.find(v); }, checks);
  for (const ExpectedCurve& curve : expect.curves)
    check_curve(curve, expect, tables.history(), checks);
  check_breakages(expect, run.run->breakages(), checks);
  std::string said;
  for (const Diagnostic& each : run.scene.diagnostics)
    said += each.message + '\n';
  for (const std::string& line : run.log)
    said += line + '\n';
  check_messages(expect, said, checks);
  return checks;
}

std::vector<Check> check_history(const Expectations& expect, const std::vector<Column>& history)
{
  std::vector<Check> checks;
  if (expect.end != ExpectedEnd::any)
    checks.push_back(exact_check("end", name_of(expect.end), name_of(ExpectedEnd::finished)));
  check_values(
      expect,
      [&](const ExpectedValue& v) {
        if (v.table != ExpectedValue::Table::history)
          throw std::invalid_argument(
              fmt::format("Expect: '{}': a continuum has a history only", v.name));
        return history_value(history, v);
      },
      checks);
  for (const ExpectedCurve& curve : expect.curves)
    check_curve(curve, expect, history, checks);
  return checks;
}

std::vector<Check> check_failure(const Expectations& expect, ExpectedEnd end,
                                 const std::string& message)
{
  std::vector<Check> checks{exact_check("end", name_of(expect.end), name_of(end))};
  check_messages(expect, message, checks);
  return checks;
}

bool report_checks(const std::vector<Check>& checks, const std::filesystem::path& folder)
{
  std::string table = "what,expected,found,error,tolerance,met\n";
  std::size_t n_met = 0, n_told = 0;
  for (const Check& check : checks) {
    n_met += check.met();
    table += fmt::format("{},{},{},{:.3g},{:g},{}\n", cell(check.what), cell(check.expected),
                         cell(check.found), check.error, check.tolerance, int(check.met()));
  }
  const bool few = checks.size() <= most_lines;
  for (const Check& check : checks)
    if ((few || !check.met()) && n_told < most_lines) {
      fmt::print("  {}: {}\n", check.met() ? "met" : "NOT MET", line_of(check));
      ++n_told;
    }
  fmt::print("  expectations: {} of {} met\n", n_met, checks.size());
  write_text_file(folder / "checks.csv", table);
  return n_met == checks.size();
}

std::vector<Check> read_checks(const std::filesystem::path& folder)
{
  std::vector<Check> checks;
  std::ifstream file(folder / "checks.csv");
  std::string line;
  std::getline(file, line); // the names
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = split(line, ',');
    if (cells.size() == 6)
      checks.push_back(
          {cells[0], cells[1], cells[2], std::atof(cells[3].c_str()), std::atof(cells[4].c_str())});
  }
  return checks;
}

} // namespace apps
