#pragma once
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// Reading the tables in tests/reference.
namespace reference {

inline std::ifstream open(const std::string& name)
{
  std::ifstream file(std::string(MASTIC_REFERENCE_DIR) + "/" + name);
  if (!file)
    throw std::runtime_error("no reference file " + name);
  return file;
}

/// A row of a table: values by column name, as text.
using Row = std::map<std::string, std::string>;

/// Cells of a CSV line; quotes protect commas.
inline std::vector<std::string> cells(const std::string& line)
{
  std::vector<std::string> result(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      result.emplace_back();
    else if (c != '\r')
      result.back() += c;
  }
  return result;
}

inline std::vector<Row> table(const std::string& name)
{
  std::ifstream file = open(name);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> columns = cells(line);
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> values = cells(line);
    Row row;
    for (std::size_t k = 0; k < columns.size(); ++k)
      row[columns[k]] = values.at(k);
    rows.push_back(row);
  }
  if (rows.empty())
    throw std::runtime_error("empty reference table " + name);
  return rows;
}

/// Text as a number; tiny values become 0.
inline double number(const std::string& text)
{
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0')
    throw std::runtime_error("not a number: " + text);
  return value;
}

inline double number(const Row& row, const std::string& column)
{
  return number(row.at(column));
}

inline nlohmann::json json(const std::string& name)
{
  std::ifstream file = open(name);
  return nlohmann::json::parse(file);
}

/// A number that is stored as text to keep its digits, or as a number.
inline double number(const nlohmann::json& value)
{
  return value.is_string() ? number(value.get<std::string>()) : value.get<double>();
}

} // namespace reference
