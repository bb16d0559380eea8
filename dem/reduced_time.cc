#include "dem/reduced_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

using Piece = ReducedTime::Piece;

/// Largest change of ln a_T over a piece: eight Gauss points are exact to rounding then.
constexpr double largest_change = 0.5;

void validate(std::span<const TemperaturePoint> points)
{
  if (points.empty())
    throw std::invalid_argument("at least one point in time is needed");
  for (std::size_t k = 0; k < points.size(); ++k)
    if (!std::isfinite(points[k].time) || points[k].time < 0 ||
        (k > 0 && points[k].time < points[k - 1].time))
      throw std::invalid_argument(
          fmt::format("times must not decrease and not be negative; point {} "
                      "is at {:g} s",
                      k + 1, points[k].time));
}

double temperature(const Piece& piece, double time)
{
  return piece.temperature + piece.slope * (time - piece.time);
}

/// Integral of 1/a_T between two times of a piece [s], by Gauss quadrature with eight points.
double quadrature(const TemperatureShift& shift, const Piece& piece, double from, double to)
{
  constexpr double point[] = {0.18343464249564980494, 0.52553240991632898582,
                              0.79666647741362673959, 0.96028985649753623168};
  constexpr double weight[] = {0.36268378337836198297, 0.31370664587788728734,
                               0.22238103445337447054, 0.10122853629037625915};
  if (piece.slope == 0)
    return (to - from) / shift_factor(shift, piece.temperature);
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  double sum = 0;
  for (int k = 0; k < 4; ++k)
    for (const double side : {-1.0, 1.0})
      sum += weight[k] / shift_factor(shift, temperature(piece, middle + side * point[k] * half));
  return half * sum;
}

const Piece& piece_at(const ReducedTime& history, double time)
{
  const auto after = std::ranges::upper_bound(history.pieces, time, {}, &Piece::time);
  return after == history.pieces.begin() ? *after : *(after - 1);
}

/// Appends a piece; `reduced` is that of the piece before it at its start.
void append(ReducedTime& history, double time, double temperature, double slope)
{
  double reduced = 0;
  if (!history.pieces.empty()) {
    const Piece& last = history.pieces.back();
    reduced = last.reduced + quadrature(history.shift, last, last.time, time);
  }
  history.pieces.push_back({time, temperature, slope, reduced});
}

/// Appends a stretch of linear temperature in pieces over which a_T changes little.
void append_stretch(ReducedTime& history, TemperaturePoint from, TemperaturePoint to)
{
  const auto log_shift = [&](double t) { return std::log(shift_factor(history.shift, t)); };
  const double change = std::abs(log_shift(to.temperature) - log_shift(from.temperature));
  const TemperaturePoint middle{0.5 * (from.time + to.time),
                                0.5 * (from.temperature + to.temperature)};
  if (change > largest_change && middle.time > from.time && middle.time < to.time) {
    append_stretch(history, from, middle);
    append_stretch(history, middle, to);
  } else if (to.time > from.time)
    append(history, from.time, from.temperature,
           (to.temperature - from.temperature) / (to.time - from.time));
}

} // namespace

ReducedTime make_reduced_time(std::span<const TemperaturePoint> points,
                              const TemperatureShift& shift)
{
  validate(points);
  ReducedTime history{shift, {}};
  append_stretch(history, {0, points.front().temperature}, points.front());
  for (std::size_t k = 1; k < points.size(); ++k)
    append_stretch(history, points[k - 1], points[k]);
  shift_factor(shift, points.back().temperature); // throws if it cannot be
  append(history, points.back().time, points.back().temperature, 0);
  return history;
}

double temperature(const ReducedTime& history, double time)
{
  return temperature(piece_at(history, time), std::max(time, 0.0));
}

double shift_factor(const ReducedTime& history, double time)
{
  return shift_factor(history.shift, temperature(history, time));
}

double reduced_duration(const ReducedTime& history, double from, double to)
{
  if (to < from)
    return -reduced_duration(history, to, from);
  const Piece &first = piece_at(history, from), &last = piece_at(history, to);
  if (&first == &last)
    return quadrature(history.shift, first, from, to);
  const Piece& second = *(&first + 1);
  return quadrature(history.shift, first, from, second.time) + (last.reduced - second.reduced) +
         quadrature(history.shift, last, last.time, to);
}

double reduced_time(const ReducedTime& history, double time)
{
  const Piece& piece = piece_at(history, time);
  return piece.reduced + quadrature(history.shift, piece, piece.time, time);
}

} // namespace dem
