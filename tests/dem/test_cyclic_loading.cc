#include "dem/cyclic_loading.h"
#include "dem/linear.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

using namespace dem;
using std::numbers::pi;

namespace {

using Pulse = CyclicLoad::Pulse;

CyclicLoad haversine(long n_intervals)
{
  return {Pulse::haversine, -5, -95, 0.1, 0.9, 3, n_intervals};
}

/// Largest distance of the lines from a curve, over a time.
double largest_error(const Loading& loading, double end, const std::function<double(double)>& curve)
{
  double largest = 0;
  for (int k = 0; k <= 10000; ++k) {
    const double time = end * k / 10000;
    largest = std::max(largest, std::abs(load_value(loading, time) - curve(time)));
  }
  return largest;
}

/// Displacement [m] of one bond of a law under a load, by the event solver.
double by_events(const CreepLaw& law, const Loading& loading, double time)
{
  const Assembly assembly = event_runs::pair(law, 1e9);
  const EventsModel model = make_events_model(assembly, loading, event_runs::constant_strength,
                                              AfterBreakage::leave, event_runs::never);
  EventsSolver solver(model);
  EventsState state = solver.start();
  while (solver.next_change(state) <= time)
    state = solver.step(std::move(state));
  return solver.response(state, time).strain * assembly.gauge_length;
}

double by_linear(const CreepLaw& law, const Loading& loading, double time)
{
  return linear_response(make_linear_model(event_runs::pair(law, 1e9)), loading, time).displacement;
}

} // namespace

TEST(CyclicLoading, HaversineIsAsFarFromTheCurveAsItSays)
{
  for (const long n : {4L, 16L, 40L}) {
    const CyclicLoad load = haversine(n);
    const double error =
        largest_error(cyclic_loading(load), 0.1 - 1e-9, [](double t) { // the first pulse
          return -5 - 95 * std::pow(std::sin(pi * t / 0.1), 2);
        });
    EXPECT_LE(error, 95 * std::pow(pi / double(n), 2) / 4);
    EXPECT_GE(error, 0.8 * 95 * std::pow(pi / double(n), 2) / 4 * (n > 4));
  }
}

TEST(CyclicLoading, SineIsAsFarFromTheCurveAsItSays)
{
  for (const long n : {16L, 40L}) {
    const CyclicLoad load{Pulse::sine, -20, 100, 2, 0, 5, n};
    const double error = largest_error(
        cyclic_loading(load), 10, [](double t) { return -20 + 100 * std::sin(2 * pi * t / 2); });
    EXPECT_LE(error, 100 * std::pow(pi / double(n), 2) / 2);
    EXPECT_GE(error, 0.9 * 100 * std::pow(pi / double(n), 2) / 2);
  }
}

TEST(CyclicLoading, PulsesKeepTheIntegralOfTheCurve)
{
  for (const long n : {4L, 16L}) {
    const Loading loading = cyclic_loading(haversine(n));
    EXPECT_NEAR(mean_load(loading, 0.1, 0.1), -5 - 95 / 2.0, 1e-12);
    EXPECT_NEAR(mean_load(loading, 3, 3), -5 - 95 / 20.0, 1e-12);
    const Loading sine = cyclic_loading({Pulse::sine, -20, 100, 2, 0, 5, n});
    EXPECT_NEAR(mean_load(sine, 8, 6), -20, 1e-12);
  }
}

TEST(CyclicLoading, ExtremesAndZerosAreExactPoints)
{
  const Loading loading = cyclic_loading(haversine(16));
  validate(loading);
  EXPECT_EQ(loading.points.size(), 1u + 3 * 17);
  for (long cycle = 1; cycle <= 3; ++cycle) {
    EXPECT_EQ(load_value(loading, double(cycle)), -5);
    EXPECT_NEAR(load_value(loading, double(cycle) - 0.95), -100, 1e-11);
    EXPECT_EQ(load_value(loading, double(cycle) - 0.5), -5);
  }
  EXPECT_EQ(end_time(loading), cycle_end(haversine(16), 3));
  const CyclicLoad odd{Pulse::sine, 0, 7, 1.0 / 3, 0, 1000, 8};
  const Loading sine = cyclic_loading(odd);
  validate(sine);
  EXPECT_EQ(sine.points.size(), 8001u);
  for (std::size_t k = 1; k < sine.points.size(); ++k)
    EXPECT_LT(sine.points[k - 1].time, sine.points[k].time);
  EXPECT_EQ(sine.points[8 * 700].time, cycle_end(odd, 700));
  EXPECT_EQ(sine.points[8 * 700].value, 0);
  EXPECT_EQ(sine.points[8 * 700 + 2].value, 7);
  EXPECT_EQ(sine.points[8 * 700 + 4].value, 0);
}

TEST(CyclicLoading, BlocksCreepByExactSuperposition)
{
  const CyclicLoad load{Pulse::block, -3, -40, 2, 5, 6, 1};
  const Loading loading = cyclic_loading(load);
  validate(loading);
  for (const CreepLaw& law : {laws::burgers_set("asphalt"), laws::wide()})
    for (const double time : {0.0, 1.0, 1.999, 4.0, 7.5, 13.9, 36.5, 37.5, 42.0}) {
      double expected = -3 * creep_compliance(law, time);
      for (int k = 0; k < 6; ++k) {
        if (time >= 7 * k)
          expected -= 40 * creep_compliance(law, time - 7 * k);
        if (time >= 7 * k + 2)
          expected += 40 * creep_compliance(law, time - 7 * k - 2);
      }
      EXPECT_NEAR(by_linear(law, loading, time), expected, 1e-10 * std::abs(expected)) << time;
      EXPECT_NEAR(by_events(law, loading, time), expected, 1e-10 * std::abs(expected)) << time;
    }
}

TEST(CyclicLoading, SineFromRestConvergesAtOrderTwo)
{
  for (const reference::Row& row : reference::table("burgers_sine_transient.csv")) {
    if (row.at("set") != "asphalt")
      continue;
    const CreepLaw law = laws::burgers_set("asphalt");
    const double omega = reference::number(row, "omega"), time = reference::number(row, "t");
    const double expected = reference::number(row, "u_for_f_sin");
    const long n_cycles = long(std::ceil(time * omega / (2 * pi))) + 1;
    const auto error = [&](long n, auto&& displacement) {
      const Loading loading = cyclic_loading({Pulse::sine, 0, 1, 2 * pi / omega, 0, n_cycles, n});
      return std::abs(displacement(law, loading, time) - expected);
    };
    const double scale = std::abs(complex_compliance(law, omega));
    const double coarse = error(256, by_linear), fine = error(512, by_linear);
    EXPECT_LT(fine, 4e-5 * scale) << omega << " " << time;
    const double point = 256 * time * omega / (2 * pi);
    if (std::abs(point - std::round(point)) < 1e-6 && fine > 1e-9 * scale) {
      EXPECT_NEAR(coarse / fine, 4, 0.5) << omega << " " << time;
    }
    EXPECT_NEAR(error(256, by_events), coarse, 1e-9 * scale);
  }
}

TEST(LinearHistory, IsTheSuperpositionOfStepsAndRamps)
{
  using Control = Loading::Control;
  const Assembly assembly = event_runs::pair(laws::wide(), 1e9);
  const LinearModel model = make_linear_model(assembly);
  const std::vector<LoadPoint> points{{2, 1}, {3, 4}, {3, -2}, {50, 0}, {900, 0}, {1000, 6}};
  for (const Control control : {Control::force, Control::displacement}) {
    const Loading loading{control, points, false};
    const LoadHistory history = linear_history(model, loading);
    for (const double time : {2.0, 2.3, 3.0, 7.0, 49.0, 300.0, 950.0, 1000.0, 5000.0}) {
      const LinearResponse expected = linear_response(model, loading, time);
      const double load = dem::load(segment_at(history, time), history.creep, time);
      const double force = control == Control::force ? load : load / model.compliance;
      const double size =
          std::abs(expected.force) + std::abs(expected.displacement / model.compliance);
      EXPECT_NEAR(force, expected.force, 1e-11 * size) << time;
      EXPECT_NEAR(strain(history, time) * model.gauge_length, expected.displacement,
                  1e-11 * std::abs(expected.displacement) + 1e-20)
          << time;
    }
  }
}

TEST(CyclicLoading, RefusesWhatCannotBe)
{
  EXPECT_THROW(cyclic_loading({Pulse::haversine, 0, 1, 0, 1, 1, 16}), std::invalid_argument);
  EXPECT_THROW(cyclic_loading({Pulse::haversine, 0, 1, 1, -1, 1, 16}), std::invalid_argument);
  EXPECT_THROW(cyclic_loading({Pulse::haversine, 0, 1, 1, 1, 0, 16}), std::invalid_argument);
  EXPECT_THROW(cyclic_loading({Pulse::haversine, 0, 1, 1, 1, 1, 6}), std::invalid_argument);
  EXPECT_THROW(cyclic_loading({Pulse::block, 0, 1, 1, 0, 1, 16}), std::invalid_argument);
  EXPECT_THROW(cyclic_loading({Pulse::sine, 0, 1, std::nan(""), 0, 1, 16}), std::invalid_argument);
}

TEST(Loading, MeanAndLastJumpFollowTheirDefinition)
{
  using Control = Loading::Control;
  const Loading loading{Control::force, {{1, 2}, {3, 4}, {3, 0}, {6, -6}, {8, -6}}, false};
  EXPECT_NEAR(mean_load(loading, 1, 1), 0, 1e-15);
  EXPECT_NEAR(mean_load(loading, 3, 4), 6.0 / 4, 1e-15);
  EXPECT_NEAR(mean_load(loading, 5, 3), (3.5 - 4) / 3, 1e-14); // 3 to 4 over 1 s, 0 to -4 over 2 s
  EXPECT_NEAR(mean_load(loading, 9, 2), -6, 1e-14);
  EXPECT_NEAR(mean_load(loading, 20, 20), (6 - 9 - 12 - 72) / 20.0, 1e-13);
  EXPECT_EQ(last_jump(loading, 0.5), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(last_jump(loading, 2), 1);
  EXPECT_EQ(last_jump(loading, 3), 3);
  EXPECT_EQ(last_jump(loading, 100), 3);
}
