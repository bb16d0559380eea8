#include "apps/point.h"

#include "apps/csv_table.h"
#include "apps/files.h"
#include "apps/run.h"
#include "apps/scene_text.h"
#include "fem/law_file.h"
#include "fem/mandel.h"
#include "fem/point_driver.h"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <stdexcept>

namespace apps {

namespace {

const std::array<std::string, 6> names{"xx", "yy", "zz", "yz", "xz", "xy"};

double mandel_factor(std::size_t component)
{
  return component < 3 ? 1 : std::numbers::sqrt2;
}

/// A history as it is typed: what is prescribed of each component.
struct PointHistory {
  std::array<bool, 6> strain_given{};
  std::vector<fem::PointTarget> targets; ///< in real time
};

PointHistory read_history(const std::string& file, const Units& units)
{
  const CsvTable table(file, units);
  std::vector<std::string> allowed{"time"};
  for (const std::string& name : names) {
    allowed.push_back("strain_" + name);
    allowed.push_back("stress_" + name);
  }
  table.allow_only(allowed);
  PointHistory history;
  for (const double time : table.numbers("time", "s"))
    history.targets.push_back({time, fem::Vec6::Zero()});
  bool prescribed = false;
  for (std::size_t c = 0; c < 6; ++c) {
    const bool strain = table.find("strain_" + names[c]).has_value();
    const bool stress = table.find("stress_" + names[c]).has_value();
    if (strain && stress)
      throw std::invalid_argument(fmt::format("{}: give either strain_{} or stress_{}, not both",
                                              file, names[c], names[c]));
    history.strain_given[c] = strain;
    prescribed = prescribed || strain || stress;
    if (!strain && !stress) // free of stress
      continue;
    const std::vector<double> values = strain ? table.numbers("strain_" + names[c], "1")
                                              : table.numbers("stress_" + names[c], "Pa");
    for (std::size_t k = 0; k < values.size(); ++k)
      history.targets[k].value[Eigen::Index(c)] = mandel_factor(c) * values[k];
  }
  if (!prescribed)
    throw std::invalid_argument(fmt::format(
        "{}: prescribes nothing; its columns are time [s] and, of xx, yy, zz, yz, xz, xy, "
        "strain_xx [%] or stress_xx [kPa]",
        file));
  return history;
}

std::vector<Column> point_columns(const fem::PointRun& run, const std::vector<double>& times)
{
  std::vector<Column> columns{{"time_s", "s", times}};
  for (std::size_t c = 0; c < 6; ++c) {
    Column strain{fmt::format("strain_{}_percent", names[c]), "%", {}};
    for (const fem::PointReading& r : run.readings)
      strain.values.push_back(100 * fem::tensor_components(r.strain)[Eigen::Index(c)]);
    columns.push_back(strain);
  }
  for (std::size_t c = 0; c < 6; ++c) {
    Column stress{fmt::format("stress_{}_kPa", names[c]), "kPa", {}};
    for (const fem::PointReading& r : run.readings)
      stress.values.push_back(fem::tensor_components(r.stress)[Eigen::Index(c)] / 1e3);
    columns.push_back(stress);
  }
  return columns;
}

} // namespace

int point_verb(const PointOptions& options)
{
  const Units units;
  const fem::LawRecord record = fem::law_from_text(read_text_file(options.law), options.law);
  const double temperature = options.temperature.empty()
                                 ? record.reference_temperature
                                 : units.parse(options.temperature, "K", "degC");
  const bool shifts = !std::holds_alternative<std::monostate>(record.shift);
  if (!shifts && std::abs(temperature - record.reference_temperature) > 1e-6)
    throw std::invalid_argument(fmt::format("--temperature: the law is for {:g} degC and names no "
                                            "temperature shift",
                                            record.reference_temperature - 273.15));
  const double shift = shifts ? fem::shift_factor(record.shift, temperature) : 1;
  PointHistory history = read_history(options.history, units);
  std::vector<double> times;
  for (fem::PointTarget& target : history.targets) {
    times.push_back(target.time);
    target.time /= shift;
  }
  const bool strains = std::ranges::find(history.strain_given, true) != history.strain_given.end();
  const double last = history.targets.back().time;
  const fem::PointRun run = fem::drive_point(
      record.law, strains ? fem::TimeScheme::strain_linear : fem::TimeScheme::stress_linear,
      history.strain_given, history.targets, {options.tolerance, 1e-6 * last, 3});
  if (record.last_time > 0 && last > record.last_time * (1 + 1e-6))
    fmt::print(stderr,
               "warning: the history lasts {:.4g} s of reduced time, but the law was seen "
               "up to {:.4g} s only\n",
               last, record.last_time);
  const std::string text = csv(point_columns(run, times));
  if (options.output.empty())
    fmt::print("{}", text);
  else
    write_text_file(options.output, text);
  fmt::print(stderr, "{} time steps, estimated error together {:.2g}\n", run.n_steps,
             run.error_sum);
  return exit_ok;
}

} // namespace apps
