#include "apps/measured.h"

#include "apps/fit_data.h"
#include "apps/run_checks.h"
#include "apps/run_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace apps {

MeasuredCurve measured_curve(const LoadedScene& scene)
{
  MeasuredCurve curve;
  if (scene.scene->output.measured.empty())
    return curve;
  constexpr double same = 0.01, same_temperature = 0.5; // [-], [K]
  const std::filesystem::path file = scene.folder / scene.scene->output.measured;
  const FitData data = read_fit_data(file);
  if (data.measurements.quantity != fem::Quantity::creep_compliance)
    throw std::invalid_argument(fmt::format(
        "{}: a creep test is needed beside the simulation: 'axial strain' and 'axial stress', or "
        "'creep compliance'",
        file.string()));
  const double stress = scene.scene->load.stress;
  const double temperature = scene.scene->temperature.temperature;
  for (std::size_t k = 0; k < data.measurements.points.size(); ++k) {
    if (!data.stresses.empty() &&
        std::abs(data.stresses[k] - std::abs(stress)) > same * std::abs(stress))
      continue;
    if (data.has_temperature &&
        std::abs(data.measurements.points[k].temperature - temperature) > same_temperature)
      continue;
    curve.time.push_back(data.measurements.points[k].at);
    curve.strain.push_back(
        data.measurements.points[k].value *
        (data.stresses.empty() ? stress : std::copysign(data.stresses[k], stress)));
  }
  if (curve.time.empty())
    throw std::invalid_argument(fmt::format(
        "{}: no row is at {:g} kPa and {:g} degC, the axial stress and the temperature of "
        "the scene",
        file.string(), 1e-3 * std::abs(stress), temperature - 273.15));
  return curve;
}

Agreement agreement(const MeasuredCurve& curve, const std::vector<Column>& history)
{
  const std::vector<double>& time = column_of(history, "time_s").values;
  const std::vector<double>& percent = column_of(history, "axial_strain_percent").values;
  double squares = 0, largest = 0;
  std::size_t n = 0;
  for (std::size_t k = 0; k < curve.time.size(); ++k)
    if (curve.time[k] >= time.front() && curve.time[k] <= time.back()) {
      const double found = 0.01 * value_at(time, percent, curve.time[k]);
      squares += (found - curve.strain[k]) * (found - curve.strain[k]);
      largest = std::max(largest, std::abs(curve.strain[k]));
      ++n;
    }
  return {n, n > 0 ? std::sqrt(squares / double(n)) / largest
                   : std::numeric_limits<double>::quiet_NaN()};
}

std::vector<Column> measured_columns(const MeasuredCurve& curve)
{
  std::vector<Column> columns{{"time_s", "s", curve.time}, {"axial_strain_percent", "%", {}}};
  for (const double strain : curve.strain)
    columns[1].values.push_back(100 * strain);
  return columns;
}

} // namespace apps
