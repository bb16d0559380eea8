#include "apps/csv_table.h"

#include "apps/scene_text.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace apps {

namespace {

/// Words that are whole column names although they contain an underscore.
constexpr const char* compound_names[] = {"normal_strength", "shear_strength"};

} // namespace

CsvTable::CsvTable(const std::filesystem::path& file, const Units& units)
    : file_(file), units_(units)
{
  std::istringstream stream(read_text_file(file));
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty())
      continue;
    const std::vector<std::string> cells = split(line, ',');
    if (columns_.empty()) {
      read_header(cells);
      continue;
    }
    if (cells.size() != columns_.size())
      throw std::invalid_argument(fmt::format("{}:{}: the row has {} cells, the header {} columns",
                                              file.string(), number, cells.size(),
                                              columns_.size()));
    rows_.push_back(cells);
    lines_.push_back(number);
  }
  if (columns_.empty())
    throw std::invalid_argument(fmt::format("{}: the file is empty; the first line names the "
                                            "columns",
                                            file.string()));
}

void CsvTable::read_header(const std::vector<std::string>& cells)
{
  for (const std::string& cell : cells) {
    if (cell.find(';') != std::string::npos)
      throw std::invalid_argument(
          fmt::format("{}: '{}': columns are separated by commas", file_.string(), cell));
    const Column column = column_of(cell, units_);
    if (find(column.name))
      throw std::invalid_argument(
          fmt::format("{}: there are two columns '{}'", file_.string(), column.name));
    columns_.push_back(column);
  }
}

/// "x_mm" and "x [mm]" are the column x in mm. What follows an underscore is a unit if it can be
/// read as one: "axial_stress_kPa" is an axial_stress.
CsvTable::Column CsvTable::column_of(const std::string& cell, const Units& units)
{
  std::size_t cut = cell.find('[');
  if (cut != std::string::npos)
    return {trimmed(cell.substr(0, cut)), trimmed(cell.substr(cut + 1, cell.find(']') - cut - 1))};
  const auto unit_after = [&](std::size_t underscore) {
    std::string unit = cell.substr(underscore + 1);
    std::ranges::replace(unit, '_', ' ');
    return unit;
  };
  for (cut = cell.find('_'); cut != std::string::npos; cut = cell.find('_', cut + 1))
    if (units.knows(unit_after(cut)))
      return {cell.substr(0, cut), unit_after(cut)};
  cut = cell.find('_'); // the unit of an unknown column is told when it is asked for
  for (const std::string name : compound_names)
    if (cell.starts_with(name))
      cut = cell.size() > name.size() ? name.size() : std::string::npos;
  if (cut == std::string::npos)
    return {cell, ""};
  return {cell.substr(0, cut), unit_after(cut)};
}

std::optional<std::size_t> CsvTable::find(const std::string& name) const
{
  for (std::size_t k = 0; k < columns_.size(); ++k)
    if (columns_[k].name == name)
      return k;
  return std::nullopt;
}

void CsvTable::allow_only(const std::vector<std::string>& names) const
{
  std::string all;
  for (const std::string& name : names)
    all += (all.empty() ? "" : ", ") + name;
  for (const Column& column : columns_) {
    if (std::ranges::find(names, column.name) != names.end())
      continue;
    const std::string close = nearest(column.name, names);
    throw std::invalid_argument(
        fmt::format("{}: unknown column '{}'{}; columns are: {}", file_.string(), column.name,
                    close.empty() ? "" : fmt::format("; did you mean '{}'?", close), all));
  }
}

std::string CsvTable::place(std::size_t row) const
{
  return fmt::format("{}:{}", file_.string(), lines_[row]);
}

const CsvTable::Column& CsvTable::column(const std::string& name, const std::string& si_unit) const
{
  std::string example = name + "_" + si_unit;
  std::ranges::replace(example, ' ', '_');
  const auto found = find(name);
  if (!found)
    throw std::invalid_argument(
        fmt::format("{}: there is no column '{}'{}", file_.string(), name,
                    si_unit == "1" ? "" : fmt::format(" (with its unit, such as {})", example)));
  const Column& column = columns_[*found];
  if (si_unit != "1" && column.unit.empty())
    throw std::invalid_argument(fmt::format("{}: column '{}' needs a unit in its name, such as {}",
                                            file_.string(), name, example));
  try {
    units_.convert(0, column.unit.empty() ? "1" : column.unit, si_unit);
  } catch (const std::invalid_argument& problem) {
    throw std::invalid_argument(
        fmt::format("{}: column '{}': {}", file_.string(), name, problem.what()));
  }
  return column;
}

std::vector<double> CsvTable::numbers(const std::string& name, const std::string& si_unit) const
{
  const Column& column = this->column(name, si_unit);
  const std::size_t position = *find(name);
  std::vector<double> result;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const std::string& cell = rows_[row][position];
    if (!is_bare_number(cell))
      throw std::invalid_argument(
          fmt::format("{}: column '{}': '{}' is not a number", place(row), name, cell));
    result.push_back(units_.parse(cell, si_unit, column.unit.empty() ? "1" : column.unit));
  }
  return result;
}

std::vector<double> CsvTable::numbers_or(const std::string& name, const std::string& si_unit,
                                         double missing) const
{
  return find(name) ? numbers(name, si_unit) : std::vector<double>(rows_.size(), missing);
}

std::vector<long> CsvTable::integers(const std::string& name) const
{
  std::vector<long> result;
  const std::vector<double> values = numbers(name, "1");
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (values[row] != std::floor(values[row]) || std::abs(values[row]) > 1e9)
      throw std::invalid_argument(fmt::format("{}: column '{}': '{}' is not a whole number",
                                              place(row), name, rows_[row][*find(name)]));
    result.push_back(long(values[row]));
  }
  return result;
}

} // namespace apps
