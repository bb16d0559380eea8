#pragma once
#include "apps/csv_table.h"
#include "apps/text.h"
#include "tests/apps/interrupted.h"

#include <algorithm>
#include <string>
#include <vector>

/// Runs of bodies of finite elements, and what they leave.
namespace body_runs {

inline apps::Finished on_two_ranks(const command::Folder& folder,
                                   const std::vector<std::string>& arguments)
{
  return command::mastic_in_shell(
      folder,
      "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1 "
      "exec mpirun --oversubscribe -np 2 \"$@\"",
      arguments);
}

/// A column of a table that a run has left, in a unit.
inline std::vector<double> column(const command::Folder& folder, const std::string& file,
                                  const std::string& name, const std::string& unit)
{
  const apps::Units units;
  return apps::CsvTable(folder / file, units).numbers(name, unit);
}

/// A column of such a table by its whole name.
inline std::vector<double> numbers(const command::Folder& folder, const std::string& file,
                                   const std::string& name)
{
  const std::vector<std::string> lines = apps::split(apps::trimmed(folder.read(file)), '\n');
  const std::vector<std::string> names = apps::split(lines.front(), ',');
  const auto place = std::size_t(std::ranges::find(names, name) - names.begin());
  std::vector<double> result;
  for (std::size_t k = 1; k < lines.size(); ++k)
    result.push_back(std::stod(apps::split(lines[k], ',').at(place)));
  return result;
}

} // namespace body_runs
