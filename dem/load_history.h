#pragma once
#include "dem/bond_ratios.h"
#include "dem/load_segment.h"
#include "dem/strength.h"

#include <optional>
#include <vector>

namespace dem {

/// Load and displacement of a network from the start to now, in segments.
///
/// Each segment begins when the network or the slope of the load changes; it holds until the next
/// one begins, the last one for ever.
struct LoadHistory {
  NetworkCreep creep;
  std::vector<LoadSegment> segments;
  double gauge_length; ///< displacement over strain [m]
};

double start(const LoadSegment& segment);

/// Segment that holds at a time; at a boundary the later one.
const LoadSegment& segment_at(const LoadHistory& history, double time);

/// Strain at the load, tension positive [-].
double strain(const LoadHistory& history, double time);

/// Strain rate that counts for the strengths [1/s]: without elastic jumps, averaged over the window
/// of the rate law (over the time since the start while that is shorter).
double averaged_strain_rate(const LoadHistory& history, const RateLaw& law, double time);

/// Bounds of the averaged strain rate over an interval inside one segment. They are attained at the
/// ends where the rate is monotonic, and tighten with the interval elsewhere.
Range averaged_strain_rate_range(const LoadHistory& history, const RateLaw& law, double from,
                                 double to);

/// First time in [from, to] at which the ratio of the critical bond reaches the strength factor:
/// |load| * ratio >= factor(rate). Nothing if it stays below.
///
/// The interval is halved until bounds exclude a crossing or the time is found to the last digit,
/// so that no crossing is stepped over (up to 1e-15 of the strength).
std::optional<double> first_breakage(const LoadHistory& history, const RateLaw& law,
                                     const CriticalRatio& ratio, double from, double to);

/// First time in [from, to] at which the strain reaches a limit > 0 in either direction.
std::optional<double> first_strain(const LoadHistory& history, double limit, double from,
                                   double to);

/// A time after `from` so early that what grows from 0 has the sign that it keeps for a while.
inline double shortly_after(double from, double to)
{
  return from + 1e-9 * (to - from);
}

/// First time in [from, to] at which the load has the other sign than at `from` (if it is 0 there:
/// than right after).
std::optional<double> first_turn(const LoadHistory& history, double from, double to);

} // namespace dem
