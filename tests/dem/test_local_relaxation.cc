#include "dem/local_relaxation.h"

#include "dem/quasistatic.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

using namespace dem;

namespace {

const BondLaw asphalt_law{laws::burgers_set("asphalt"), 11, 1};

/// The instant of loading of an assembly that is at rest.
struct Instant {
  explicit Instant(const Assembly& assembly)
      : model(make_quasistatic_model(assembly, ramp(Loading::Control::force, 1, 1),
                                     event_runs::constant_strength, {}, event_runs::never)),
        state(start(model)), laws{law_step(model.assembly.laws[0].creep, model.scheme, 0,
                                           state.links.n_parts)},
        links_of(body_links(state.links, state.centre.size())), hold(state.centre.size(), 0.0),
        external(Eigen::VectorXd::Zero(model.dofs.n_dofs)),
        step{&model.assembly, &model.bodies, &state.links, state.centre, laws, 0.5, 1e-3,
             Geometry::finite},
        at{std::vector<Vec3>(state.centre.size(), Vec3::Zero()),
           std::vector<Vec3>(state.centre.size(), Vec3::Zero())},
        x(external)
  {
  }

  LocalProblem problem(double tolerance) const
  {
    return {&step, &links_of, &model.dofs, hold, &external, tolerance};
  }

  void move(Index body, const Vec3& by)
  {
    at.moved[body] = by;
    x.segment<3>(model.dofs.first_dof[body]) = by;
  }

  QuasistaticModel model;
  QuasistaticState state;
  std::vector<LawStep> laws;
  BodyLinks links_of;
  std::vector<double> hold;
  Eigen::VectorXd external;
  LinkStep step;
  Configuration at;
  Eigen::VectorXd x;
};

} // namespace

TEST(LocalRelaxation, BringsABodyBackAndMovesNoOther)
{
  Assembly assembly = assemblies::block(4, 5, asphalt_law, 3);
  assembly.pair_laws = {assemblies::one_law};
  Instant now(assembly);
  Index body = 0;
  while (now.model.dofs.first_dof[body] < 0)
    ++body;
  const Vec3 by(1e-8, -2e-8, 1.5e-8);
  now.move(body, by);
  const std::vector<Index> group{body};
  relax_group(now.problem(1e-12), group, now.at, now.x);
  EXPECT_LT(now.at.moved[body].norm(), 1e-3 * by.norm());
  now.x.segment<6>(now.model.dofs.first_dof[body]).setZero();
  EXPECT_EQ(now.x.norm(), 0);
}

TEST(LocalRelaxation, PushesASphereOutOfOneItOverlaps)
{
  // Bonded to the first; what hits the third comes back to where both forces balance.
  Assembly assembly = assemblies::bonded(
      {Vec3(0, 0, 0), Vec3(0, 0, 4e-3), Vec3(0, 0, 8e-3 + 1e-8)}, {2e-3, 2e-3, 2e-3},
      {Support::bottom, Support::free, Support::bottom}, {{0, 1}}, asphalt_law);
  assembly.pair_laws = {assemblies::one_law};
  assembly.loads = {{1, Vec3(0, 0, 1), Vec3::Zero()}};
  Instant now(assembly);
  now.external[2] = 1;
  now.move(1, Vec3(0, 0, 1e-4));
  const std::vector<Index> group{1};
  relax_group(now.problem(1e-9), group, now.at, now.x);
  const double stiffness = now.laws[0].stiffness();
  EXPECT_NEAR(now.at.moved[1].z(), (1 / stiffness + 1e-8) / 2, 1e-9);
}

TEST(LocalRelaxation, GroupsHoldWhatIsOutOfBalanceAndItsNeighbours)
{
  Assembly assembly = assemblies::block(4, 5, asphalt_law, 3);
  assembly.pair_laws = {assemblies::one_law};
  Instant now(assembly);
  std::vector<LinkTangent> tangent;
  for (std::size_t k = 0; k < now.state.links.link.size(); ++k)
    tangent.push_back(answer(now.step, k, now.at).tangent);
  Index body = 0;
  while (now.model.dofs.first_dof[body] < 0)
    ++body;
  Eigen::VectorXd residual = now.external;
  EXPECT_TRUE(unbalanced_groups(now.problem(1), tangent, residual).empty());
  residual[now.model.dofs.first_dof[body]] = 10;
  const auto groups = unbalanced_groups(now.problem(1), tangent, residual);
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].front(), body);
  EXPECT_GT(groups[0].size(), 1u);
  residual.setConstant(10);
  EXPECT_TRUE(unbalanced_groups(now.problem(1), tangent, residual).empty());
}

TEST(LocalRelaxation, LeavesTheForcesOnAllBodiesAsTheyAre)
{
  // A loose sphere that is thrown onto the block makes the search relax; beginning anew at what was
  // found must show the same forces, to the last bit.
  Assembly assembly = assemblies::block(4, 5, asphalt_law, 3);
  assembly.pair_laws = {assemblies::one_law};
  Instant now(assembly);
  Index body = 0;
  while (now.model.dofs.first_dof[body] < 0)
    ++body;
  const EquilibriumProblem problem{
      now.step, &now.links_of,          now.hold, now.external, [](double) { return 1.0; }, 0,
      1e-6,     now.laws[0].stiffness()};
  Eigen::VectorXd guess = now.external;
  guess[now.model.dofs.first_dof[body]] = 1e-4;
  EquilibriumFinder finder(now.model.dofs, 1), other(now.model.dofs, 1);
  const Equilibrium found = finder.find(problem, guess);
  ASSERT_TRUE(found.found);
  const Equilibrium again = other.find(problem, found.x);
  EXPECT_EQ(again.n_iterations, 0);
  EXPECT_EQ(again.residual, found.residual);
  EXPECT_EQ(again.platen_force, found.platen_force);
  EXPECT_EQ(again.largest_force, found.largest_force);
}
