#include "dem/bond_frame.h"
#include "dem/critical_step.h"
#include "dem/dynamic_bonds.h"
#include "tests/dem/assemblies.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>

using namespace dem;

namespace {

/// A bond between a held and a free sphere, for the kernel alone.
struct Pair {
  Assembly assembly;
  DynamicBonds bonds;
  std::vector<StepFactors> factors;
  AlignedDoubles motions = AlignedDoubles(2 * motion_stride, 0.0);
  AlignedDoubles partial;

  explicit Pair(const CreepLaw& law, const Vec3& second = Vec3(2e-3, 0, 0), int n_modes = 0)
      : assembly(assemblies::bonded({Vec3::Zero(), second}, {1e-3, 1e-3},
                                    {Support::bottom, Support::free}, {{0, 1}},
                                    BondLaw{law, 11, 1}))
  {
    const std::vector<Index> slot{0, 1};
    const int modes = n_modes ? n_modes : int(relaxation_spectrum(law).size());
    bonds = make_dynamic_bonds(assembly, slot, modes);
    factors = {step_factors(law, 1e-3, modes)};
    partial.assign(bonds.n_partial_forces * force_stride, 0.0);
    place(Vec3::Zero(), second);
  }

  void place(const Vec3& first, const Vec3& second, const Vec3& h_first = Vec3::Zero(),
             const Vec3& h_second = Vec3::Zero())
  {
    const Vec3 values[4] = {first, h_first, second, h_second};
    for (int v = 0; v < 4; ++v)
      for (int k = 0; k < 3; ++k)
        motions[(v / 2) * motion_stride + (v % 2) * 3 + k] = values[v][k];
  }

  GlobalLoad step()
  {
    std::vector<Index> broken;
    advance_chunk(bonds, bonds.chunks[0], motions.data(), factors, 1, partial.data(), broken);
    return global_load(dynamic_bond(bonds, 0));
  }
};

/// The bonded spheres of a crystal with n sites along each edge, lowest layer held.
Assembly crystal(const std::vector<Vec3>& basis, double edge, int n, double bond_length,
                 const CreepLaw& law)
{
  Particles particles;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        for (const Vec3& site : basis)
          particles.centre.push_back(edge * (Vec3(x, y, z) + site));
  particles.radius.assign(particles.centre.size(), bond_length / 2);
  particles.material_class.assign(particles.centre.size(), 0);
  const ContactPairs pairs = contacts_within(particles, 1e-6);
  std::vector<Support> support(particles.size(), Support::free);
  Assembly assembly = assemblies::bonded(particles.centre, particles.radius, support, pairs.pairs,
                                         BondLaw{law, 11, 1});
  assembly.loads = {{0, Vec3(1e-9, 0, 0), Vec3::Zero()}};
  return assembly;
}

} // namespace

TEST(BondFrame, RigidRotationsOfTheTableAreExactInAnyNumberOfSteps)
{
  const Vec3 axis = Vec3(1, 2, -0.5).normalized();
  const Vec3 force(2, -0.7, 0.3), moment(1e-3, 2e-3, -0.5e-3);
  for (const auto& row : reference::table("rigid_rotation.csv")) {
    const double theta = reference::number(row, "theta");
    for (const int n : {1, 7, 1000}) {
      BondFrame frame{Vec3::UnitX(), Vec3::UnitY()};
      const Vec3 start = frame.normal;
      for (int k = 1; k <= n; ++k) {
        const Vec3 normal = Eigen::AngleAxisd(theta * k / n, axis) * start;
        frame = carried(frame, half_tangent(axis * theta / n), normal);
      }
      Mat3 axes;
      axes << frame.normal, frame.tangent, frame.second_tangent();
      const Vec3 turned = axes * force, twisted = axes * moment;
      const char* names[] = {"fx", "fy", "fz", "mx", "my", "mz"};
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(turned[k], reference::number(row, names[k]), 1e-12) << theta << " in " << n;
        EXPECT_NEAR(twisted[k], reference::number(row, names[3 + k]), 1e-14)
            << theta << " in " << n;
      }
    }
  }
}

TEST(DynamicBonds, RigidRotationStrainsNothingAndTurnsTheForces)
{
  const Vec3 axis = Vec3(1, 2, -0.5).normalized();
  const double theta = 10 * std::acos(-1.0) + 0.7;
  for (const long n : {1000L, 1000000L}) {
    Pair pair(make_creep_law(1e6, std::nullopt, {}));
    // a preload in all six modes
    pair.place(Vec3::Zero(), Vec3(2.001e-3, 2e-6, -1e-6), Vec3::Zero(), Vec3(1e-4, -2e-4, 3e-4));
    const GlobalLoad before = pair.step();
    const Vec3 start(2.001e-3, 2e-6, -1e-6);
    const Vec3 h = half_tangent(axis * theta / double(n));
    GlobalLoad after{};
    for (long k = 1; k <= n; ++k) {
      const Eigen::AngleAxisd turn(theta * double(k) / double(n), axis);
      pair.place(Vec3(1, 1, 1) - Vec3(turn * Vec3(0, 0, 1e-2)), // moves as well
                 Vec3(1, 1, 1) - Vec3(turn * Vec3(0, 0, 1e-2)) + turn * start, h, h);
      after = pair.step();
    }
    const Eigen::AngleAxisd turn(theta, axis);
    const double tolerance = n == 1000 ? 1e-9 : 1e-6; // rounding of positions of order 1 m
    EXPECT_LT((after.force - turn * before.force).norm(), tolerance * before.force.norm());
    EXPECT_LT((after.moment - turn * before.moment).norm(), tolerance * before.moment.norm());
    EXPECT_NEAR(after.force.norm(), before.force.norm(), tolerance * before.force.norm());
  }
}

TEST(DynamicBonds, SmallMotionsGiveTheForcesOfTheNetworkInAllModesOfAllLaws)
{
  for (const int n_modes : {0, 6}) // the kernel for few modes and the general one
    for (const CreepLaw& law : {laws::burgers_set("asphalt"), laws::wide()}) {
      const Vec3 second = 2e-3 * Vec3(1, -2, 0.7).normalized();
      Pair pair(law, second, n_modes);
      const ElasticNetwork network = make_network(pair.assembly);
      const auto spectrum = relaxation_spectrum(law);
      Eigen::VectorXd dofs(6);
      dofs << 1e-10, -2e-10, 3e-10, 2e-10, 1e-10, -1e-10; // u and R theta
      const int n = 5;
      GlobalLoad found{};
      for (int k = 1; k <= n; ++k) {
        const Vec3 h = 0.5 * dofs.tail<3>() / 1e-3 / n;
        pair.place(Vec3::Zero(), second + dofs.head<3>() * k / n, Vec3::Zero(), h);
        found = pair.step();
      }
      const BondLoad elastic = bond_load(network.bonds[0], BondStatus::intact,
                                         deformation(network, network.bonds[0], dofs));
      const double t = n * 1e-3,
                   fade = relaxation_integral(spectrum, t) / t / law.maxwell_stiffness;
      EXPECT_LT((found.force - fade * elastic.force).norm(), 1e-6 * elastic.force.norm());
      EXPECT_LT((found.moment - fade * elastic.moment).norm(), 1e-6 * elastic.moment.norm());
    }
}

TEST(DynamicBonds, SwappedEndsFeelTheSame)
{
  const CreepLaw law = laws::burgers_set("asphalt");
  Pair pair(law), swapped(law);
  std::swap(swapped.assembly.bonds.ends[0][0], swapped.assembly.bonds.ends[0][1]);
  const std::vector<Index> slot{0, 1};
  swapped.bonds = make_dynamic_bonds(swapped.assembly, slot, 2);
  GlobalLoad a{}, b{};
  for (int k = 1; k <= 200; ++k) { // large motions
    const Vec3 second = Eigen::AngleAxisd(0.01 * k, Vec3(0, 1, 1).normalized()) *
                        Vec3(2e-3 * (1 + 1e-3 * std::sin(0.1 * k)), 1e-5 * k, 0);
    const Vec3 h1(1e-3, -2e-3, 4e-3), h2(2e-3, 1e-3, std::cos(0.2 * k) * 1e-2);
    pair.place(Vec3::Zero(), second, h1, h2);
    swapped.place(Vec3::Zero(), second, h1, h2);
    a = pair.step();
    b = swapped.step();
    EXPECT_LT((a.force + b.force).norm(), 1e-12 * a.force.norm()) << "step " << k;
    EXPECT_LT((a.moment + b.moment).norm(), 1e-12 * a.moment.norm()) << "step " << k;
  }
}

TEST(DynamicBonds, StiffnessesMayDifferFromThoseOfTheSection)
{
  Pair pair(make_creep_law(1e6, std::nullopt, {}));
  const ModeStiffness stiffness{1e6, 5e5, 2, 4}; // no section has half the torsion at N/S = 2
  set_stiffness(pair.bonds, 0, stiffness);
  const double angle = 1e-6;
  pair.place(Vec3::Zero(), Vec3(2e-3, 0, 0), Vec3::Zero(), Vec3(0.5 * angle, 0, 0));
  EXPECT_NEAR(pair.step().moment.x(), stiffness.torsion * angle, 1e-12 * angle);
  pair.place(Vec3::Zero(), Vec3(2e-3 + 1e-9, 0, 0));
  const GlobalLoad stretched = pair.step();
  EXPECT_NEAR(stretched.force.x(), stiffness.normal * 1e-9, 1e-9 * stiffness.normal * 1e-9);
  EXPECT_NEAR(stretched.moment.x(), stiffness.torsion * angle, 1e-12 * angle);
}

TEST(CriticalStep, IsThatOfTheCrystals)
{
  const double k = 1e6, d = 4e-3, density = 2600;
  const CreepLaw law = make_creep_law(k, std::nullopt, {});
  const double unit = std::sqrt(density * sphere_volume(d / 2) / k);
  const Vec3 o(0, 0, 0);
  const std::map<std::string, Assembly> crystals{
      {"SC", crystal({o}, d, 8, d, law)},
      {"BCC", crystal({o, Vec3(.5, .5, .5)}, 2 * d / std::sqrt(3.0), 6, d, law)},
      {"FCC", crystal({o, Vec3(0, .5, .5), Vec3(.5, 0, .5), Vec3(.5, .5, 0)}, d * std::sqrt(2.0), 5,
                      d, law)}};
  for (const auto& row : reference::table("critical_time_step.csv")) {
    const double exact = reference::number(row, "dt_crit");
    EXPECT_NEAR(unit, reference::number(row, "sqrt_m_over_kn"), 1e-12);
    if (row.at("system") == "chain") {
      Assembly chain = assemblies::chain(60, d, BondLaw{law, 11, 1}, false);
      const double step = critical_time_step(make_network(chain), density);
      EXPECT_LE(step, 1.001 * exact);
      EXPECT_GE(step, 0.3 * exact);
      continue;
    }
    // a finite crystal is a little softer than the infinite one
    const double step = critical_time_step(make_network(crystals.at(row.at("system"))), density);
    EXPECT_LE(step, 1.02 * exact) << row.at("system");
    EXPECT_GE(step, 0.9 * exact) << row.at("system");
  }
}

TEST(CriticalStep, ChainsVibrateAtTheFrequenciesOfTheTable)
{
  const double r = 2e-3, mass = 2600 * sphere_volume(r);
  for (const auto& row : reference::table("chain_frequencies.csv")) {
    const auto n = Index(reference::number(row, "n_bonds"));
    std::vector<Vec3> centre;
    std::vector<std::array<Index, 2>> pairs;
    for (Index k = 0; k <= n; ++k) {
      centre.emplace_back(0, 0, 2 * r * k);
      if (k > 0)
        pairs.push_back({k - 1, k});
    }
    std::vector<Support> support(centre.size(), Support::free);
    support[0] = Support::bottom;
    Assembly chain =
        assemblies::bonded(centre, std::vector<double>(centre.size(), r), support, pairs,
                           BondLaw{make_creep_law(1e6, std::nullopt, {}), 11, 1});
    chain.loads.push_back({n, Vec3(0, 0, 1), Vec3::Zero()});
    const ElasticNetwork network = make_network(chain);
    const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
    for (const auto& [component, inertia, name] :
         {std::tuple(2, mass, "omega_axial"), std::tuple(5, 0.4 * mass, "omega_torsion")}) {
      Eigen::MatrixXd matrix(n, n);
      for (Index c = 0; c < n; ++c) {
        const Eigen::VectorXd column =
            network_forces(network, intact,
                           Eigen::VectorXd::Unit(network.n_dofs, 6 * c + component))
                .nodal;
        for (Index i = 0; i < n; ++i)
          matrix(i, c) = column[6 * i + component] / inertia;
      }
      const double squared = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix)
                                 .eigenvalues()[Eigen::Index(reference::number(row, "mode")) - 1];
      const double expected = reference::number(row, name);
      EXPECT_NEAR(std::sqrt(squared), expected, 1e-11 * expected) << name << ", n = " << n;
    }
  }
}

TEST(CriticalStep, PowerIterationIsCloseToTheEigenvalueOfARandomNetwork)
{
  const Assembly assembly =
      assemblies::block(3, 5, BondLaw{make_creep_law(1e6, std::nullopt, {}), 11, 1}, 4);
  const ElasticNetwork network = make_network(assembly);
  const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
  const Index n = network.n_dofs - 1; // without the platen
  Eigen::MatrixXd matrix(n, n);
  Eigen::VectorXd root(n);
  for (std::size_t i = 0; i < network.radius.size(); ++i)
    if (const Index dof = network.first_dof[i]; dof >= 0)
      for (int k = 0; k < 6; ++k)
        root[dof + k] = 1 / std::sqrt(2600 * sphere_volume(network.radius[i]) * (k < 3 ? 1 : 0.4));
  for (Index c = 0; c < n; ++c)
    matrix.col(c) = network_forces(network, intact, Eigen::VectorXd::Unit(n + 1, c)).nodal.head(n);
  matrix = root.asDiagonal() * matrix * root.asDiagonal();
  const double exact =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues().maxCoeff());
  const double found = largest_frequency(network, 2600);
  EXPECT_LE(found, exact * (1 + 1e-12));
  EXPECT_GE(found, 0.99 * exact);
}
