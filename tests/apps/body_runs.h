#pragma once
#include "apps/csv_table.h"
#include "tests/apps/interrupted.h"

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

} // namespace body_runs
