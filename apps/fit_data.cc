#include "apps/fit_data.h"

#include "apps/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <tuple>

namespace apps {

namespace {

struct Kind {
  fem::Quantity quantity;
  const char *name, *unit, *abscissa, *abscissa_unit;
};

constexpr Kind kinds[] = {
    {fem::Quantity::creep_compliance, "creep compliance", "1/Pa", "time", "s"},
    {fem::Quantity::relaxation_modulus, "relaxation modulus", "Pa", "time", "s"},
    {fem::Quantity::dynamic_modulus, "dynamic modulus", "Pa", "frequency", "Hz"}};

constexpr const char *strain_column = "axial strain", *stress_column = "axial stress";

const Kind& kind_of(const CsvTable& table, const std::filesystem::path& file)
{
  const Kind* found = nullptr;
  for (const Kind& each : kinds)
    if (table.find(each.name)) {
      if (found)
        throw std::invalid_argument(fmt::format("{}: there are two measured columns, '{}' and '{}'",
                                                file.string(), found->name, each.name));
      found = &each;
    }
  if (table.find(strain_column) && !found)
    found = &kinds[0];
  else if (table.find(strain_column))
    throw std::invalid_argument(fmt::format("{}: there are two measured columns, '{}' and '{}'",
                                            file.string(), strain_column, found->name));
  if (!found)
    throw std::invalid_argument(fmt::format(
        "{}: there is no measured column: creep compliance [1/GPa], axial strain [%] with "
        "axial stress [kPa], relaxation modulus [MPa] or dynamic modulus [MPa]",
        file.string()));
  return *found;
}

/// Numbers of a column that must be > 0.
std::vector<double> positive(const CsvTable& table, const std::string& name,
                             const std::string& unit)
{
  const std::vector<double> values = table.numbers(name, unit);
  for (std::size_t row = 0; row < values.size(); ++row)
    if (!(values[row] > 0 && std::isfinite(values[row])))
      throw std::invalid_argument(fmt::format("{}: column '{}': {} is not above 0",
                                              table.place(row), name,
                                              table.cell(row, *table.find(name))));
  return values;
}

/// Measured values; those of a creep test in strains are divided by the stress.
std::vector<double> measured_values(const CsvTable& table, const Kind& kind,
                                    const std::vector<double>& stresses,
                                    const std::filesystem::path& file)
{
  if (!table.find(strain_column))
    return positive(table, kind.name, kind.unit);
  if (stresses.empty())
    throw std::invalid_argument(fmt::format("{}: a column '{}' needs one '{}'", file.string(),
                                            strain_column, stress_column));
  std::vector<double> values = positive(table, strain_column, "percent");
  for (std::size_t row = 0; row < values.size(); ++row)
    values[row] *= 0.01 / stresses[row];
  return values;
}

/// Times of one specimen at one temperature and stress must rise.
void require_rising(const CsvTable& table, const FitData& data)
{
  std::map<std::tuple<std::string, double, double>, double> last;
  const auto& points = data.measurements.points;
  for (std::size_t row = 0; row < points.size(); ++row) {
    const std::string specimen = data.specimens.empty() ? "" : data.specimens[row];
    const auto [before, first] = last.try_emplace(
        {specimen, points[row].temperature, data.stresses.empty() ? 0 : data.stresses[row]},
        points[row].at);
    if (!first && points[row].at <= before->second)
      throw std::invalid_argument(fmt::format(
          "{}: column 'time': {} does not rise above the time before it (tests at other "
          "temperatures or on other specimens need a column 'temperature' or "
          "'specimen')",
          table.place(row), table.cell(row, *table.find("time"))));
    before->second = points[row].at;
  }
}

} // namespace

FitData read_fit_data(const std::filesystem::path& file)
{
  const Units units;
  const CsvTable table(file, units);
  table.allow_only({"time", "frequency", "creep compliance", strain_column, stress_column,
                    "relaxation modulus", "dynamic modulus", "phase angle", "temperature",
                    "specimen", "weight"});
  const Kind& kind = kind_of(table, file);
  const bool frequency = kind.quantity == fem::Quantity::dynamic_modulus;
  if (const char* other = frequency ? "time" : "frequency"; table.find(other))
    throw std::invalid_argument(fmt::format("{}: a {} is measured over {}, not over {}",
                                            file.string(), kind.name, kind.abscissa, other));
  if (!frequency && table.find("phase angle"))
    throw std::invalid_argument(
        fmt::format("{}: a {} has no phase angle", file.string(), kind.name));
  FitData data{{kind.quantity, {}}, {}, table.find("temperature").has_value(), {}};
  if (table.find(stress_column)) {
    if (kind.quantity != fem::Quantity::creep_compliance)
      throw std::invalid_argument(
          fmt::format("{}: a {} has no '{}'", file.string(), kind.name, stress_column));
    data.stresses = positive(table, stress_column, "Pa");
  }
  const auto at = positive(table, kind.abscissa, kind.abscissa_unit);
  const auto values = measured_values(table, kind, data.stresses, file);
  const auto temperatures = table.numbers_or("temperature", "K", 293.15);
  const auto weights = table.find("weight") ? positive(table, "weight", "1")
                                            : std::vector<double>(table.n_rows(), 1.0);
  const auto phases = table.numbers_or("phase angle", "rad", 0);
  for (std::size_t row = 0; row < table.n_rows(); ++row) {
    if (!(temperatures[row] > 0))
      throw std::invalid_argument(
          fmt::format("{}: column 'temperature': {:g} K is not above absolute zero",
                      table.place(row), temperatures[row]));
    if (!(phases[row] >= 0 && phases[row] <= std::numbers::pi / 2))
      throw std::invalid_argument(
          fmt::format("{}: column 'phase angle': {} is not between 0 and 90 degrees",
                      table.place(row), table.cell(row, *table.find("phase angle"))));
    data.measurements.points.push_back({at[row], values[row], {}, temperatures[row], weights[row]});
    if (table.find("phase angle"))
      data.measurements.points.back().phase = phases[row];
    if (const auto column = table.find("specimen"))
      data.specimens.push_back(table.cell(row, *column));
  }
  if (table.n_rows() < 3)
    throw std::invalid_argument(fmt::format("{}: a fit needs three rows or more, there are {}",
                                            file.string(), table.n_rows()));
  if (!frequency)
    require_rising(table, data);
  return data;
}

} // namespace apps
