#pragma once
#include "apps/quantity.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A table of text cells with named columns; each column name may carry a unit: "x_mm", "mx_N_m"
/// or "x [mm]".
class CsvTable {
public:
  /// \throws std::invalid_argument naming file and line if it cannot be read or rows differ in
  /// length
  CsvTable(const std::filesystem::path& file, const Units& units);

  std::size_t n_rows() const { return rows_.size(); }

  /// Position of a column by its name without unit, or nothing.
  std::optional<std::size_t> find(const std::string& name) const;

  /// Refuses columns that are not in the list, with the nearest that is.
  void allow_only(const std::vector<std::string>& names) const;

  /// Numbers of a column in an SI unit ("1": the column must not carry a unit).
  /// \throws std::invalid_argument naming file, line and column
  std::vector<double> numbers(const std::string& name, const std::string& si_unit) const;

  /// The same, or `missing` in each row if there is no such column.
  std::vector<double> numbers_or(const std::string& name, const std::string& si_unit,
                                 double missing) const;

  /// Whole numbers of a column.
  std::vector<long> integers(const std::string& name) const;

  const std::string& cell(std::size_t row, std::size_t column) const { return rows_[row][column]; }

  /// "file:line" of a row.
  std::string place(std::size_t row) const;

private:
  struct Column {
    std::string name, unit;
  };

  void read_header(const std::vector<std::string>& cells);
  static Column column_of(const std::string& cell, const Units& units);
  const Column& column(const std::string& name, const std::string& si_unit) const;

  std::filesystem::path file_;
  const Units& units_;
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<int> lines_;
};

} // namespace apps
