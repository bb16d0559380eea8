#include "dem/events.h"
#include "dem/linear.h"
#include "tests/dem/assemblies.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace dem;
using namespace event_runs;

namespace {

const RateLaw instantaneous{0.325, 0.005, 0, 0, 0};

double first_breakage_time(const Assembly& assembly, const Loading& loading, const RateLaw& law)
{
  const EventsModel model = make_events_model(assembly, loading, law, AfterBreakage::leave, never);
  EventsSolver solver(model);
  const EventsState state = run(solver);
  return state.breakages.empty() ? never : state.breakages.front().time;
}

double time_or_never(const std::string& text)
{
  return text == "never" ? never : reference::number(text);
}

Assembly random_block(std::uint64_t seed)
{
  Assembly assembly = assemblies::block(4, 6, BondLaw{laws::wide(), 11, 1}, seed);
  assembly.strengths = draw_strengths({WeibullStrength{1.5, 30}}, assembly.bonds.id, seed);
  return assembly;
}

} // namespace

TEST(Events, CreepOfOneBondBreaksAtTheTimesOfTheTable)
{
  for (const auto& row : reference::table("breakage_creep_rate_strength.csv")) {
    const double force = reference::number(row, "F"), expected = time_or_never(row.at("t_break"));
    const Assembly assembly = pair(laws::burgers_set("asphalt"), reference::number(row, "S0"));
    const double time = first_breakage_time(
        assembly, step_load(Loading::Control::force, force, 1e5), instantaneous);
    if (std::isinf(expected)) {
      EXPECT_EQ(time, never);
    } else {
      EXPECT_NEAR(time, expected, 1e-10 * std::max(1.0, expected));
    }
  }
}

TEST(Events, ConstantRateBreaksAtTheTimesOfTheTable)
{
  for (const auto& row : reference::table("breakage_constant_rate.csv")) {
    const Assembly assembly = pair(laws::burgers_set(row.at("set")), reference::number(row, "S"));
    const double rate = reference::number(row, "rate"),
                 expected = reference::number(row, "t_break");
    const double time = first_breakage_time(
        assembly, ramp(Loading::Control::displacement, rate, 1.1 * expected), constant_strength);
    EXPECT_NEAR(time, expected, 1e-9 * expected) << row.at("set");
  }
}

TEST(Events, BrittleToDuctileThresholdIsThatOfTheTable)
{
  for (const auto& row : reference::table("breakage_brittle_ductile.csv")) {
    const Assembly assembly = pair(laws::burgers_set("asphalt"), 54);
    const double rate = reference::number(row, "strain_rate") * assembly.gauge_length;
    const double expected = time_or_never(row.at("t_break"));
    const double time = first_breakage_time(
        assembly, ramp(Loading::Control::displacement, rate, 1e5), instantaneous);
    if (std::isinf(expected)) {
      EXPECT_EQ(time, never);
    } else {
      EXPECT_NEAR(time, expected, 1e-10 * expected);
    }
  }
}

TEST(Events, BundlesCascadeAtTheTimesOfTheTable)
{
  const auto table = reference::json("bundle_cascade.json");
  std::vector<double> strength;
  for (const auto& s : table.at("strengths"))
    strength.push_back(reference::number(s));
  const Assembly assembly = assemblies::bundle(strength, 4e-3, laws::burgers_set("asphalt"));
  for (const auto& [name, expected] : table.at("cases").items()) {
    const double force = reference::number(expected.at("F_total"));
    const EventsModel model =
        make_events_model(assembly, step_load(Loading::Control::force, force, 1e4), instantaneous,
                          AfterBreakage::leave, never);
    EventsSolver solver(model);
    const EventsState state = run(solver);
    const auto& events = expected.at("events");
    ASSERT_EQ(state.breakages.size(), events.size()) << name;
    for (std::size_t k = 0; k < events.size(); ++k) {
      EXPECT_EQ(state.breakages[k].bond, events[k].at("bond").get<Index>()) << name;
      const double time = reference::number(events[k].at("t"));
      EXPECT_NEAR(state.breakages[k].time, time, 1e-8 * std::max(1.0, time))
          << name << " event " << k;
    }
    EXPECT_EQ(state.end, expected.at("survivors").get<int>() == 0 ? RunEnd::lost_equilibrium
                                                                  : RunEnd::finished);
  }
}

TEST(Events, GoldenNetworkCreepsThroughItsThreeBreakages)
{
  const auto golden = reference::json("golden_network_27.json");
  Assembly assembly = assemblies::golden(golden, {BondLaw{laws::burgers_set("asphalt"), 11, 1}});
  assembly.strengths = Strengths{std::vector<double>(assembly.bonds.size(), 1e9),
                                 std::vector<double>(assembly.bonds.size(), 1e9), 0};
  const EventsModel model = make_events_model(assembly, step_load(Loading::Control::force, 1, 1e3),
                                              instantaneous, AfterBreakage::leave, never);
  const auto& breakage = golden.at("breakage");
  const Index particle = breakage.at("sample_particle").get<Index>();
  for (const bool with_breakage : {false, true}) {
    EventsSolver solver(model);
    EventsState state = solver.start();
    const auto& expected = breakage.at(with_breakage ? "u_with_break_after_event" : "u_no_break");
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const double time = breakage.at("sample_times")[k].get<double>();
      for (std::size_t e = 0; with_breakage && e < 3; ++e)
        if (breakage.at("times")[e].get<double>() == time) {
          const BondChange change{breakage.at("bonds")[e].get<Index>(), BondStatus::gone};
          state = solver.with_changes(std::move(state), time, {&change, 1});
        }
      const ParticleMotion found =
          motion(model.network, solver.displacements(state, time), particle);
      for (int c = 0; c < 3; ++c) {
        const double u = expected[k][c].get<double>(), r = expected[k][3 + c].get<double>();
        EXPECT_NEAR(found.displacement[c], u, 1e-10 * 1e-6) << "t = " << time;
        EXPECT_NEAR(found.rotation[c], r, 1e-10 * 1e-3) << "t = " << time;
      }
    }
  }
}

TEST(Events, EqualsTheLinearSolverWithoutBreakages)
{
  Assembly assembly = random_block(1);
  assembly.strengths.reset(); // none: unbreakable
  const LinearModel linear = make_linear_model(assembly);
  Loading history{Loading::Control::force,
                  {{0, -10}, {5, -10}, {5, -30}, {20, 15}, {40, 15}, {40, 0}, {100, 0}}};
  for (const Loading::Control control : {Loading::Control::force, Loading::Control::displacement}) {
    history.control = control;
    const EventsModel model =
        make_events_model(assembly, history, constant_strength, AfterBreakage::leave, never);
    EventsSolver solver(model);
    EventsState state = solver.start();
    const double largest = 50 * std::max(1.0, 100 * linear.compliance);
    for (const double time : {0.0, 1.0, 5.0, 7.0, 20.0, 33.0, 40.0, 41.0, 99.0}) {
      while (state.end == RunEnd::running && solver.next_change(state) <= time)
        state = solver.step(std::move(state));
      const Response found = solver.response(state, time);
      const LinearResponse expected = linear_response(linear, history, time);
      const double displacement = found.strain * assembly.gauge_length;
      EXPECT_NEAR(displacement, expected.displacement,
                  1e-12 * (linear.compliance * 100 + std::abs(expected.displacement)));
      EXPECT_NEAR(found.force, expected.force, 1e-12 * std::max(1e2, 100 / linear.compliance));
      const Eigen::VectorXd u = solver.displacements(state, time);
      const Eigen::VectorXd v = displacements(linear, history, time);
      EXPECT_LT((u - v).cwiseAbs().maxCoeff(), 1e-12 * largest);
    }
  }
}

TEST(Events, ConstantLoadAndStrengthsBreakBondsOnlyAtTheFirstInstant)
{
  const Assembly assembly = random_block(2);
  const EventsModel model =
      make_events_model(assembly, step_load(Loading::Control::force, -400, 1e5), constant_strength,
                        AfterBreakage::leave, never);
  EventsSolver solver(model);
  const EventsState state = run(solver);
  ASSERT_GT(state.breakages.size(), 3u);
  EXPECT_EQ(state.end, RunEnd::finished);
  for (const Breakage& breakage : state.breakages)
    EXPECT_EQ(breakage.time, 0);
}

TEST(Events, TiesBreakTogetherWhateverTheNumbering)
{
  const std::vector<double> strength{5, 5, 5, 5, 9, 20};
  for (const double force : {24.0, 31.0}) { // 4 per bond: none; above 5 per bond: four at once
    std::vector<double> order = strength;
    for (int turn = 0; turn < 6; ++turn) {
      std::rotate(order.begin(), order.begin() + 1, order.end());
      const Assembly assembly = assemblies::bundle(order, 4e-3, laws::burgers_set("asphalt"));
      const EventsModel model =
          make_events_model(assembly, step_load(Loading::Control::force, force, 10),
                            constant_strength, AfterBreakage::leave, never);
      EventsSolver solver(model);
      EventsState state = run(solver);
      if (force < 30) {
        EXPECT_TRUE(state.breakages.empty());
        continue;
      }
      ASSERT_GE(state.breakages.size(), 4u);
      for (int k = 0; k < 4; ++k) {
        EXPECT_EQ(order[state.breakages[k].bond], 5);
        EXPECT_EQ(state.breakages[k].pass, 0);
      }
      EXPECT_EQ(state.breakages[4].pass, 1); // 31 N on two bonds: the next one follows
    }
  }
}

TEST(Events, TheFutureDoesNotDependOnWhenItIsLookedAtOrRestarted)
{
  const Assembly assembly = random_block(6);
  RateLaw law = instantaneous;
  law.window = 0.5;
  law.window_fraction = 0.01;
  law.floor = 1e-7;
  const EventsModel model = make_events_model(
      assembly, step_load(Loading::Control::force, -400, 2e3), law, AfterBreakage::pressed, 0.1);
  EventsSolver solver(model);
  const EventsState straight = run(solver);
  ASSERT_GT(straight.breakages.size(), 10u);

  EventsState state = EventsSolver(model).start();
  for (int k = 0; state.end == RunEnd::running; ++k) { // a new solver at every third step
    EventsSolver other(model);
    other.resume(state);
    for (int j = 0; j < 3 && state.end == RunEnd::running; ++j) {
      other.response(state, start(state.history.segments.back()));
      state = other.step(std::move(state));
    }
  }
  ASSERT_EQ(state.breakages.size(), straight.breakages.size());
  for (std::size_t k = 0; k < state.breakages.size(); ++k) {
    EXPECT_EQ(state.breakages[k].bond, straight.breakages[k].bond);
    EXPECT_EQ(state.breakages[k].time, straight.breakages[k].time);
    EXPECT_EQ(state.breakages[k].strain, straight.breakages[k].strain);
  }
  EXPECT_EQ(state.viscous, straight.viscous);
  EXPECT_EQ(state.end, straight.end);
}

TEST(Events, SwappedEndsAndOtherUnitsBreakTheSameBondsAtTheSameTimes)
{
  const Assembly assembly = random_block(6);
  const Loading load = step_load(Loading::Control::force, -200, 500);
  const EventsModel model =
      make_events_model(assembly, load, instantaneous, AfterBreakage::leave, 0.1);
  EventsSolver solver(model);
  const EventsState straight = run(solver);
  ASSERT_GT(straight.breakages.size(), 5u);

  Assembly swapped = assembly;
  for (std::size_t b = 0; b < swapped.bonds.size(); b += 2) {
    std::swap(swapped.bonds.ends[b][0], swapped.bonds.ends[b][1]);
    swapped.bonds.contact_offset[b] *= -1;
  }
  // viscosities x 2^10 and rates / 2^10: the same at 2^10 times the time, to the last bit
  Assembly slower = assembly;
  slower.laws[0].creep = with_viscosities_scaled(slower.laws[0].creep, 1024);
  RateLaw slow_law = instantaneous;
  slow_law.reference_rate /= 1024;
  const EventsModel swapped_model =
      make_events_model(swapped, load, instantaneous, AfterBreakage::leave, 0.1);
  const EventsModel slow_model =
      make_events_model(slower, step_load(Loading::Control::force, -200, 500 * 1024), slow_law,
                        AfterBreakage::leave, 0.1);
  EventsSolver swapped_solver(swapped_model), slow_solver(slow_model);
  const EventsState a = run(swapped_solver), b = run(slow_solver);
  ASSERT_EQ(a.breakages.size(), straight.breakages.size());
  ASSERT_EQ(b.breakages.size(), straight.breakages.size());
  for (std::size_t k = 0; k < straight.breakages.size(); ++k) {
    EXPECT_EQ(a.breakages[k].bond, straight.breakages[k].bond);
    EXPECT_NEAR(a.breakages[k].time, straight.breakages[k].time,
                1e-8 * std::max(1.0, straight.breakages[k].time));
    EXPECT_EQ(b.breakages[k].bond, straight.breakages[k].bond);
    EXPECT_EQ(b.breakages[k].time, 1024 * straight.breakages[k].time);
    EXPECT_EQ(b.breakages[k].strain, straight.breakages[k].strain);
  }
}

TEST(Events, ShearBrokenPressedContactsCarryOnUntilTheyArePulled)
{
  const Assembly assembly = random_block(2);
  const Loading load = step_load(Loading::Control::force, -200, 500);
  long broken[2];
  double stiffness[2];
  for (const AfterBreakage after : {AfterBreakage::leave, AfterBreakage::pressed}) {
    const EventsModel model = make_events_model(assembly, load, instantaneous, after, 0.1);
    EventsSolver solver(model);
    const EventsState state = run(solver);
    const bool pressed = after == AfterBreakage::pressed;
    broken[pressed] = std::ssize(state.breakages);
    const Response last = solver.response(state, start(state.history.segments.back()));
    stiffness[pressed] = 1 / last.compliance;
    for (std::size_t b = 0; b < state.damage.status.size(); ++b)
      if (state.damage.status[b] == BondStatus::pressed) {
        EXPECT_LE(last.force * solver.network_solver().bond_forces()[b].normal, 1e-8 * 300);
      }
  }
  EXPECT_LE(broken[true], broken[false]);
  EXPECT_GT(stiffness[true], stiffness[false]);
}

TEST(Events, NonproportionalLawsAreRefused)
{
  Assembly assembly = assemblies::golden(
      reference::json("golden_network_mixed.json"),
      {BondLaw{laws::burgers_set("asphalt"), 11, 1}, BondLaw{laws::burgers_set("unit"), 11, 1}});
  assembly.strengths = Strengths{std::vector<double>(assembly.bonds.size(), 1),
                                 std::vector<double>(assembly.bonds.size(), 1), 0};
  EXPECT_THROW(make_events_model(assembly, step_load(Loading::Control::force, 1, 1), instantaneous,
                                 AfterBreakage::leave, never),
               std::invalid_argument);
  EXPECT_THROW(make_linear_model(assembly), std::invalid_argument);
}

TEST(Events, EmptyScenesEndCleanly)
{
  // no bonds; one particle; no load
  Assembly lonely = assemblies::bonded({{0, 0, 1}}, {1}, {Support::bottom}, {},
                                       BondLaw{laws::burgers_set("unit"), 11, 1});
  lonely.strengths = Strengths{};
  const EventsModel model = make_events_model(lonely, step_load(Loading::Control::force, -1, 10),
                                              instantaneous, AfterBreakage::leave, never);
  EventsSolver solver(model);
  EXPECT_EQ(run(solver).end, RunEnd::lost_equilibrium);

  const Assembly whole = pair(laws::burgers_set("unit"), 1);
  for (const double end : {0.0, 10.0}) {
    const EventsModel quiet = make_events_model(whole, step_load(Loading::Control::force, 0, end),
                                                instantaneous, AfterBreakage::leave, never);
    EventsSolver other(quiet);
    const EventsState state = run(other);
    EXPECT_EQ(state.end, RunEnd::finished);
    EXPECT_EQ(other.response(state, end).strain, 0);
    EXPECT_TRUE(state.breakages.empty());
  }
}

TEST(LoadHistory, BoundsOfTheAveragedRateHold)
{
  // A history with jumps, ramps and recovery; every rate in an interval lies within its bounds.
  const Assembly assembly = pair(laws::wide(), 1e9);
  const Loading loading{Loading::Control::force,
                        {{0, -10}, {5, -10}, {5, -30}, {20, 15}, {40, 15}, {40, 0}, {100, 0}}};
  for (const auto& [window, fraction] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {0.1, 0.2}}) {
    RateLaw law = instantaneous;
    law.window = window;
    law.window_fraction = fraction;
    const EventsModel model =
        make_events_model(assembly, loading, law, AfterBreakage::leave, never);
    EventsSolver solver(model);
    EventsState state = solver.start();
    while (state.end == RunEnd::running) {
      const double from = start(state.history.segments.back()), to = state.segment_end;
      for (const int parts : {1, 7, 50})
        for (int p = 0; p < parts; ++p) {
          const double a = from + (to - from) * p / parts,
                       b = from + (to - from) * (p + 0.999) / parts;
          const Range range = averaged_strain_rate_range(state.history, law, a, b);
          for (int k = 0; k <= 20; ++k) {
            const double rate = averaged_strain_rate(state.history, law, a + (b - a) * k / 20);
            EXPECT_GE(rate, range.low - 1e-12 * std::abs(range.low));
            EXPECT_LE(rate, range.high + 1e-12 * std::abs(range.high));
          }
        }
      state = solver.step(std::move(state));
    }
  }
}
