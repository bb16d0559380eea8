#include "dem/events.h"
#include "dem/iterative_solver.h"
#include "dem/linear.h"
#include "dem/network_solver.h"
#include "dem/packing.h"
#include "tests/dem/assemblies.h"

#include <gtest/gtest.h>

using namespace dem;

namespace {

const BondLaw law{burgers(3.2e6, 8.2e8, 5e5, 8.4e6), 11, 1};
constexpr std::size_t always_iterate = 0;

/// A cylinder of spheres of the sma10 grading, bonded as in the creep study.
Assembly cylinder(std::size_t n_particles)
{
  const double scale = std::cbrt(double(n_particles) / 6000);
  PackingRequest request;
  request.container = {0.5 * 60.2e-3 * scale, 120.3e-3 * scale};
  request.grading = named_grading("sma10");
  request.n_particles = n_particles;
  request.solid_fraction = 0.7;
  const Particles particles = grow_packing(request, 1);
  const auto support = platen_supports(particles, {0, request.container.height}, 1e-3);
  return assemblies::bonded(particles.centre, particles.radius, support,
                            nearest_contacts(particles, 5.5).pairs, law);
}

/// A column of large spheres, each with forty satellites; the lowest satellite is clamped and the
/// last one loaded.
Assembly clusters(int n_large, double ratio)
{
  constexpr int n_satellites = 40;
  const double small = 1e-3, large = ratio * small;
  std::vector<Vec3> centre;
  std::vector<double> radius;
  std::vector<std::array<Index, 2>> pairs;
  for (int c = 0; c < n_large; ++c) {
    const auto hub = Index(centre.size());
    if (c > 0)
      pairs.push_back({hub - n_satellites - 1, hub});
    centre.emplace_back(0, 0, 2 * large * c);
    radius.push_back(large);
    for (int k = 0; k < n_satellites; ++k) {
      const double z = -0.8 + 0.04 * k, angle = 2.4 * k, across = std::sqrt(1 - z * z);
      centre.push_back(centre[hub] + (large + small) * Vec3(across * std::cos(angle),
                                                            across * std::sin(angle), z));
      radius.push_back(small);
      pairs.push_back({hub, Index(centre.size()) - 1});
    }
  }
  std::vector<Support> support(radius.size(), Support::free);
  support[1] = Support::bottom;
  Assembly assembly = assemblies::bonded(centre, radius, support, pairs, law);
  assembly.loads = {{Index(radius.size()) - 1, Vec3(0, 0, -1), Vec3::Zero()}};
  return assembly;
}

/// Largest difference between factor and iteration over the largest displacement.
double disagreement(const ElasticNetwork& network, const Damage& damage)
{
  const NetworkSolver factor(network, damage);
  const NetworkSolver iteration(network, damage, always_iterate);
  EXPECT_TRUE(iteration.statistics().iterates);
  EXPECT_FALSE(factor.statistics().iterates);
  EXPECT_TRUE(factor.response()) << factor.obstacle();
  EXPECT_TRUE(iteration.response()) << iteration.obstacle();
  if (!factor.response() || !iteration.response())
    return INFINITY;
  return (*iteration.response() - *factor.response()).cwiseAbs().maxCoeff() /
         factor.response()->cwiseAbs().maxCoeff();
}

double disagreement(const Assembly& assembly)
{
  const ElasticNetwork network = make_network(assembly);
  return disagreement(network, undamaged(network));
}

long iterations(const Assembly& assembly)
{
  const ElasticNetwork network = make_network(assembly);
  return NetworkSolver(network, undamaged(network), always_iterate).statistics().n_iterations;
}

} // namespace

TEST(IterativeSolver, GoldenNetworkHasItsDisplacements)
{
  const auto golden = reference::json("golden_network_27.json");
  const ElasticNetwork network =
      make_network(assemblies::golden(golden, {{burgers(1, 1, 1, 1), 11, 1}}));
  const NetworkSolver solver(network, undamaged(network), always_iterate);
  ASSERT_TRUE(solver.response()) << solver.obstacle();
  const double scale = solver.response()->cwiseAbs().maxCoeff();
  for (Index i = 0; i < Index(network.radius.size()); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(motion(network, *solver.response(), i).displacement[k],
                  golden["U_unit"][i][k].get<double>(), 1e-9 * scale);
}

TEST(IterativeSolver, AgreesWithTheFactorOnChains)
{
  EXPECT_LT(disagreement(assemblies::chain(2000, 1e-3, law, true)), 1e-9); // three levels
  EXPECT_LT(disagreement(assemblies::chain(100, 1e-3, law, false)), 1e-9); // bends
}

TEST(IterativeSolver, AgreesWithTheFactorOnPackings)
{
  const ElasticNetwork network = make_network(cylinder(1000));
  Damage damage = undamaged(network);
  EXPECT_LT(disagreement(network, damage), 1e-9);
  for (std::size_t b = 0; b < damage.status.size(); b += 7)
    damage.status[b] = BondStatus::gone;
  const auto free = std::ranges::find_if(network.first_dof, [](Index dof) { return dof >= 0; });
  const auto loose = Index(free - network.first_dof.begin());
  for (std::size_t b = 0; b < damage.status.size(); ++b)
    if (std::ranges::count(network.bonds[b].ends, loose) > 0)
      damage.status[b] = BondStatus::gone;
  damage.factorised = damage.status;
  EXPECT_EQ(find_pieces(network, damage.status).of(loose), PieceHold::loose);
  EXPECT_LT(disagreement(network, damage), 1e-9);
}

TEST(IterativeSolver, FollowsBreakagesAsAFreshSolverWould)
{
  const ElasticNetwork network = make_network(assemblies::block(8, 10, law, 3));
  Damage damage = undamaged(network);
  NetworkSolver solver(network, damage, always_iterate);
  for (Index k = 0; k < 12; ++k) {
    const BondChange change{(k * 37) % Index(network.bonds.size()), BondStatus::gone};
    damage = solver.apply(damage, {&change, 1});
    ASSERT_TRUE(solver.response()) << solver.obstacle();
    const NetworkSolver factor(network, {damage.status, damage.status, {}});
    EXPECT_LT((*solver.response() - *factor.response()).cwiseAbs().maxCoeff(),
              1e-9 * factor.response()->cwiseAbs().maxCoeff());
    const NetworkSolver replayed(network, damage, always_iterate);
    EXPECT_EQ(*replayed.response(), *solver.response()) << "restart after " << k << " breakages";
  }
  EXPECT_EQ(solver.statistics().n_updates, 12);
  EXPECT_EQ(solver.statistics().n_factorisations, 1);
}

TEST(IterativeSolver, HoldsWhatContactsPress)
{
  const ElasticNetwork network = make_network(assemblies::block(8, 10, law, 5));
  Damage damage = undamaged(network);
  for (std::size_t b = 0; b < damage.status.size(); b += 5)
    damage.status[b] = BondStatus::pressed;
  damage.factorised = damage.status;
  EXPECT_LT(disagreement(network, damage), 1e-9);
}

TEST(IterativeSolver, SizeRatiosDoNotSlowItDown)
{
  const long same_size = iterations(clusters(15, 1));
  EXPECT_GT(same_size, 3);
  for (const double ratio : {50.0, 100.0}) {
    EXPECT_LE(iterations(clusters(15, ratio)), 2 * same_size);
    EXPECT_LT(disagreement(clusters(15, ratio)), 1e-9) << ratio;
    EXPECT_LT(disagreement(clusters(1, ratio)), 1e-10) << ratio;
  }
}

TEST(IterativeSolver, IterationsHardlyGrowWithTheSize)
{
  const long small = iterations(assemblies::block(10, 12, law, 1));
  const long large = iterations(assemblies::block(20, 24, law, 1)); // 9600 spheres
  EXPECT_GT(small, 5);
  EXPECT_LE(large, small + 8);
}

TEST(IterativeSolver, ReportsWhatHasNoStiffness)
{
  Assembly assembly = assemblies::chain(5, 1e-3, law, false); // loaded from the side
  ElasticNetwork network = make_network(assembly);
  for (ElasticNetwork::Bond& bond : network.bonds)
    bond.stiffness = {bond.stiffness.normal, 0, 0, 0};
  const NetworkSolver solver(network, undamaged(network), always_iterate);
  EXPECT_FALSE(solver.response());
  EXPECT_EQ(solver.obstacle(), "the remaining bonds and contacts are a mechanism");
}

TEST(ConjugateGradients, EndWithAReason)
{
  const Eigen::Matrix3d matrix = Eigen::Vector3d(1, 2, -1).asDiagonal();
  const Eigen::VectorXd b = Eigen::Vector3d(1, 1, 1);
  const auto solved = [&](const Eigen::Matrix3d& a, int most) {
    return conjugate_gradients([&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return a * x; },
                               b, [](const Eigen::VectorXd& r) { return r; },
                               [](IterationProgress p) { return p.residual < 1e-12; }, most);
  };
  EXPECT_EQ(solved(matrix, 10).end, IterationEnd::no_stiffness);
  EXPECT_EQ(solved(Eigen::Vector3d(1, 2, 0).asDiagonal(), 10).end, IterationEnd::no_stiffness);
  EXPECT_EQ(solved(Eigen::Vector3d(1, 2, 3).asDiagonal(), 2).end, IterationEnd::too_many);
  const IterativeSolution solution = solved(Eigen::Vector3d(1, 2, 4).asDiagonal(), 10);
  EXPECT_EQ(solution.end, IterationEnd::converged);
  EXPECT_EQ(solution.n_iterations, 3);
  EXPECT_LT((solution.x - Eigen::Vector3d(1, 0.5, 0.25)).norm(), 1e-14);
}

TEST(Linear, LargePackingsIterateToTheSameAnswer)
{
  Assembly assembly = assemblies::block(8, 12, law, 2);
  const LinearModel factorised = make_linear_model(assembly);
  const LinearModel iterated = make_linear_model(assembly, 100);
  EXPECT_FALSE(factorised.statistics.iterates);
  EXPECT_TRUE(iterated.statistics.iterates);
  EXPECT_NEAR(iterated.compliance, factorised.compliance, 1e-11 * factorised.compliance);
}

TEST(Events, LargePackingsBreakTheSameBonds)
{
  Assembly assembly = assemblies::block(5, 6, law, 4);
  assembly.strengths = draw_strengths({WeibullStrength{1.1, 60}}, assembly.bonds.id, 7);
  const Loading loading = step_load(Loading::Control::force, -200e3 * assembly.area, 1000);
  const EventsModel model =
      make_events_model(assembly, loading, RateLaw{}, AfterBreakage::leave, 0.1);
  const auto breakages = [&](std::size_t most_factored) {
    EventsSolver solver(model, most_factored);
    EventsState state = solver.start();
    while (state.end == RunEnd::running && state.breakages.size() < 20)
      state = solver.step(std::move(state));
    return state.breakages;
  };
  const std::vector<Breakage> expected = breakages(most_factored_particles);
  const std::vector<Breakage> found = breakages(always_iterate);
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GT(expected.size(), 4u);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(found[k].bond, expected[k].bond);
    EXPECT_NEAR(found[k].time, expected[k].time, 1e-6 * expected[k].time);
  }
}
