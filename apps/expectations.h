#pragma once
#include <optional>
#include <string>
#include <vector>

namespace apps {

class Schema;
class Units;

/// How a run is expected to end.
enum class ExpectedEnd {
  any,
  finished,
  strain_limit,
  lost_equilibrium,
  refused, ///< the input, before anything is computed
  failed   ///< the computation
};

/// What an error is divided by.
enum class ErrorBase {
  value,  ///< the value expected; if that is 0, the largest one of its column
  largest ///< the largest value expected of its column
};

/// A number in a table of results.
struct ExpectedValue {
  enum class Table { history, particles, bonds, breakages };
  std::string name; ///< as typed: "particle 7 ux_mm at 30 s"
  Table table;
  std::size_t row; ///< of the particle, bond or breakage
  std::string column;
  double time; ///< [s]
  double value;
};

/// A closed form for a column of the history.
struct ExpectedCurve {
  std::string column, formula; ///< of t, the time in seconds
};

/// What a scene expects of its own run: section Expect.
struct Expectations {
  std::string values_text, curves_text; ///< as typed
  std::vector<ExpectedValue> values;
  std::vector<ExpectedCurve> curves;
  double from; ///< curves count from this time [s]
  double tolerance;
  ErrorBase base;
  std::optional<double> n_broken;
  std::vector<double> break_times; ///< [s]
  std::vector<double> break_order; ///< numbers of bonds
  ExpectedEnd end;
  std::string messages; ///< separated by ';'
};

enum class Comparison { everything, history, breakages };

/// The same run made another way, which must give the same: section Repeat.
struct RepeatedRun {
  std::string scene, settings; ///< another file, or overrides separated by ';'
  long n_threads;              ///< 0: as the run itself
  long n_interruptions;
  Comparison compare;
  std::string factors; ///< "column: factor" separated by commas
  double tolerance;    ///< 0: bit for bit

  bool wanted() const;
};

/// Declares the keys of both sections.
void declare(Schema& schema, Expectations& expectations);
void declare(Schema& schema, RepeatedRun& repetition);

/// Takes values and curves from their texts.
/// \throws std::invalid_argument naming the part that cannot be read
void read_expectations(Expectations& expectations, const Units& units);

/// Whether a scene expects anything of its run.
bool expects_anything(const Expectations& expectations);

std::string name_of(ExpectedEnd end);

} // namespace apps
