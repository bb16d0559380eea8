#include "dem/connectivity.h"
#include "dem/network_solver.h"
#include "tests/dem/assemblies.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

using namespace dem;

namespace {

const BondLaw unit_law{burgers(1, 1, 1, 1), 11, 1};

Eigen::VectorXd solve(const Assembly& assembly)
{
  const ElasticNetwork network = make_network(assembly);
  const NetworkSolver solver(network, undamaged(network));
  EXPECT_TRUE(solver.response()) << solver.obstacle();
  return *solver.response();
}

ParticleMotion solve_chain(int n, double lambda, const Vec3& force, const Vec3& moment)
{
  Assembly assembly = assemblies::chain(n, 1.0, BondLaw{burgers(1, 1, 1, 1), 11, lambda}, false);
  assembly.loads = {{n, force, moment}};
  const ElasticNetwork network = make_network(assembly);
  return motion(network, solve(assembly), n);
}

double distributed_tip_deflection(int n, double lambda)
{
  Assembly assembly = assemblies::chain(n, 1.0, BondLaw{burgers(1, 1, 1, 1), 11, lambda}, false);
  assembly.loads.clear();
  for (int i = 1; i <= n; ++i)
    assembly.loads.push_back({i, Vec3(1, 0, 0), Vec3::Zero()});
  const ElasticNetwork network = make_network(assembly);
  return motion(network, solve(assembly), n).displacement.x();
}

} // namespace

TEST(Network, SingleBondHasTheModesOfTheTable)
{
  for (const auto& row : reference::table("bond_mode_multipliers.csv")) {
    const auto value = [&](const char* column) { return reference::number(row, column); };
    const double ra = value("Ra"), rb = value("Rb");
    Assembly assembly =
        assemblies::bonded({{0, 0, 0}, {0, 0, ra + rb}}, {ra, rb}, {Support::bottom, Support::free},
                           {{0, 1}}, BondLaw{burgers(1, 1, 1, 1), 11, value("lambda")});
    const auto tip = [&](const Vec3& force, const Vec3& moment) {
      assembly.loads = {{1, force, moment}};
      return motion(make_network(assembly), solve(assembly), 1);
    };
    const auto expect = [&](double found, const char* column) {
      EXPECT_NEAR(found, value(column), 1e-12 * value(column)) << column;
    };
    expect(tip(Vec3(0, 0, 1), Vec3::Zero()).displacement.z(), "axial");
    expect(tip(Vec3::Zero(), Vec3(1, 0, 0)).rotation.x(), "bending");
    expect(tip(Vec3::Zero(), Vec3(0, 0, 1)).rotation.z(), "torsion");
    expect(tip(Vec3(1, 0, 0), Vec3::Zero()).displacement.x(), "tip_force_deflection");
    expect(tip(Vec3(1, 0, 0), Vec3::Zero()).rotation.y(),
           "tip_force_rotation_or_tip_moment_deflection");
    expect(tip(Vec3::Zero(), Vec3(0, 1, 0)).displacement.x(),
           "tip_force_rotation_or_tip_moment_deflection");
    expect(1 / mode_stiffness(assembly.laws[0], assembly.bonds.section_radius[0]).shear,
           "shear_rotation_blocked");
  }
}

TEST(Network, ChainsBendTwistAndStretchLikeTheTable)
{
  for (const auto& row : reference::table("chain_cantilever.csv")) {
    const int n = int(reference::number(row, "n_bonds"));
    const double lambda = reference::number(row, "lambda");
    const auto expect = [&](double found, const char* column) {
      const double expected = reference::number(row, column);
      EXPECT_NEAR(found, expected, 1e-9 * expected) << column << " with " << n << " bonds";
    };
    expect(solve_chain(n, lambda, Vec3(0, 0, 1), Vec3::Zero()).displacement.z(), "axial_u_per_F");
    expect(solve_chain(n, lambda, Vec3::Zero(), Vec3(0, 0, 1)).rotation.z(), "torsion_phi_per_T");
    const ParticleMotion by_moment = solve_chain(n, lambda, Vec3::Zero(), Vec3(0, 1, 0));
    expect(by_moment.rotation.y(), "tip_moment_rotation");
    expect(by_moment.displacement.x(), "tip_moment_deflection");
    const ParticleMotion by_force = solve_chain(n, lambda, Vec3(1, 0, 0), Vec3::Zero());
    expect(by_force.displacement.x(), "tip_force_deflection");
    expect(by_force.rotation.y(), "tip_force_rotation");
    expect(distributed_tip_deflection(n, lambda), "distributed_force_tip_deflection");
  }
}

TEST(Network, GoldenNetworkHasItsDisplacementsAndForces)
{
  const auto golden = reference::json("golden_network_27.json");
  const Assembly assembly = assemblies::golden(golden, {unit_law});
  const ElasticNetwork network = make_network(assembly);
  const Eigen::VectorXd x = solve(assembly);
  double scale = 0;
  for (const auto& u : golden.at("U_unit"))
    scale = std::max(scale, std::abs(u[0].get<double>()));
  for (Index i = 0; i < Index(assembly.particles.size()); ++i) {
    const ParticleMotion found = motion(network, x, i);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(found.displacement[k], golden["U_unit"][i][k].get<double>(), 1e-10 * scale);
      EXPECT_NEAR(found.rotation[k], golden["U_unit"][i][3 + k].get<double>(),
                  1e-10 * scale / network.radius[i]);
    }
  }
  for (std::size_t b = 0; b < network.bonds.size(); ++b) {
    const BondLoad load =
        bond_load(network.bonds[b], BondStatus::intact, deformation(network, network.bonds[b], x));
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(load.force[k], golden["bond_forces"][b][k].get<double>(), 1e-10);
      EXPECT_NEAR(load.moment[k], golden["bond_forces"][b][3 + k].get<double>(), 1e-12);
    }
  }
}

TEST(Network, SwappedEndsRenumberingAndRotationChangeNothing)
{
  const auto golden = reference::json("golden_network_27.json");
  const Assembly assembly = assemblies::golden(golden, {unit_law});
  const ElasticNetwork network = make_network(assembly);
  const Eigen::VectorXd x = solve(assembly);
  const auto n = Index(assembly.particles.size());
  const double scale = x.cwiseAbs().maxCoeff();

  Assembly swapped = assembly;
  for (std::size_t b = 0; b < swapped.bonds.size(); ++b) {
    std::swap(swapped.bonds.ends[b][0], swapped.bonds.ends[b][1]);
    swapped.bonds.contact_offset[b] *= -1;
  }
  EXPECT_LT((solve(swapped) - x).cwiseAbs().maxCoeff(), 1e-12 * scale);

  const auto renumbered_index = [&](Index i) { return (i * 10 + 3) % n; };
  Assembly renumbered = assembly;
  for (Index i = 0; i < n; ++i) {
    renumbered.particles.centre[renumbered_index(i)] = assembly.particles.centre[i];
    renumbered.particles.radius[renumbered_index(i)] = assembly.particles.radius[i];
    renumbered.support[renumbered_index(i)] = assembly.support[i];
  }
  for (auto& [a, b] : renumbered.bonds.ends) {
    a = renumbered_index(a);
    b = renumbered_index(b);
  }
  for (ParticleLoad& load : renumbered.loads)
    load.particle = renumbered_index(load.particle);
  const ElasticNetwork other = make_network(renumbered);
  const Eigen::VectorXd y = solve(renumbered);
  for (Index i = 0; i < n; ++i)
    EXPECT_LT(
        (motion(other, y, renumbered_index(i)).displacement - motion(network, x, i).displacement)
            .norm(),
        1e-12 * scale);

  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  Assembly rotated = assembly;
  for (Vec3& centre : rotated.particles.centre)
    centre = turn * centre + Vec3(0.3, -0.1, 0.2);
  for (ParticleLoad& load : rotated.loads)
    load = {load.particle, turn * load.force, turn * load.moment};
  const ElasticNetwork turned = make_network(rotated);
  const Eigen::VectorXd z = solve(rotated);
  for (Index i = 0; i < n; ++i)
    EXPECT_LT(
        (motion(turned, z, i).displacement - turn * motion(network, x, i).displacement).norm(),
        1e-10 * scale);
}

TEST(Network, ReciprocityAndBalanceHold)
{
  Assembly assembly = assemblies::golden(reference::json("golden_network_27.json"), {unit_law});
  assembly.loads = {{20, Vec3(1, 0, 0), Vec3::Zero()}};
  const ElasticNetwork network = make_network(assembly);
  const Eigen::VectorXd x = solve(assembly);
  const double there = motion(network, x, 24).displacement.y();
  assembly.loads = {{24, Vec3(0, 1, 0), Vec3::Zero()}};
  const double back = motion(network, solve(assembly), 20).displacement.x();
  EXPECT_NEAR(there, back, 1e-12 * std::abs(there));

  const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
  EXPECT_LT((network_forces(network, intact, x).nodal - network.unit_load).norm(), 1e-12);
}

TEST(Network, DoesNotDependOnTheUnits)
{
  // Length in mm, force in uN, stiffness in uN/mm: powers of two keep every digit, others rounding.
  const BondLaw law{burgers(3e6, 1e8, 1e6, 1e7), 11, 1};
  const auto golden = reference::json("golden_network_27.json");
  for (const auto& [length, force, tolerance] :
       {std::tuple{0x1p10, 0x1p20, 0.0}, std::tuple{1e3, 1e6, 1e-12}}) {
    const Eigen::VectorXd x = solve(assemblies::golden(golden, {law}));
    Assembly other = assemblies::golden(golden, {{scaled(law.creep, force / length), 11, 1}});
    for (Vec3& centre : other.particles.centre)
      centre *= length;
    for (double& r : other.particles.radius)
      r *= length;
    for (double& r : other.bonds.section_radius)
      r *= length;
    for (double& offset : other.bonds.contact_offset)
      offset *= length;
    for (ParticleLoad& load : other.loads) {
      load.force *= force;
      load.moment *= force * length;
    }
    EXPECT_LE((solve(other) / length - x).cwiseAbs().maxCoeff(),
              tolerance * x.cwiseAbs().maxCoeff());
  }
}

TEST(Network, ConditionIsGoodAlsoForSizeRatiosOf100)
{
  // A large sphere with twenty small satellites, the farthest one loaded.
  for (const double ratio : {1.0, 50.0, 100.0}) {
    const double small = 1e-3, large = ratio * small;
    std::vector<Vec3> centre{Vec3::Zero(), Vec3(0, 0, -large - small)};
    std::vector<double> radius{large, small};
    std::vector<std::array<Index, 2>> pairs{{0, 1}};
    for (int k = 0; k < 20; ++k) {
      const double z = -0.8 + 0.08 * k, angle = 2.4 * k;
      const Vec3 direction(std::sqrt(1 - z * z) * std::cos(angle),
                           std::sqrt(1 - z * z) * std::sin(angle), z);
      centre.push_back((large + small) * direction);
      radius.push_back(small);
      pairs.push_back({0, k + 2});
    }
    std::vector<Support> support(radius.size(), Support::free);
    support[1] = Support::bottom;
    Assembly assembly =
        assemblies::bonded(centre, radius, support, pairs, BondLaw{burgers(1e6, 1, 1, 1), 11, 1});
    assembly.loads = {{21, Vec3(0, 0, -1), Vec3::Zero()}};
    const ElasticNetwork network = make_network(assembly);
    const NetworkSolver solver(network, undamaged(network));
    ASSERT_TRUE(solver.response());
    const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
    const Eigen::VectorXd residual =
        network_forces(network, intact, *solver.response()).nodal - network.unit_load;
    EXPECT_LT(residual.norm(), 1e-10) << "size ratio " << ratio;
  }
}

TEST(Connectivity, FreeModesOfOneSphereMatchTheTable)
{
  const double r = 1e-3;
  const std::map<std::string, std::vector<Vec3>> neighbours{
      {"none", {}},
      {"1", {Vec3::UnitX()}},
      {"2 at 90 deg", {Vec3::UnitX(), Vec3::UnitY()}},
      {"2 opposite", {Vec3::UnitX(), -Vec3::UnitX()}},
      {"3 orthogonal", {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}},
      {"3 in a plane",
       {Vec3::UnitX(), Vec3(-0.5, 0.8, 0).normalized(), Vec3(-0.6, -0.7, 0).normalized()}},
      {"4",
       {Vec3(1, 1, 1).normalized(), Vec3(1, -1, -1).normalized(), Vec3(-1, 1, -1).normalized(),
        Vec3(-1, -1, 1).normalized()}}};
  for (const auto& row : reference::table("floppy_modes.csv")) {
    std::vector<Vec3> centre{Vec3::Zero()};
    std::vector<std::array<Index, 2>> pairs;
    for (const Vec3& direction : neighbours.at(row.at("bonds"))) {
      centre.push_back(2 * r * direction);
      pairs.push_back({0, Index(centre.size()) - 1});
    }
    std::vector<Support> support(centre.size(), Support::bottom);
    support[0] = Support::free;
    ElasticNetwork network = make_network(assemblies::bonded(
        centre, std::vector<double>(centre.size(), r), support, pairs, unit_law));
    const std::string type = row.at("bond_type");
    if (type == "normal+shear (contact bond)")
      for (auto& bond : network.bonds)
        bond.stiffness.torsion = bond.stiffness.bending = 0;
    const std::vector<BondStatus> status(pairs.size(), type == "normal only" ? BondStatus::pressed
                                                                             : BondStatus::intact);
    EXPECT_EQ(n_free_modes(network, status, 0), reference::number(row, "zero_modes_of_one_sphere"))
        << row.at("bonds") << ", " << type;
  }
}

TEST(Connectivity, LoosePiecesAndMissingSupportsAreNamed)
{
  Assembly assembly = assemblies::chain(4, 1.0, unit_law, true);
  ElasticNetwork network = make_network(assembly);
  std::vector<BondStatus> status(4, BondStatus::intact);
  Pieces pieces = find_pieces(network, status);
  EXPECT_TRUE(equilibrium_obstacle(network, pieces).empty());
  status[1] = status[2] = BondStatus::gone; // particle 2 is loose, the platens are apart
  pieces = find_pieces(network, status);
  EXPECT_EQ(pieces.of(2), PieceHold::loose);
  EXPECT_EQ(pieces.of(1), PieceHold::held);
  EXPECT_FALSE(pieces.platens_connected);
  EXPECT_NE(equilibrium_obstacle(network, pieces).find("platens"), std::string::npos);

  assembly = assemblies::chain(4, 1.0, unit_law, false);
  network = make_network(assembly);
  pieces = find_pieces(network, status);
  EXPECT_EQ(pieces.of(4), PieceHold::dropped);
  EXPECT_NE(equilibrium_obstacle(network, pieces).find("particle 3"), std::string::npos);
}

TEST(NetworkSolver, UpdatesAgreeWithFreshFactorisations)
{
  const Assembly assembly = assemblies::block(5, 8, BondLaw{burgers(1e6, 1e8, 1e6, 1e7), 11, 1}, 3);
  const ElasticNetwork network = make_network(assembly);
  Damage damage = undamaged(network);
  NetworkSolver solver(network, damage);
  for (Index k = 0; k < 60; ++k) {
    const Index bond = (k * 37) % Index(network.bonds.size());
    if (damage.status[bond] != BondStatus::intact)
      continue;
    const BondChange change{bond, k % 3 == 0 ? BondStatus::pressed : BondStatus::gone};
    damage = solver.apply(damage, {&change, 1});
    if (!solver.response())
      break;
    const NetworkSolver fresh(network, Damage{damage.status, damage.status, {}});
    const double scale = fresh.response()->cwiseAbs().maxCoeff();
    EXPECT_LT((*fresh.response() - *solver.response()).cwiseAbs().maxCoeff(), 1e-11 * scale);
    const NetworkSolver replayed(network, damage);
    EXPECT_EQ(*replayed.response(), *solver.response()) << "restart after " << k << " breakages";
  }
  EXPECT_GT(solver.statistics().n_updates, 20);
}

TEST(NetworkSolver, BrokenBondsEqualBondsOfNoStiffness)
{
  Assembly assembly = assemblies::golden(reference::json("golden_network_27.json"), {unit_law});
  const ElasticNetwork network = make_network(assembly);
  NetworkSolver solver(network, undamaged(network));
  const std::vector<BondChange> changes{{8, BondStatus::gone}, {62, BondStatus::gone}};
  solver.apply(undamaged(network), changes);
  ElasticNetwork weak = network;
  for (const BondChange& change : changes) {
    auto& s = weak.bonds[change.bond].stiffness;
    s = {1e-12 * s.normal, 1e-12 * s.shear, 1e-12 * s.torsion, 1e-12 * s.bending};
  }
  const NetworkSolver other(weak, undamaged(weak));
  EXPECT_LT((*other.response() - *solver.response()).norm(), 1e-10 * solver.response()->norm());
}

TEST(NetworkSolver, SaysWhenNothingCarriesTheLoad)
{
  const Assembly assembly = assemblies::chain(3, 1.0, unit_law, true);
  const ElasticNetwork network = make_network(assembly);
  NetworkSolver solver(network, undamaged(network));
  const BondChange change{1, BondStatus::gone};
  solver.apply(undamaged(network), {&change, 1});
  EXPECT_FALSE(solver.response());
  EXPECT_NE(solver.obstacle().find("platens"), std::string::npos);
}

TEST(Bonds, BadBondsAreRefusedWithTheirPlace)
{
  Particles particles{{{0, 0, 0}, {0, 0, 2}, {0, 0, 2}}, {1, 1, 1}, {0, 0, 1}};
  const std::vector<BondLaw> laws{unit_law};
  const auto message = [&](std::vector<std::array<Index, 2>> pairs, BondLaw law = unit_law) {
    try {
      make_bonds(particles, pairs, {&law, 1}, {&assemblies::one_law, 1});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message({{0, 1}}), "accepted");
  EXPECT_EQ(message({{0, 1}, {0, 7}}),
            "bond 1 between particles 0 and 7: there are particles 0 to 2 only");
  EXPECT_EQ(message({{1, 1}}),
            "bond 0 between particles 1 and 1: a particle cannot be bonded to itself");
  EXPECT_EQ(message({{0, 1}, {1, 0}}),
            "bond 1 between particles 1 and 0: this pair is already bonded");
  EXPECT_EQ(message({{1, 2}}),
            "bond 0 between particles 1 and 2: the centres coincide, the bond has no direction");
  EXPECT_EQ(message({{0, 2}}), "no bond law is given between particles of class 0 and class 1");
  EXPECT_EQ(message({}, BondLaw{burgers(1, 1, 1, 1), -11, 1}),
            "bond law: N/S must be > 0, found -11");
  EXPECT_EQ(message({}, BondLaw{burgers(1, 1, 1, 1), 11, 0}),
            "bond law: the radius multiplier must be > 0, found 0");
}

TEST(Bonds, NearestContactsReachTheMeanAsked)
{
  const Assembly block = assemblies::block(6, 6, unit_law, 1);
  for (const double mean : {0.5, 2.0}) {
    const ContactPairs contacts = nearest_contacts(block.particles, mean);
    EXPECT_EQ(contacts.pairs.size(), std::size_t(std::lround(mean * 216 / 2)));
    EXPECT_EQ(contacts_within(block.particles, contacts.gap).pairs, contacts.pairs);
  }
}
