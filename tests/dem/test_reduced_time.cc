#include "dem/reduced_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

using namespace dem;

namespace {

const TemperatureShift wlf = WlfShift{19, 92, 293.15};
const TemperatureShift arrhenius = ArrheniusShift{200e3, 293.15};

/// Integral of 1/a_T along a linear temperature, by tanh-sinh quadrature in small pieces.
double integral(const TemperatureShift& shift, TemperaturePoint from, TemperaturePoint to)
{
  const int n_pieces = 400;
  const double length = (to.time - from.time) / n_pieces;
  long double sum = 0;
  for (int piece = 0; piece < n_pieces; ++piece)
    for (int k = -40; k <= 40; ++k) {
      const long double u = 0.08L * k, w = 1.57079632679489661923L * std::sinh(u);
      const long double x = std::tanh(w),
                        dx = 1.57079632679489661923L * std::cosh(u) / (std::cosh(w) * std::cosh(w));
      const double share = (piece + 0.5 * double(1 + x)) / n_pieces;
      const double temperature = from.temperature + share * (to.temperature - from.temperature);
      sum += 0.08L * dx * 0.5L / shift_factor(shift, temperature);
    }
  return double(sum) * length;
}

void expect_close(double found, double expected, double relative)
{
  EXPECT_NEAR(found, expected, relative * std::abs(expected));
}

} // namespace

TEST(ReducedTime, AtConstantTemperatureIsTimeOverTheShift)
{
  for (const TemperatureShift& shift : {wlf, arrhenius, TemperatureShift{}})
    for (const double kelvin : {273.15, 293.15, 323.15}) {
      const std::vector<TemperaturePoint> points{{0, kelvin}};
      const ReducedTime history = make_reduced_time(points, shift);
      for (const double time : {0.0, 1e-6, 3.0, 1e9}) {
        EXPECT_DOUBLE_EQ(reduced_time(history, time), time / shift_factor(shift, kelvin));
        EXPECT_DOUBLE_EQ(shift_factor(history, time), shift_factor(shift, kelvin));
      }
    }
}

TEST(ReducedTime, FollowsLinearTemperatures)
{
  for (const TemperatureShift& shift : {wlf, arrhenius})
    for (const double end : {263.15, 295.15, 333.15}) {
      const TemperaturePoint from{100, 283.15}, to{700, end};
      const ReducedTime history = make_reduced_time(std::vector{from, to}, shift);
      const double before = 100 / shift_factor(shift, 283.15);
      expect_close(reduced_time(history, 100), before, 1e-15);
      expect_close(reduced_duration(history, 100, 700), integral(shift, from, to), 2e-13);
      const TemperaturePoint middle{350, 283.15 + (end - 283.15) * 250 / 600};
      expect_close(reduced_time(history, 350), before + integral(shift, from, middle), 2e-13);
      expect_close(reduced_time(history, 1000),
                   before + integral(shift, from, to) + 300 / shift_factor(shift, end), 2e-13);
      EXPECT_NEAR(temperature(history, 350), middle.temperature, 1e-11);
      EXPECT_NEAR(temperature(history, 800), end, 1e-11);
    }
}

TEST(ReducedTime, HasAClosedFormWhereTheShiftIsExponential)
{
  // Over 1e-3 K the Arrhenius law is exponential to 1e-9: xi = t (exp(c) - 1) / c with c = -d ln
  // aT.
  const ReducedTime history =
      make_reduced_time(std::vector<TemperaturePoint>{{0, 293.15}, {10, 293.151}}, arrhenius);
  const double c = -std::log(shift_factor(arrhenius, 293.151));
  expect_close(reduced_time(history, 10), 10 * std::expm1(c) / c, 1e-9);
}

TEST(ReducedTime, AddsUpAndGrows)
{
  const ReducedTime history = make_reduced_time(
      std::vector<TemperaturePoint>{{0, 293.15}, {60, 313.15}, {60, 273.15}, {1e5, 300}}, wlf);
  double before = 0;
  for (double time = 0.01; time < 1e6; time *= 1.7) {
    const double now = reduced_time(history, time);
    EXPECT_GT(now, before);
    const double third = time / 3;
    expect_close(reduced_duration(history, 0, third) + reduced_duration(history, third, time), now,
                 1e-13);
    EXPECT_EQ(reduced_duration(history, time, third), -reduced_duration(history, third, time));
    before = now;
  }
  // a short span late in a long history has all its digits
  const double at = 9e4, span = 1e-9 * at;
  expect_close(reduced_duration(history, at, at + span),
               (at + span - at) / shift_factor(history, at + span / 2), 1e-12);
}

TEST(ReducedTime, JumpsWithTheTemperature)
{
  const ReducedTime history = make_reduced_time(
      std::vector<TemperaturePoint>{{0, 293.15}, {5, 293.15}, {5, 303.15}}, arrhenius);
  EXPECT_EQ(temperature(history, 4.999), 293.15);
  EXPECT_EQ(temperature(history, 5), 303.15);
  expect_close(reduced_time(history, 7), 5 + 2 / shift_factor(arrhenius, 303.15), 1e-14);
}

TEST(ReducedTime, RefusesWhatCannotBe)
{
  const auto make = [](const std::vector<TemperaturePoint>& points) {
    return make_reduced_time(points, wlf);
  };
  EXPECT_THROW(make({}), std::invalid_argument);
  EXPECT_THROW(make({{5, 293}, {4, 293}}), std::invalid_argument);
  EXPECT_THROW(make({{-1, 293}}), std::invalid_argument);
  EXPECT_THROW(make({{0, 293}, {10, 200}}), std::invalid_argument); // below the pole of WLF
  EXPECT_THROW(make({{0, 293}, {10, std::nan("")}}), std::invalid_argument);
}
