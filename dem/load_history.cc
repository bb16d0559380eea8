#include "dem/load_history.h"

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

/// Averaging window that ends at a time.
struct Window {
  double from;
  double from_rate; ///< derivative of `from` with respect to the time [-]
};

Window window(const LoadHistory& history, const RateLaw& law, double time)
{
  const double begin = start(history.segments.front()), elapsed = time - begin;
  if (law.window >= elapsed)
    return {begin, 0};
  if (law.window >= law.window_fraction * elapsed)
    return {time - law.window, 1};
  return {time - law.window_fraction * elapsed, 1 - law.window_fraction};
}

bool is_instantaneous(const RateLaw& law)
{
  return law.window <= 0 && law.window_fraction <= 0;
}

Range united(Range a, Range b)
{
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

Range common(Range a, Range b)
{
  const Range both{std::max(a.low, b.low), std::min(a.high, b.high)};
  return both.low <= both.high ? both : a; // disjoint by rounding only
}

std::size_t segment_index(const LoadHistory& history, double time)
{
  const auto after =
      std::ranges::upper_bound(history.segments, time, {}, [](const auto& s) { return start(s); });
  return after == history.segments.begin() ? 0 : std::size_t(after - history.segments.begin()) - 1;
}

/// Union of the ranges of a function over all segments that an interval meets.
template <typename RangeOf>
Range range_over_segments(const LoadHistory& history, double from, double to, RangeOf&& range_of)
{
  const std::size_t last = segment_index(history, to);
  std::size_t k = segment_index(history, from);
  Range result =
      range_of(history.segments[k], from, k == last ? to : start(history.segments[k + 1]));
  for (++k; k <= last; ++k)
    result = united(result, range_of(history.segments[k], start(history.segments[k]),
                                     k == last ? to : start(history.segments[k + 1])));
  return result;
}

Range rates_over(const LoadHistory& history, double from, double to)
{
  return range_over_segments(history, from, to, [&](const LoadSegment& s, double a, double b) {
    return displacement_rate_range(s, history.creep, a, b);
  });
}

Range displacements_over(const LoadHistory& history, double from, double to)
{
  return range_over_segments(history, from, to, [&](const LoadSegment& s, double a, double b) {
    return smooth_displacement_range(s, history.creep, a, b);
  });
}

/// Average rate of the displacement over the window that ends at a time [m/s].
double averaged_rate(const LoadHistory& history, const RateLaw& law, double time)
{
  const LoadSegment& now = segment_at(history, time);
  const double from = window(history, law, time).from;
  if (is_instantaneous(law) || !(time - from > 1e-14 * std::abs(time)))
    return displacement_rate(now, history.creep, time);
  return (smooth_displacement(now, history.creep, time) -
          smooth_displacement(segment_at(history, from), history.creep, from)) /
         (time - from);
}

Range averaged_rate_range(const LoadHistory& history, const RateLaw& law, double from, double to)
{
  const Range now = rates_over(history, from, to);
  if (is_instantaneous(law))
    return now;
  const Window first = window(history, law, from), last = window(history, law, to);
  Range average = rates_over(history, first.from, to); // an average lies between extremes
  const double shortest = std::min(from - first.from, to - last.from);
  if (!(shortest > 0))
    return average;
  const double longest = std::max(from - first.from, to - last.from);
  const Range end = displacements_over(history, from, to);
  const Range begin = displacements_over(history, first.from, last.from);
  const auto quotient = [&](double gain) { return gain / (gain > 0 ? longest : shortest); };
  const auto quotient_high = [&](double gain) { return gain / (gain > 0 ? shortest : longest); };
  average = common(average, {quotient(end.low - begin.high), quotient_high(end.high - begin.low)});
  if (first.from_rate != last.from_rate)
    return average;
  // Derivative of the average: if it has one sign, the extremes are at the ends.
  const Range then = rates_over(history, first.from, last.from);
  const double shift = first.from_rate;
  const double low = now.low - shift * then.high - (1 - shift) * average.high;
  const double high = now.high - shift * then.low - (1 - shift) * average.low;
  if (low < 0 && high > 0)
    return average;
  const double a = averaged_rate(history, law, from), b = averaged_rate(history, law, to);
  return {std::min(a, b), std::max(a, b)};
}

/// Ratio under a load; 0 without load, even if a strength is 0.
double ratio_under(double load, const CriticalRatio& ratio)
{
  return load > 0 ? load * ratio.positive : load < 0 ? -load * ratio.negative : 0;
}

/// First time in [from, to] at which something holds.
/// \param holds        whether it holds at a time
/// \param cannot_hold  whether it surely holds nowhere between two times
template <typename Holds, typename CannotHold>
std::optional<double> first_time(Holds&& holds, CannotHold&& cannot_hold, double from, double to)
{
  if (holds(from))
    return from;
  if (cannot_hold(from, to))
    return std::nullopt;
  const double middle = from + 0.5 * (to - from);
  if (!(middle > from && middle < to))
    return holds(to) ? std::optional(to) : std::nullopt;
  if (const auto time = first_time(holds, cannot_hold, from, middle))
    return time;
  return first_time(holds, cannot_hold, middle, to);
}

} // namespace

double start(const LoadSegment& segment)
{
  return std::visit([](const auto& s) { return s.start; }, segment);
}

const LoadSegment& segment_at(const LoadHistory& history, double time)
{
  return history.segments[segment_index(history, time)];
}

double strain(const LoadHistory& history, double time)
{
  return displacement(segment_at(history, time), history.creep, time) / history.gauge_length;
}

double averaged_strain_rate(const LoadHistory& history, const RateLaw& law, double time)
{
  return averaged_rate(history, law, time) / history.gauge_length;
}

Range averaged_strain_rate_range(const LoadHistory& history, const RateLaw& law, double from,
                                 double to)
{
  const Range range = averaged_rate_range(history, law, from, to);
  return {range.low / history.gauge_length, range.high / history.gauge_length};
}

std::optional<double> first_breakage(const LoadHistory& history, const RateLaw& law,
                                     const CriticalRatio& ratio, double from, double to)
{
  const auto broken = [&](double time) {
    const double now = ratio_under(load(segment_at(history, time), history.creep, time), ratio);
    return now > 0 && now >= strength_factor(law, averaged_strain_rate(history, law, time));
  };
  const auto surely_whole = [&](double a, double b) {
    const Range loads = load_range(segment_at(history, a), history.creep, a, b);
    const double largest = std::max(ratio_under(loads.low, ratio), ratio_under(loads.high, ratio));
    if (largest == 0)
      return true;
    const auto [low, high] = averaged_strain_rate_range(history, law, a, b);
    const double slowest = low <= 0 && high >= 0 ? 0 : std::min(std::abs(low), std::abs(high));
    return largest < (1 + 1e-15) * strength_factor(law, slowest);
  };
  return first_time(broken, surely_whole, from, to);
}

std::optional<double> first_strain(const LoadHistory& history, double limit, double from, double to)
{
  const double reach = limit * history.gauge_length;
  const auto beyond = [&](double time) {
    return std::abs(displacement(segment_at(history, time), history.creep, time)) >= reach;
  };
  const auto surely_within = [&](double a, double b) {
    const LoadSegment& segment = segment_at(history, a);
    const double jumps = std::visit([](const auto& s) { return s.jumps; }, segment);
    const auto [low, high] = smooth_displacement_range(segment, history.creep, a, b);
    return std::max(std::abs(low + jumps), std::abs(high + jumps)) < reach;
  };
  return first_time(beyond, surely_within, from, to);
}

std::optional<double> first_turn(const LoadHistory& history, double from, double to)
{
  const auto at = [&](double time) { return load(segment_at(history, time), history.creep, time); };
  double before = at(from);
  if (before == 0) // sets out from nothing: the sign that follows
    before = at(shortly_after(from, to));
  const auto turned = [&](double time) { return at(time) * before < 0; };
  const auto surely_not = [&](double a, double b) {
    const Range loads = load_range(segment_at(history, a), history.creep, a, b);
    return before > 0 ? loads.low >= 0 : before < 0 ? loads.high <= 0 : true;
  };
  return first_time(turned, surely_not, from, to);
}

} // namespace dem
