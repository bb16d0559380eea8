#include "tests/dem/assemblies.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace dem;
using namespace event_runs;

TEST(Events, TrueStressFollowsTheArea)
{
  // One bond without breakage: force = F0 / (1 + strain), solved in tiny steps for comparison.
  const double strength = 1e9, force = -100;
  const Assembly assembly = pair(laws::burgers_set("asphalt"), strength);
  Loading loading = step_load(Loading::Control::force, force, 300);
  loading.true_stress = true;
  const EventsModel model =
      make_events_model(assembly, loading, constant_strength, AfterBreakage::leave, never);
  EventsSolver solver(model);
  EventsState state = solver.start();
  while (state.end == RunEnd::running)
    state = solver.step(std::move(state));
  const Response last = solver.response(state, 300);
  EXPECT_NEAR(last.force, force / (1 + last.strain), 1e-9 * std::abs(force));
  EXPECT_LT(last.force, force); // compressed: wider, more force

  const CreepLaw law = laws::burgers_set("asphalt");
  CreepState<double> element = virgin_state(law);
  double f = force;
  for (int k = 0; k < 50; ++k)
    f = force / (1 + f / law.maxwell_stiffness / assembly.gauge_length);
  element.elastic = f / law.maxwell_stiffness;
  const int n = 30000;
  for (int k = 0; k < n; ++k) { // implicit in the area
    double next = f;
    for (int i = 0; i < 20; ++i)
      next = force / (1 + displacement(creep_step(law, element, (next - f) / law.maxwell_stiffness,
                                                  300.0 / n)) /
                              assembly.gauge_length);
    element = creep_step(law, element, (next - f) / law.maxwell_stiffness, 300.0 / n);
    f = next;
  }
  EXPECT_NEAR(last.strain, displacement(element) / assembly.gauge_length,
              1e-7 * std::abs(last.strain));
}

TEST(Events, TrueStressFollowsTheAreaOnRamps)
{
  const Assembly assembly = pair(laws::burgers_set("asphalt"), 1e9);
  Loading loading{Loading::Control::force, {{0, 0}, {1000, -100}}};
  loading.true_stress = true;
  const EventsModel model =
      make_events_model(assembly, loading, constant_strength, AfterBreakage::leave, never);
  EventsSolver solver(model);
  EventsState state = solver.start();
  for (const double time : {1.0, 250.0, 500.0, 750.0, 990.0}) {
    while (solver.next_change(state) <= time)
      state = solver.step(std::move(state));
    const Response now = solver.response(state, time);
    EXPECT_NEAR(now.force * (1 + now.strain), -0.1 * time, 1e-7 * 100) << "t = " << time;
  }
}

TEST(Events, PressedContactsOpenWhenTheLoadTurnsAtABreakpoint)
{
  // Sheared off under compression the contact stays pressed; pulled, it must let go at once.
  Assembly assembly = assemblies::bonded(
      {{0, 0, 0}, {0, 0.6, 0.8}, {0, -0.6, 0.8}, {0, 0, 1.6}}, {0.5, 0.5, 0.5, 0.5},
      {Support::bottom, Support::free, Support::free, Support::top},
      {{0, 1}, {0, 2}, {1, 3}, {2, 3}, {1, 2}}, BondLaw{laws::burgers_set("asphalt"), 11, 1});
  assembly.strengths = Strengths{std::vector<double>(5, 1e9), {1, 1e9, 1e9, 1e9, 1e9}, 0};
  assembly.gauge_length = 1.6;
  for (const double halfway : {20.0, 19.0}) { // through 0 at a breakpoint, and inside a slope
    Loading loading{
        Loading::Control::force,
        {{0, 0}, {10, -100}, {halfway, halfway == 20 ? 0.0 : -10.0}, {30, 100}, {40, 0}}};
    const EventsModel model =
        make_events_model(assembly, loading, constant_strength, AfterBreakage::pressed, never);
    EventsSolver solver(model);
    EventsState state = solver.start();
    while (solver.next_change(state) <= 15)
      state = solver.step(std::move(state));
    EXPECT_EQ(state.damage.status[0], BondStatus::pressed);
    while (solver.next_change(state) <= 21)
      state = solver.step(std::move(state));
    EXPECT_EQ(state.damage.status[0], BondStatus::gone);
    EXPECT_EQ(state.n_opened, 1);
  }
}

TEST(Events, EndsAtAnyStrainLimitWhateverItsLastDigits)
{
  const Assembly assembly = event_runs::pair(laws::burgers_set("asphalt"), 1e9);
  const Loading loading = step_load(Loading::Control::force, -10, 1000);
  const EventsModel whole = make_events_model(assembly, loading, event_runs::constant_strength,
                                              AfterBreakage::pressed, event_runs::never);
  EventsSolver endless(whole);
  const EventsState full = event_runs::run(endless);
  const double first = std::abs(endless.response(full, 0).strain);
  const double last = std::abs(endless.response(full, 1000).strain);
  for (int k = 1; k < 400; ++k) {
    const EventsModel model =
        make_events_model(assembly, loading, event_runs::constant_strength, AfterBreakage::pressed,
                          first + (last - first) * k / 400.0);
    EventsSolver solver(model);
    EventsState state = solver.start();
    for (int n = 0; n < 50 && state.end == RunEnd::running; ++n)
      state = solver.step(std::move(state));
    ASSERT_EQ(state.end, RunEnd::strain_limit) << k;
  }
}

TEST(Events, EndsAtTheStrainLimit)
{
  const Assembly assembly = pair(laws::burgers_set("asphalt"), 1e9);
  const Loading loading = step_load(Loading::Control::force, -10, 1e5);
  const double limit = 0.01;
  const EventsModel model =
      make_events_model(assembly, loading, constant_strength, AfterBreakage::leave, limit);
  EventsSolver solver(model);
  const EventsState state = run(solver);
  EXPECT_EQ(state.end, RunEnd::strain_limit);
  const double time = start(state.history.segments.back());
  EXPECT_NEAR(strain(state.history, time), -limit, 1e-12);
  EXPECT_NEAR(10 * creep_compliance(laws::burgers_set("asphalt"), time) / 4e-3, limit, 1e-12);
}
