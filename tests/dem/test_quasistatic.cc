#include "dem/events.h"
#include "dem/hdf5_file.h"
#include "dem/quasistatic.h"
#include "dem/storage.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

using namespace dem;
using event_runs::constant_strength;
using event_runs::never;

namespace {

/// As exact as the event solver: its geometry, one breakage after the other.
QuasistaticSettings exact()
{
  QuasistaticSettings settings;
  settings.geometry = Geometry::small;
  settings.residual_tolerance = 1e-12;
  settings.breakage_batch = 1;
  settings.after_breakage = AfterBreakage::leave;
  return settings;
}

QuasistaticState run(const QuasistaticModel& model, int n_threads = 1)
{
  QuasistaticSolver solver(model, n_threads);
  QuasistaticState state = start(model);
  while (state.end == RunEnd::running)
    state = solver.step(std::move(state));
  return state;
}

double strain_at_end(const QuasistaticModel& model, const QuasistaticState& state)
{
  return state.path.back().displacement / model.assembly.gauge_length;
}

const BondLaw asphalt_law{laws::burgers_set("asphalt"), 11, 1};

/// A weak random block of which some bonds break at once and more later.
Assembly weak_block(std::uint64_t seed)
{
  Assembly assembly = assemblies::block(4, 5, asphalt_law, 3);
  assembly.pair_laws = {assemblies::one_law};
  assembly.strengths =
      draw_strengths({NormalStrength{54, 20}, NonpositiveRule::clamp, 1}, assembly.bonds.id, seed);
  return assembly;
}

const RateLaw rate_law{0.325, 0.005, 1, 0.01, 1e-7};

} // namespace

TEST(Quasistatic, EqualsTheEventSolverWhileItsAssumptionsHold)
{
  for (const auto control : {Loading::Control::force, Loading::Control::displacement}) {
    const Assembly assembly = weak_block(5);
    const bool by_force = control == Loading::Control::force;
    const Loading pulled = by_force ? step_load(control, -2000.0, 200)
                                    : ramp(control, -5e-3 * assembly.gauge_length, 10);
    const EventsModel events =
        make_events_model(assembly, pulled, rate_law, AfterBreakage::leave, never);
    EventsSolver solver(events);
    const EventsState expected = event_runs::run(solver);
    ASSERT_GT(expected.breakages.size(), 2u);
    const QuasistaticModel model =
        make_quasistatic_model(assembly, pulled, rate_law, exact(), never);
    const QuasistaticState found = run(model);
    ASSERT_EQ(found.breakages.size(), expected.breakages.size());
    for (std::size_t k = 0; k < expected.breakages.size(); ++k) {
      EXPECT_EQ(found.breakages[k].bond, expected.breakages[k].bond) << k;
      EXPECT_NEAR(found.breakages[k].time, expected.breakages[k].time,
                  1e-6 * expected.breakages[k].time);
    }
    const double end = end_time(pulled);
    const double strain = expected.end == RunEnd::finished ? solver.response(expected, end).strain
                                                           : strain_at_end(model, found);
    EXPECT_NEAR(strain_at_end(model, found), strain, 1e-8 * std::abs(strain));
  }
}

TEST(Quasistatic, SmallLoadsOnFiniteGeometryGiveTheSame)
{
  // The change of geometry is of the order of the strain: at 1e-9 nothing is left of it.
  Assembly assembly = weak_block(5);
  const double small = 1e-7;
  for (double* strength : {assembly.strengths->normal.data(), assembly.strengths->shear.data()})
    for (std::size_t b = 0; b < assembly.bonds.size(); ++b)
      strength[b] *= small;
  const RateLaw scaled{0.325, 0.005 * small, 1, 0.01, 1e-7 * small};
  const Loading loading = step_load(Loading::Control::force, -1000.0 * small, 200);
  const EventsModel events =
      make_events_model(assembly, loading, scaled, AfterBreakage::leave, never);
  EventsSolver solver(events);
  const EventsState expected = event_runs::run(solver);
  QuasistaticSettings settings = exact();
  settings.geometry = Geometry::finite;
  settings.residual_tolerance = 1e-11;
  settings.friction = 0;
  settings.strain_per_step *= small;
  settings.error_tolerance = 1e-4;
  const QuasistaticModel model = make_quasistatic_model(assembly, loading, scaled, settings, never);
  const QuasistaticState found = run(model);
  ASSERT_EQ(found.breakages.size(), expected.breakages.size());
  const double strain = solver.response(expected, 200).strain;
  EXPECT_NEAR(strain_at_end(model, found), strain, 1e-8 * std::abs(strain));
}

TEST(Quasistatic, MixedNetworkConvergesWithSecondOrder)
{
  const auto golden = reference::json("golden_network_mixed.json");
  const auto set = [&](const char* name) {
    const auto& c = golden.at(name);
    return BondLaw{burgers(c[0], c[1], c[2], c[3]), 11, 1};
  };
  Assembly assembly = assemblies::golden(golden, {set("burgers_A"), set("burgers_B")});
  assembly.pair_laws = {assemblies::one_law};
  const Loading loading = step_load(Loading::Control::force, 1, 30);
  const char* names[] = {"p7_ux", "p7_uy", "p7_uz", "p7_rx", "p7_ry", "p7_rz"};
  for (const StepScheme scheme : {StepScheme::force_linear, StepScheme::displacement_linear}) {
    std::vector<double> error;
    for (const int n : {16, 32, 64}) {
      QuasistaticSettings settings = exact();
      settings.strain_per_step = settings.error_tolerance = 1e9;
      QuasistaticModel model =
          make_quasistatic_model(assembly, loading, constant_strength, settings, never);
      model.scheme = scheme;
      QuasistaticSolver solver(model, 1);
      QuasistaticState state = start(model);
      state = solver.step(std::move(state)); // the elastic jump
      while (state.end == RunEnd::running) {
        state.next_step = 30.0 / n;
        state = solver.step(std::move(state));
      }
      EXPECT_EQ(state.n_steps, n);
      double worst = 0;
      for (const auto& row : reference::table("golden_network_mixed.csv"))
        if (reference::number(row, "t") == 30) {
          const BodyMotion found = motion(model, state, 7);
          for (int k = 0; k < 6; ++k) {
            const double expected = reference::number(row, names[k]);
            const double value = k < 3 ? found.displacement[k] : found.rotation[k - 3];
            worst = std::max(worst, std::abs(value - expected) / (k < 3 ? 7.4e-7 : 2.8e-4));
          }
        }
      error.push_back(worst);
    }
    EXPECT_LT(error[2], 2e-4);
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.15);
  }
}

TEST(Quasistatic, ThreadsAndInterruptionsChangeNothing)
{
  const Assembly assembly = weak_block(9);
  QuasistaticSettings settings;
  settings.breakage_batch = 4;
  const QuasistaticModel model = make_quasistatic_model(
      assembly, step_load(Loading::Control::force, -2000.0, 100), rate_law, settings, 0.05);
  const QuasistaticState whole = run(model);
  ASSERT_GT(whole.breakages.size(), 4u);
  EXPECT_EQ(run(model, 2).path.back().displacement, whole.path.back().displacement);

  // Stored and read in the middle of an avalanche, and once more while nothing breaks.
  QuasistaticSolver solver(model, 1);
  QuasistaticState state = start(model);
  while (!(state.pass > 1 && !state.settled))
    state = solver.step(std::move(state));
  const auto file = std::filesystem::temp_directory_path() / "mastic-quasistatic.h5";
  for (int times = 0; times < 2; ++times) {
    Hdf5File out = Hdf5File::create(file);
    write_state(out, "state", state);
    out.publish();
    state = read_quasistatic_state(Hdf5File::open(file), "state", model);
    QuasistaticSolver fresh(model, 1);
    fresh.resume(state);
    for (int steps = 0; steps < 5 && state.end == RunEnd::running; ++steps)
      state = fresh.step(std::move(state));
  }
  QuasistaticSolver last(model, 1);
  last.resume(state);
  while (state.end == RunEnd::running)
    state = last.step(std::move(state));
  std::filesystem::remove(file);
  EXPECT_EQ(state.path.back().displacement, whole.path.back().displacement);
  EXPECT_EQ(state.path.back().time, whole.path.back().time);
  EXPECT_EQ(state.breakages.size(), whole.breakages.size());
}

TEST(Quasistatic, SwappedEndsAndNewNumbersChangeNothing)
{
  const Assembly assembly = weak_block(9);
  QuasistaticSettings settings;
  settings.breakage_batch = 1;
  settings.residual_tolerance = 1e-10;
  const Loading loading = step_load(Loading::Control::force, -2000.0, 30);
  const auto end_of = [&](const Assembly& each) {
    const QuasistaticModel model = make_quasistatic_model(each, loading, rate_law, settings, 0.05);
    const QuasistaticState state = run(model);
    return std::pair(strain_at_end(model, state), state.breakages.size());
  };
  const auto expected = end_of(assembly);
  Assembly swapped = assembly;
  for (std::size_t b = 0; b < swapped.bonds.size(); ++b) {
    std::swap(swapped.bonds.ends[b][0], swapped.bonds.ends[b][1]);
    swapped.bonds.contact_offset[b] *= -1;
  }
  Assembly renumbered = assembly;
  const auto n = Index(assembly.particles.size());
  for (Index i = 0; i < n; ++i) {
    renumbered.particles.centre[n - 1 - i] = assembly.particles.centre[i];
    renumbered.particles.radius[n - 1 - i] = assembly.particles.radius[i];
    renumbered.support[n - 1 - i] = assembly.support[i];
  }
  for (auto& [a, b] : renumbered.bonds.ends) {
    a = n - 1 - a;
    b = n - 1 - b;
  }
  for (const Assembly& other : {swapped, renumbered}) {
    const auto found = end_of(other);
    EXPECT_EQ(found.second, expected.second);
    EXPECT_NEAR(found.first, expected.first, 1e-7 * std::abs(expected.first));
  }
}

TEST(Quasistatic, RotatedSceneGivesTheRotatedAnswer)
{
  // A cluster on particle loads, with displacements that are not small.
  const auto golden = reference::json("golden_network_27.json");
  const auto assembly_turned = [&](const Mat3& turn) {
    Assembly assembly = assemblies::golden(golden, {asphalt_law});
    assembly.pair_laws = {assemblies::one_law};
    for (Vec3& x : assembly.particles.centre)
      x = turn * x;
    for (ParticleLoad& load : assembly.loads) {
      load.force = turn * load.force;
      load.moment = turn * load.moment;
    }
    return assembly;
  };
  const auto moved = [&](const Mat3& turn) {
    QuasistaticSettings settings;
    settings.residual_tolerance = 1e-11;
    const QuasistaticModel model =
        make_quasistatic_model(assembly_turned(turn), step_load(Loading::Control::force, 300, 20),
                               constant_strength, settings, never);
    const QuasistaticState state = run(model);
    std::vector<Vec3> result;
    for (Index i = 0; i < Index(model.assembly.particles.size()); ++i)
      result.push_back(motion(model, state, i).displacement);
    return result;
  };
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const std::vector<Vec3> straight = moved(Mat3::Identity()), turned = moved(turn);
  double size = 0, error = 0;
  for (std::size_t i = 0; i < straight.size(); ++i) {
    size = std::max(size, straight[i].norm());
    error = std::max(error, (turn * straight[i] - turned[i]).norm());
  }
  EXPECT_GT(size, 1e-4); // of spheres of some millimetres
  EXPECT_LT(error, 1e-8 * size);
}

TEST(Quasistatic, EnergyAddsUpAndHardlyAnyGoesIntoTheRegularisation)
{
  const Assembly assembly = weak_block(9);
  const auto gap = [&](double factor) {
    QuasistaticSettings settings;
    settings.strain_per_step *= factor;
    settings.error_tolerance *= factor * factor;
    const QuasistaticModel model = make_quasistatic_model(
        assembly, step_load(Loading::Control::force, -2000.0, 100), rate_law, settings, 0.05);
    const EnergyLedger energy = run(model).path.back().energy;
    EXPECT_LT(energy.regularisation, 1e-3 * energy.work);
    EXPECT_GT(energy.dashpots, 0.3 * energy.work);
    EXPECT_GE(energy.friction, 0);
    EXPECT_GE(energy.breakage, 0);
    return std::abs(energy.gap()) / energy.work;
  };
  EXPECT_LT(gap(1), 5e-3);
}

TEST(Quasistatic, TemperatureStretchesTime)
{
  // With all viscosities divided by four the same strain comes in a quarter of the time.
  Assembly assembly = assemblies::block(3, 3, asphalt_law, 1);
  assembly.pair_laws = {assemblies::one_law};
  const WlfShift shift{19, 92, 293.15};
  const double warm = 293.15 + 92 * std::log10(4.0) / (19 - std::log10(4.0));
  const std::vector<TemperaturePoint> history{{0, warm}, {1000, warm}};
  const auto strain_after = [&](double time, std::optional<ReducedTime> clock) {
    const QuasistaticModel model =
        make_quasistatic_model(assembly, step_load(Loading::Control::force, -1.0, time),
                               constant_strength, exact(), never, std::move(clock));
    return strain_at_end(model, run(model));
  };
  EXPECT_NEAR(strain_after(50, make_reduced_time(history, shift)), strain_after(200, {}), 1e-12);
}

TEST(Quasistatic, PressedSpheresObeyCoulomb)
{
  // A free sphere on a glued one under its own load; a tangential force slides it if it is too big.
  const auto slid = [](double tangential) {
    Assembly assembly = assemblies::bonded(
        {Vec3(0, 0, 0), Vec3(0, 0, 4e-3), Vec3(0, 0, 8e-3)}, {2e-3, 2e-3, 2e-3},
        {Support::bottom, Support::free, Support::bottom}, {{0, 1}}, asphalt_law);
    assembly.pair_laws = {assemblies::one_law};
    assembly.strengths = Strengths{{0}, {0}, 1};
    assembly.loads = {{1, Vec3(0, 0, -10), Vec3::Zero()},
                      {1, Vec3(tangential, 0, 0), Vec3::Zero()}};
    QuasistaticSettings settings;
    settings.friction = 0.5;
    Loading loading = ramp(Loading::Control::force, 1, 1);
    const QuasistaticModel model =
        make_quasistatic_model(assembly, loading, constant_strength, settings, 0.5);
    const QuasistaticState state = run(model);
    return state.path.back().energy.friction;
  };
  EXPECT_EQ(slid(0), 0);
  EXPECT_GT(slid(9), 0);
}
