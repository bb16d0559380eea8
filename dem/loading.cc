#include "dem/loading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dem {

namespace {

/// First point after a time.
auto point_after(const Loading& loading, double time)
{
  return std::ranges::upper_bound(loading.points, time, {}, &LoadPoint::time);
}

} // namespace

Loading step_load(Loading::Control control, double value, double end_time)
{
  return {control, {{0, value}, {end_time, value}}, false};
}

Loading step_and_release(double force, double release_time, double end_time)
{
  return {Loading::Control::force,
          {{0, force}, {release_time, force}, {release_time, 0}, {end_time, 0}},
          false};
}

Loading ramp(Loading::Control control, double rate, double end_time)
{
  return {control, {{0, 0}, {end_time, rate * end_time}}, false};
}

double load_value(const Loading& loading, double time)
{
  const auto after = point_after(loading, time);
  if (after == loading.points.begin())
    return 0;
  const LoadPoint before = *(after - 1);
  if (after == loading.points.end())
    return before.value;
  return before.value +
         (after->value - before.value) * (time - before.time) / (after->time - before.time);
}

double load_rate(const Loading& loading, double time)
{
  const auto after = point_after(loading, time);
  if (after == loading.points.begin() || after == loading.points.end())
    return 0;
  const LoadPoint before = *(after - 1);
  return (after->value - before.value) / (after->time - before.time);
}

double load_integral(const Loading& loading, double time)
{
  const std::vector<LoadPoint>& points = loading.points;
  double sum = 0;
  for (std::size_t k = 0; k < points.size() && points[k].time < time; ++k) {
    const double end = k + 1 < points.size() ? std::min(time, points[k + 1].time) : time;
    const double span = end - points[k].time;
    if (span > 0)
      sum += span * (points[k].value + 0.5 * span * load_rate(loading, points[k].time));
  }
  return sum;
}

double mean_load(const Loading& loading, double time, double span)
{
  return (load_integral(loading, time) - load_integral(loading, time - span)) / span;
}

double last_jump(const Loading& loading, double time)
{
  double result = -std::numeric_limits<double>::infinity();
  double before = 0;
  for (std::size_t k = 0; k < loading.points.size() && loading.points[k].time <= time; ++k) {
    const bool at_once = k == 0 || loading.points[k].time == loading.points[k - 1].time;
    if (at_once && loading.points[k].value != before)
      result = loading.points[k].time;
    before = loading.points[k].value;
  }
  return result;
}

double next_breakpoint(const Loading& loading, double time)
{
  const auto after = point_after(loading, time);
  return after == loading.points.end() ? std::numeric_limits<double>::infinity() : after->time;
}

double end_time(const Loading& loading)
{
  return loading.points.back().time;
}

void validate(const Loading& loading)
{
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("loading: " + what);
  };
  if (loading.points.size() < 2)
    refuse("at least two points in time are needed");
  for (std::size_t k = 0; k < loading.points.size(); ++k) {
    const auto [time, value] = loading.points[k];
    if (!std::isfinite(time) || !std::isfinite(value))
      refuse(fmt::format("point {} is not a finite number", k + 1));
    if (time < 0 || (k > 0 && time < loading.points[k - 1].time))
      refuse(fmt::format("times must not decrease and not be negative; point {} is at {:g} s",
                         k + 1, time));
  }
  if (loading.true_stress && loading.control != Loading::Control::force)
    refuse("true stress needs control by force");
}

} // namespace dem
