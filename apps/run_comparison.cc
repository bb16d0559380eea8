#include "apps/run_comparison.h"

#include "apps/text.h"

#include <algorithm>
#include <cmath>

namespace apps {

namespace {

/// True for a row at an instant at which the load jumps, or may do so: the first, and both sides
/// of a later one.
bool at_jump(const std::vector<double>& times, std::size_t k)
{
  const auto same = [&](std::size_t a, std::size_t b) {
    return times[b] <= std::nextafter(times[a], INFINITY);
  };
  return k == 0 || same(k - 1, k) || (k + 1 < times.size() && same(k, k + 1));
}

/// A difference over a reference; nothing if the reference is 0 and the difference is not.
std::optional<double> relative(double difference, double reference)
{
  if (difference == 0)
    return 0;
  if (reference == 0 || !std::isfinite(difference))
    return std::nullopt;
  return std::abs(difference / reference);
}

Ruptures which_ruptures(const RunCurve& run, const RunCurve& reference)
{
  if (run.rupture_time.has_value() == reference.rupture_time.has_value())
    return run.rupture_time ? Ruptures::both : Ruptures::neither;
  return run.rupture_time ? Ruptures::only_run : Ruptures::only_reference;
}

/// The column of a history that the load does not prescribe, and what it is.
std::pair<std::string, std::string> answer(const dem::Hdf5File& result)
{
  const std::vector<std::string> columns = split(result.text_attribute("history", "columns"), ',');
  const auto has = [&](const char* name) {
    return std::ranges::find(columns, name) != columns.end();
  };
  if (has("mean_displacement_mm"))
    return {"displacement", "mean_displacement_mm"};
  if (result.text_attribute("", "control") == "displacement")
    return {"stress", "axial_stress_kPa"};
  return {"strain", "axial_strain_percent"};
}

} // namespace

double value_at(const std::vector<double>& times, const std::vector<double>& values, double time)
{
  const auto after = std::ranges::lower_bound(times, time);
  if (after == times.end())
    return values.back();
  const auto k = std::size_t(after - times.begin());
  if (*after == time || k == 0)
    return values[k];
  const double share = (time - times[k - 1]) / (times[k] - times[k - 1]);
  return values[k - 1] + share * (values[k] - values[k - 1]);
}

RunCurve read_run_curve(const dem::Hdf5File& result)
{
  const auto [quantity, column] = answer(result);
  RunCurve curve{quantity, result.read_doubles("history/time_s"),
                 result.read_doubles("history/" + column),
                 result.read_doubles("history/broken_bonds"), std::nullopt};
  const std::string end = result.text_attribute("", "end");
  const bool early = end == "lost equilibrium" || end == "strain limit";
  if (end == "lost equilibrium" || (end == "strain limit" && quantity != "stress"))
    curve.rupture_time = curve.time.back();
  if (early)
    for (std::vector<double>* each : {&curve.time, &curve.value, &curve.n_broken})
      each->pop_back();
  return curve;
}

RunErrors compare(const RunCurve& run, const RunCurve& reference)
{
  RunErrors errors;
  errors.ruptures = which_ruptures(run, reference);
  if (errors.ruptures == Ruptures::both)
    errors.rupture = relative(*run.rupture_time - *reference.rupture_time, *reference.rupture_time);
  if (run.time.empty() || reference.time.empty())
    return errors;
  double largest = 0, size = 0;
  for (std::size_t k = 0; k < reference.time.size(); ++k) {
    const double time = reference.time[k], expected = reference.value[k];
    if (time > run.time.back())
      break;
    if (at_jump(reference.time, k))
      continue;
    const double difference = value_at(run.time, run.value, time) - expected;
    largest = std::isfinite(difference) ? std::max(largest, std::abs(difference)) : INFINITY;
    size = std::max(size, std::abs(expected));
    errors.last_time = time;
    errors.largest = relative(largest, size);
    errors.at_end = relative(difference, expected);
    errors.broken = relative(value_at(run.time, run.n_broken, time) - reference.n_broken[k],
                             reference.n_broken[k]);
  }
  return errors;
}

} // namespace apps
