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
      for (const std::string& cell : cells) {
        Column column{cell, ""};
        std::size_t cut = cell.find('[');
        if (cut != std::string::npos)
          column = {trimmed(cell.substr(0, cut)), trimmed(cell.substr(cut + 1, cell.find(']') - cut - 1))};
        else {
          cut = cell.find('_');
          for (const std::string name : compound_names)
            if (cell.starts_with(name))
              cut = cell.size() > name.size() ? name.size() : std::string::npos;
          if (cut != std::string::npos) {
            column = {cell.substr(0, cut), cell.substr(cut + 1)};
            std::ranges::replace(column.unit, '_', ' ');
          }
        }
        columns_.push_back(column);
      }
      continue;
    }
    if (cells.size() != columns_.size())
      throw std::runtime_error(fmt::format("{}:{}: the row has {} cells, the header {} columns",
                                           file.string(), number, cells.size(), columns_.size()));
    rows_.push_back(cells);
    lines_.push_back(number);
  }
  if (columns_.empty())
    throw std::runtime_error(fmt::format("{}: the file is empty; the first line names the columns",
                                         file.string()));
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
  for (const Column& column : columns_) {
    if (std::ranges::find(names, column.name) != names.end())
      continue;
    const std::string close = nearest(column.name, names);
    throw std::runtime_error(fmt::format("{}: unknown column '{}'{}", file_.string(), column.name,
                                         close.empty() ? ""
                                                       : fmt::format("; did you mean '{}'?", close)));
  }
}

std::string CsvTable::place(std::size_t row) const
{
  return fmt::format("{}:{}", file_.string(), lines_[row]);
}

std::vector<double> CsvTable::numbers(const std::string& name, const std::string& si_unit) const
{
  const auto column = find(name);
  if (!column)
    throw std::runtime_error(
        fmt::format("{}: there is no column '{}'{}", file_.string(), name,
                    si_unit == "1" ? "" : fmt::format(" (with its unit, such as {}_{})", name, si_unit)));
  const std::string& unit = columns_[*column].unit;
  if (si_unit != "1" && unit.empty())
    throw std::runtime_error(fmt::format("{}: column '{}' needs a unit in its name, such as {}_{}",
                                         file_.string(), name, name, si_unit));
  std::vector<double> result;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    try {
      if (!is_bare_number(rows_[row][*column]))
        throw std::invalid_argument(fmt::format("'{}' is not a number", rows_[row][*column]));
      result.push_back(units_.parse(rows_[row][*column], si_unit, unit.empty() ? "1" : unit));
    } catch (const std::invalid_argument& problem) {
      throw std::runtime_error(
          fmt::format("{}: column '{}': {}", place(row), name, problem.what()));
    }
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
      throw std::runtime_error(
          fmt::format("{}: column '{}': '{}' is not a whole number", place(row), name,
                      rows_[row][*find(name)]));
    result.push_back(long(values[row]));
  }
  return result;
}

} // namespace apps
