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

double mean_load(const Loading& loading, double time, double span)
{
  const std::vector<LoadPoint>& points = loading.points;
  const auto first = point_after(loading, time - span); // the segment that ends there counts too
  double sum = 0;
  for (auto k = first == points.begin() ? first : first - 1; k != points.end(); ++k) {
    const double begin = std::max(time - span, k->time);
    const double end = k + 1 != points.end() ? std::min(time, (k + 1)->time) : time;
    if (k->time >= time)
      break;
    if (end > begin)
      sum += (end - begin) *
             (load_value(loading, begin) + 0.5 * (end - begin) * load_rate(loading, begin));
  }
  return sum / span;
}

double last_jump(const Loading& loading, double time)
{
  const std::vector<LoadPoint>& points = loading.points;
  for (auto k = point_after(loading, time); k != points.begin();) {
    --k;
    const bool at_once = k == points.begin() || k->time == (k - 1)->time;
    const double before = k == points.begin() ? 0 : (k - 1)->value;
    if (at_once && k->value != before)
      return k->time;
  }
  return -std::numeric_limits<double>::infinity();
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
