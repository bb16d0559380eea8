#include "apps/expectations.h"

#include "apps/schema.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <stdexcept>

namespace apps {

namespace {

const std::vector<std::pair<std::string, ExpectedEnd>> ends{
    {"any", ExpectedEnd::any},
    {"finished", ExpectedEnd::finished},
    {"strain limit", ExpectedEnd::strain_limit},
    {"lost equilibrium", ExpectedEnd::lost_equilibrium},
    {"refused", ExpectedEnd::refused},
    {"failed", ExpectedEnd::failed}};

/// "particle 7 ux_mm at 30 s: 1.1e-4"
ExpectedValue expected_value(const std::string& text, const Units& units)
{
  const auto wrong = [&](const std::string& reason) {
    return std::invalid_argument(fmt::format(
        "'{}': {}; values look like 'axial_strain_percent at 30 s: 1.2', 'particle 7 ux_mm at 30 "
        "s: 0.1', 'bond 3 force_x_N at 0 s: 2' or 'breakage 0 bond: 5'",
        text, reason));
  };
  const std::vector<std::string> sides = split(text, ':');
  if (sides.size() != 2)
    throw wrong("one ':' is needed");
  ExpectedValue result{sides[0], ExpectedValue::Table::history, 0, "", 0, 0};
  result.value = units.parse(sides[1], "1", "1");
  std::string rest = sides[0];
  const auto of_row = [&](const std::string& word, ExpectedValue::Table table) {
    if (!rest.starts_with(word + " "))
      return;
    rest = trimmed(rest.substr(word.size()));
    result.row = std::size_t(units.parse(rest.substr(0, rest.find(' ')), "1", "1"));
    rest = trimmed(rest.substr(std::min(rest.size(), rest.find(' '))));
    result.table = table;
  };
  of_row("particle", ExpectedValue::Table::particles);
  of_row("bond", ExpectedValue::Table::bonds);
  of_row("breakage", ExpectedValue::Table::breakages);
  const std::size_t at = rest.find(" at ");
  result.column = trimmed(rest.substr(0, at));
  if ((at == std::string::npos) != (result.table == ExpectedValue::Table::breakages))
    throw wrong(at == std::string::npos ? "the time is missing" : "a breakage has its own time");
  if (at != std::string::npos)
    result.time = units.parse(rest.substr(at + 4), "s", "s");
  return result;
}

/// "axial_strain_percent = 100 * t"
ExpectedCurve expected_curve(const std::string& text)
{
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    throw std::invalid_argument(
        fmt::format("'{}': a curve looks like 'axial_strain_percent = 0.1 + t / 20'", text));
  return {trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1))};
}

} // namespace

bool RepeatedRun::wanted() const
{
  return !scene.empty() || !settings.empty() || n_threads > 0 || n_interruptions > 0;
}

void declare(Schema& s, Expectations& v)
{
  s.section("Expect", "What this run must give. 'mastic run' says what is met, and ends with exit "
                      "code 1 if something is not.");
  s.words(
      "Values", v.values_text, "",
      "Numbers of the result tables, in the units of their columns: 'axial_strain_percent at 30 "
      "s: 1.2, particle 7 ux_mm at 30 s: 0.1, bond 3 force_x_N at 0 s: 2, breakage 0 bond: 5'.");
  s.words("Curves", v.curves_text, "",
          "Closed forms for columns of the history, t in seconds, separated by ';': "
          "'mean_displacement_mm = 0.1 + t / 20'.");
  s.quantity("Curves from", v.from, "s", "0 s", at_least(0), "Earlier rows do not count.");
  s.number("Tolerance", v.tolerance, "1e-6", at_least(0), "Largest relative error.");
  s.choice<ErrorBase>("Relative to", v.base,
                      {{"each value", ErrorBase::value}, {"largest value", ErrorBase::largest}},
                      "each value",
                      "What an error is divided by: the value expected (if that is 0, and always "
                      "for 'largest value': the largest one expected of its column).");
  s.optional_quantity("Broken bonds", v.n_broken, "any", "1", "any", at_least(0),
                      "How many bonds break.");
  s.quantities("Break times", v.break_times, "s", "none", at_least(0),
               "Of all breakages in order.");
  s.quantities("Break order", v.break_order, "1", "none", at_least(0),
               "Numbers of the bonds that break, in order.");
  s.choice<ExpectedEnd>("End", v.end, ends, "any",
                        "How the run ends; refused: the input is wrong (exit code 2); failed: exit "
                        "code 3.");
  s.words("Messages", v.messages, "",
          "Texts that the program must say, separated by ';' (errors, warnings, notes).");
}

void declare(Schema& s, RepeatedRun& v)
{
  s.section("Repeat", "The run is made again another way, and must give the same.");
  s.words("Scene", v.scene, "", "Another scene file, beside this one; empty: this scene.");
  s.words("Settings", v.settings, "",
          "What is set otherwise, separated by ';': 'Solver = events; Output/History times = 7'.");
  s.integer("Threads", v.n_threads, "0", between(0, 1024), "Number of threads; 0: as the run.");
  s.integer("Interruptions", v.n_interruptions, "0", between(0, 100),
            "So many times the second run is stopped, and resumed from its checkpoint.");
  s.choice<Comparison>("Compare", v.compare,
                       {{"everything", Comparison::everything},
                        {"history", Comparison::history},
                        {"breakages", Comparison::breakages}},
                       "everything",
                       "everything: history, breakages, particles and bonds at the end. history: "
                       "history and times of breakages (for other numbers of particles and bonds). "
                       "breakages: which bonds break, and when.");
  s.words("Factors", v.factors, "",
          "What this run's columns are of the other's: 'axial_stress_kPa: 2, time_s: 0.5'.");
  s.number("Tolerance", v.tolerance, "0", at_least(0),
           "Largest difference over the largest value of a column; 0: bit for bit.");
}

void read_expectations(Expectations& v, const Units& units)
{
  for (const std::string& each : split(v.values_text, ','))
    v.values.push_back(expected_value(each, units));
  for (const std::string& each : split(v.curves_text, ';'))
    v.curves.push_back(expected_curve(each));
}

bool expects_anything(const Expectations& v)
{
  return !v.values.empty() || !v.curves.empty() || v.n_broken || !v.break_times.empty() ||
         !v.break_order.empty() || v.end != ExpectedEnd::any || !v.messages.empty();
}

std::string name_of(ExpectedEnd end)
{
  for (const auto& [name, value] : ends)
    if (value == end)
      return name;
  return {};
}

} // namespace apps
