#pragma once
#include "apps/run.h"

#include <filesystem>
#include <string>
#include <vector>

namespace apps {

/// One thing that was expected of a run, and what came.
struct Check {
  std::string what, expected, found;
  double error, tolerance;

  bool met() const { return error <= tolerance; } // not for an error that is not a number
};

/// A check of two words or counts.
Check exact_check(const std::string& what, const std::string& expected, const std::string& found);

/// What the section Expect says against a run that has come to its end.
std::vector<Check> check_run(const RunInProgress& run);

/// The same for a run that has nothing but a history, and came to the end of its loading.
std::vector<Check> check_history(const Expectations& expectations,
                                 const std::vector<Column>& history);

/// The same for an input that was refused, or a computation that failed.
std::vector<Check> check_failure(const Expectations& expectations, ExpectedEnd end,
                                 const std::string& message);

/// Column of a table. \throws std::invalid_argument if there is none of that name
const Column& column_of(const std::vector<Column>& columns, const std::string& name);

/// Prints what is met and what is not, and writes all into checks.csv.
/// \return whether all is met
bool report_checks(const std::vector<Check>& checks, const std::filesystem::path& folder);

/// Reads checks.csv; empty if there is none.
std::vector<Check> read_checks(const std::filesystem::path& folder);

} // namespace apps
