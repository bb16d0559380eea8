#include "dem/critical_step.h"
#include "dem/dynamics.h"
#include "dem/events.h"
#include "dem/linear.h"
#include "tests/dem/assemblies.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace dem;

namespace {

constexpr double never = std::numeric_limits<double>::infinity();
const RateLaw constant_strength{0, 0.005, 0, 0, 0};

DynamicSettings undamped()
{
  DynamicSettings settings;
  settings.damping = 0;
  settings.ramp_periods = 0;
  settings.smallest_window = 0;
  return settings;
}

DynamicState run_until(const DynamicModel& model, DynamicState state, double real, int threads = 1)
{
  const auto steps = std::lround(real * model.settings.viscosity_scaling / model.time_step);
  return advance(model, std::move(state), steps - state.n_steps, threads);
}

} // namespace

TEST(Dynamics, OscillatorOnABurgersBondConvergesWithSecondOrder)
{
  // R = 2 mm, density 2600, step force of 1 N along the bond
  for (const auto& row : reference::table("oscillator_burgers.csv")) {
    const double t = reference::number(row, "t"), exact = reference::number(row, "u");
    const double cycles = reference::number(row, "t_over_T0");
    if (cycles > 3)
      continue;
    const CreepLaw law =
        row.at("set") == "viscous" ? burgers(1e6, 2e2, 5e5, 50) : laws::burgers_set("asphalt");
    Assembly assembly =
        assemblies::bonded({{0, 0, 0}, {0, 0, 4e-3}}, {2e-3, 2e-3},
                           {Support::bottom, Support::free}, {{0, 1}}, BondLaw{law, 11, 1});
    assembly.pair_laws = {{0, 0, 0}};
    assembly.particles.density = 2600;
    assembly.loads = {{1, Vec3(0, 0, 1), Vec3::Zero()}};
    std::vector<double> error;
    for (const int n : {200, 400, 800}) {
      const DynamicModel model =
          make_dynamic_model(assembly, step_load(Loading::Control::force, 1, 1), constant_strength,
                             undamped(), never, t / n);
      DynamicState state = start(model);
      // leap-frog starts half a step back: give it the velocity of the first half step
      state.velocity[6 + 2] = -0.5 * model.time_step * model.inverse_mass[1];
      state = advance(model, std::move(state), n, 1);
      error.push_back(std::abs(motion(model, state, 1).displacement.z() - exact));
    }
    EXPECT_LT(error[0], 1e-3 * 2e-6) << row.at("set") << " t " << t;
    for (int k = 0; k < 2; ++k)
      if (error[k + 1] > 1e-14) { // where the error of second order vanishes, the fourth shows
        const double order = std::log2(error[k] / error[k + 1]);
        EXPECT_NEAR(order, order < 3 ? 2 : 4, 0.15) << row.at("set") << " t " << t;
      }
  }
}

TEST(Dynamics, SettlesOnTheElasticSolutionOfTheGoldenNetwork)
{
  const auto golden = reference::json("golden_network_27.json");
  Assembly assembly = assemblies::golden(
      golden, {BondLaw{make_creep_law(1e8, std::nullopt, {}), 11, 1}}); // displacements of 1e-8 m
  assembly.pair_laws = {{0, 0, 0}};
  DynamicSettings settings = undamped();
  settings.damping = 0.7;
  const DynamicModel model = make_dynamic_model(assembly, step_load(Loading::Control::force, 1, 10),
                                                constant_strength, settings, never);
  const DynamicState state = advance(model, start(model), 20000, 1);
  double scale = 0, worst = 0;
  for (Index i = 0; i < 27; ++i)
    for (int k = 0; k < 3; ++k) {
      const double expected = golden["U_unit"][i][k].get<double>() / 1e8;
      scale = std::max(scale, std::abs(expected));
      worst = std::max(worst, std::abs(motion(model, state, i).displacement[k] - expected));
    }
  EXPECT_LT(worst, 1e-4 * scale); // finite motions differ from small ones by 1e-5
}

TEST(Dynamics, CreepOfTheMixedNetworkMatchesTheTable)
{
  const auto golden = reference::json("golden_network_mixed.json");
  const auto set = [&](const char* name) {
    const auto& c = golden.at(name);
    return BondLaw{burgers(c[0], c[1], c[2], c[3]), 11, 1};
  };
  Assembly assembly = assemblies::golden(golden, {set("burgers_A"), set("burgers_B")});
  assembly.pair_laws = {{0, 0, 0}};
  DynamicSettings settings = undamped();
  settings.damping = 0.5;
  settings.viscosity_scaling = 1e-3; // 300 s in 0.3 s
  settings.step_safety = 0.5;
  const double small = 1e-3; // of the load: small displacements
  const DynamicModel model = make_dynamic_model(
      assembly, step_load(Loading::Control::force, small, 1e3), constant_strength, settings, never);
  DynamicState state = start(model);
  for (const auto& row : reference::table("golden_network_mixed.csv")) {
    const double t = reference::number(row, "t");
    if (t < 30 || t > 300) // earlier, inertia shows
      continue;
    state = run_until(model, std::move(state), t);
    const Motion found = motion(model, state, 7);
    const char* names[] = {"p7_ux", "p7_uy", "p7_uz", "p7_rx", "p7_ry", "p7_rz"};
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(found.displacement[k] / small, reference::number(row, names[k]), 1e-3 * 1e-6)
          << t;
      EXPECT_NEAR(found.rotation[k] / small, reference::number(row, names[3 + k]), 1e-3 * 3e-4)
          << t;
    }
  }
}

TEST(Dynamics, ApproachesTheEventSolverAsScalingAndStepShrink)
{
  // A bundle at constant rate: the breakage times of the event solver are the limit.
  const std::vector<double> strength{2, 3, 4};
  Assembly assembly = assemblies::bundle(strength, 4e-3, laws::burgers_set("asphalt"));
  assembly.pair_laws = {{0, 0, 0}};
  const double rate = 1e-7; // m/s
  const Loading loading = ramp(Loading::Control::displacement, rate, 200);
  const EventsModel exact_model =
      make_events_model(assembly, loading, constant_strength, AfterBreakage::leave, never);
  EventsSolver solver(exact_model);
  EventsState exact = solver.start();
  while (exact.end == RunEnd::running)
    exact = solver.step(std::move(exact));
  ASSERT_EQ(exact.breakages.size(), 3u);
  std::vector<double> error;
  for (const int n : {2000, 4000, 8000}) {
    DynamicSettings settings = undamped();
    settings.after_breakage = AfterBreakage::leave;
    const DynamicModel model =
        make_dynamic_model(assembly, loading, constant_strength, settings, never, 200.0 / n);
    const DynamicState state = advance(model, start(model), n, 1);
    ASSERT_EQ(state.breakages.size(), 3u);
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(state.breakages[k].bond, exact.breakages[k].bond);
      worst = std::max(worst, std::abs(state.breakages[k].time - exact.breakages[k].time));
    }
    error.push_back(worst);
    EXPECT_LE(worst, 1.001 * 200.0 / n); // no more than one step late
  }
}

TEST(Dynamics, ViscosityScalingErrorVanishesWithTheScaling)
{
  // Creep of a small block under the platen: inertia disturbs it the less, the slower it runs.
  const Assembly assembly = [] {
    Assembly a = assemblies::block(3, 5, BondLaw{laws::burgers_set("asphalt"), 11, 1}, 9);
    a.pair_laws = {{0, 0, 0}};
    return a;
  }();
  const LinearModel linear = make_linear_model(assembly);
  const Loading loading = step_load(Loading::Control::force, -0.01, 100);
  const double t = 20, exact = linear_response(linear, loading, t).displacement;
  std::vector<double> error;
  for (const double x : {1e-4, 4e-4, 1.6e-3}) {
    DynamicSettings settings;
    settings.viscosity_scaling = x;
    const DynamicModel model =
        make_dynamic_model(assembly, loading, constant_strength, settings, never);
    const DynamicState state = run_until(model, start(model), t);
    error.push_back(std::abs(state.displacement / exact - 1));
  }
  EXPECT_LT(error[0], 0.2);
  EXPECT_NEAR(std::log(error[0] / error[1]) / std::log(4.0), 1,
              0.35); // first order in 1/x: the ramp
  EXPECT_NEAR(std::log(error[1] / error[2]) / std::log(4.0), 1, 0.35);
}

TEST(Dynamics, PowersOfTwoInTimeAreExactToTheLastBit)
{
  const double x = 1024;
  Assembly assembly = assemblies::block(3, 4, BondLaw{laws::burgers_set("asphalt"), 11, 1}, 9);
  assembly.pair_laws = {{0, 0, 0}};
  assembly.strengths = draw_strengths({WeibullStrength{1.5, 3}}, assembly.bonds.id, 1);
  Assembly slow = assembly;
  slow.laws[0].creep = with_viscosities_scaled(slow.laws[0].creep, x);
  slow.particles.density *= x * x;
  const RateLaw law{0.325, 0.005, 1e-3, 0, 1e-7}, slow_law{0.325, 0.005 / x, 1e-3 * x, 0, 1e-7 / x};
  const double dt = 0x1p-19;
  const DynamicModel model =
      make_dynamic_model(assembly, step_load(Loading::Control::force, -30, 1), law, {}, never, dt);
  const DynamicModel slow_model = make_dynamic_model(
      slow, step_load(Loading::Control::force, -30, x), slow_law, {}, never, x * dt);
  const DynamicState a = advance(model, start(model), 20000, 1);
  const DynamicState b = advance(slow_model, start(slow_model), 20000, 1);
  ASSERT_GT(a.breakages.size(), 0u);
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.forces, b.forces);
  ASSERT_EQ(a.breakages.size(), b.breakages.size());
  for (std::size_t k = 0; k < a.breakages.size(); ++k) {
    EXPECT_EQ(a.breakages[k].bond, b.breakages[k].bond);
    EXPECT_EQ(a.breakages[k].time * x, b.breakages[k].time);
  }
}

TEST(Dynamics, ThreadsAndInterruptionsChangeNothing)
{
  Assembly assembly = assemblies::block(8, 14, BondLaw{laws::burgers_set("asphalt"), 11, 1}, 2);
  assembly.pair_laws = {{0, 0, 0}};
  assembly.strengths = draw_strengths({WeibullStrength{1.5, 3}}, assembly.bonds.id, 1);
  DynamicSettings settings;
  settings.viscosity_scaling = 1e-3;
  const DynamicModel model =
      make_dynamic_model(assembly, step_load(Loading::Control::force, -300, 100),
                         {0.325, 0.005, 0.5, 0, 1e-7}, settings, never);
  ASSERT_GT(start(model).bonds.chunks.size(), 1u);
  const DynamicState one = advance(model, start(model), 4000, 1);
  const DynamicState two = advance(model, start(model), 4000, 2);
  ASSERT_GT(one.breakages.size(), 5u);
  EXPECT_EQ(one.motions, two.motions);
  EXPECT_EQ(one.bonds.fields, two.bonds.fields);
  DynamicState parts = start(model);
  for (const long n : {1L, 700L, 64L, 3235L})
    parts = advance(model, parts, n, 1);
  EXPECT_EQ(parts.motions, one.motions);
  EXPECT_EQ(parts.bonds.fields, one.bonds.fields);
  EXPECT_EQ(parts.breakages.size(), one.breakages.size());
}

TEST(Dynamics, InstabilityIsFoundAndNamed)
{
  Assembly assembly = assemblies::block(3, 5, BondLaw{laws::burgers_set("asphalt"), 11, 1}, 4);
  assembly.pair_laws = {{0, 0, 0}};
  const Loading loading = step_load(Loading::Control::force, -10, 10);
  const ElasticNetwork network = make_network(assembly);
  const double critical = 2 / largest_frequency(network, assembly.particles.density);
  const DynamicModel stable =
      make_dynamic_model(assembly, loading, constant_strength, undamped(), never, 0.9 * critical);
  const DynamicState state = advance(stable, start(stable), 2000, 1);
  EXPECT_LT(std::abs(state.displacement), 1e-3);
  const DynamicModel unstable =
      make_dynamic_model(assembly, loading, constant_strength, undamped(), never, 1.1 * critical);
  try {
    advance(unstable, start(unstable), 128, 1);
    FAIL() << "no growth found";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("unstable: particle "), std::string::npos);
  }
}

TEST(Dynamics, LoadsOnParticlesMoveAsInTheLinearSolver)
{
  // A creeping chain, pushed sideways and twisted at its tip; the strengths see its rate.
  const double d = 4e-3;
  std::vector<Vec3> centre;
  std::vector<std::array<Index, 2>> pairs;
  for (Index k = 0; k < 4; ++k) {
    centre.emplace_back(0, 0, d * k);
    if (k > 0)
      pairs.push_back({k - 1, k});
  }
  std::vector<Support> support(4, Support::free);
  support[0] = Support::bottom;
  Assembly assembly = assemblies::bonded(centre, std::vector<double>(4, d / 2), support, pairs,
                                         BondLaw{laws::burgers_set("asphalt"), 11, 1});
  assembly.loads = {{3, Vec3(0.01, 0, 0), Vec3(0, 0, 1e-5)}};
  const Loading loading = step_load(Loading::Control::force, 1, 10);
  DynamicSettings settings;
  settings.viscosity_scaling = 1e-1;
  settings.ramp_periods = 0;
  const DynamicModel model =
      make_dynamic_model(assembly, loading, constant_strength, settings, never);
  const DynamicState state = run_until(model, start(model), 10);
  const double expected = linear_response(make_linear_model(assembly), loading, 10).displacement;
  EXPECT_NEAR(state.displacement / expected, 1, 1e-4) << state.n_steps;
  EXPECT_GT(response(model, state).strain_rate, 0);
}

TEST(Dynamics, FastDashpotsDoNotLimitTheStep)
{
  Assembly assembly = assemblies::block(3, 5, BondLaw{burgers(1e6, 1e-6, 1e6, 1e-7), 11, 1}, 4);
  assembly.pair_laws = {{0, 0, 0}};
  const DynamicModel model = make_dynamic_model(
      assembly, ramp(Loading::Control::displacement, -1e-3, 1), constant_strength, {}, never);
  EXPECT_GT(model.time_step, 1e6 * 1e-13); // a million retardation times
  const DynamicState state = advance(model, start(model), 3000, 1);
  EXPECT_TRUE(std::isfinite(state.force_on_upper));
  EXPECT_LT(std::abs(state.displacement), 1e-4);
}

TEST(DynamicContacts, PressedSpheresObeyCoulombAndNeverPull)
{
  const double r = 1e-3, k = 1e6, friction = 0.4, overlap = 1e-6;
  const std::vector<BondLaw> laws{{make_creep_law(k, std::nullopt, {}), 2, 1}};
  const std::vector<StepFactors> factors{step_factors(laws[0].creep, 1e-3, 1)};
  const std::vector<double> radius{r, r};
  const std::vector<Support> support(2, Support::free);
  const std::vector<int> material(2, 0);
  AlignedDoubles motions(2 * motion_stride, 0.0), forces(2 * force_stride, 0.0);
  const ContactSurroundings around{motions, radius, support, material, false, 0, 0};
  const auto place = [&](double x, double gap) {
    motions[motion_stride] = x;
    motions[motion_stride + 2] = 2 * r + gap;
  };
  place(0, 1e-5);
  DynamicContacts contacts =
      find_contacts({{}, {}, 1e-4}, around, {}, {&assemblies::one_law, 1}, 1);
  ASSERT_EQ(contacts.contacts.size(), 1u);
  double upper = 0, lower = 0;
  const auto step = [&] {
    std::ranges::fill(forces, 0.0);
    advance_contacts(contacts, around, laws, factors, friction, forces.data(), upper, lower);
    return Vec3(forces[motion_stride], forces[motion_stride + 1], forces[motion_stride + 2]);
  };
  EXPECT_EQ(step(), Vec3(0, 0, 0)); // not yet touching
  place(0, -overlap);
  EXPECT_NEAR(step().z(), k * overlap, 1e-9 * k * overlap);
  for (int n = 1; n <= 100; ++n) { // slide by one overlap
    const double x = overlap * n / 100;
    place(x, -overlap - 0.25 * x * x / r); // the same distance
    const Vec3 force = step();
    EXPECT_NEAR(force.z(), k * overlap, 1e-3 * k * overlap); // the normal turns a little
    EXPECT_NEAR(force.x(), -std::min(k / 2 * x, friction * k * overlap),
                1e-2 * friction * k * overlap);
  }
  place(overlap, 1e-9);
  EXPECT_EQ(step(), Vec3(0, 0, 0)); // apart: no pull
  EXPECT_FALSE(contacts.contacts[0].closed);
  EXPECT_EQ(contacts.contacts[0].normal[0], 0);
  place(overlap, -overlap);
  EXPECT_NEAR(step().z(), k * overlap, 2e-3 * k * overlap); // closes again where it opened
}

TEST(DynamicContacts, BrokenBondsLeaveContactsAsAsked)
{
  // Shear of a pressed bond: forces stay up to Coulomb's limit, moments end.
  DynamicBond bond{4, 2, 7, 0, Vec3(0, 0, 1), Vec3(1, 0, 0), 2e-3, {}, {}, 1, 1};
  bond.modes = Eigen::Matrix<double, 6, 2>::Zero();
  bond.modes.col(0) << -1, 0.3, -0.2, 1e-3, 2e-3, 3e-3;
  const FrictionContact sheared = contact_after(bond, BreakMode::shear, 2.1e-3);
  EXPECT_TRUE(sheared.closed);
  EXPECT_EQ(sheared.first, 2); // lower slot first: the force on the other end is the opposite
  const GlobalLoad before = global_load(bond);
  const Vec3 after = sheared.normal[0] * sheared.frame.normal +
                     sheared.shear_1[0] * sheared.frame.tangent +
                     sheared.shear_2[0] * sheared.frame.second_tangent();
  EXPECT_LT((after + before.force).norm(), 1e-15);
  bond.modes(0, 0) = 1;
  const FrictionContact torn = contact_after(bond, BreakMode::tension, 1.9e-3);
  EXPECT_FALSE(torn.closed);
  EXPECT_EQ(torn.touch, 1.9e-3);
  EXPECT_EQ(torn.normal[0], 0);
}
