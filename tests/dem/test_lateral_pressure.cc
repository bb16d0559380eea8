#include "dem/dynamics.h"
#include "dem/lateral_pressure.h"
#include "dem/linear.h"
#include "dem/packing.h"
#include "dem/quasistatic.h"
#include "tests/dem/assemblies.h"
#include "tests/dem/event_runs.h"
#include "tests/dem/laws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

using namespace dem;

namespace {

const Cylinder cylinder{15e-3, 40e-3};

const Particles& packing()
{
  static const Particles particles = [] {
    PackingRequest request{cylinder, make_grading({{2e-3, 0}, {4e-3, 0.5}, {6.3e-3, 1}}), 0, 0.62};
    request.n_particles =
        std::size_t(std::lround(0.62 * cylinder.volume() / mean_particle_volume(request.grading)));
    return grow_packing(request, 3);
  }();
  return particles;
}

} // namespace

TEST(LateralPressure, ForcesAndMomentsVanishInAll)
{
  const Particles& particles = packing();
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double size = 0;
  for (const ParticleLoad& load : lateral_pressure(particles, cylinder, Vec3::Zero())) {
    force += load.force;
    moment += particles.centre[load.particle].cross(load.force) + load.moment;
    size += load.force.norm();
    EXPECT_EQ(load.force.z(), 0);
  }
  EXPECT_NEAR(size, 2 * std::numbers::pi * cylinder.radius * cylinder.height, 0.02 * size);
  EXPECT_LT(force.norm(), 1e-13 * size);
  EXPECT_LT(moment.norm(), 1e-13 * size * cylinder.height);
}

TEST(LateralPressure, IsTheMeanStressInBothLateralDirections)
{
  // Points of attack: the centres of the spheres, moved out to the lateral surface. (The middles of
  // the patches would give the stress to rounding, but say nothing about the choice of spheres.)
  const Particles& particles = packing();
  Mat3 stress = Mat3::Zero();
  for (const ParticleLoad& load : lateral_pressure(particles, cylinder, Vec3::Zero())) {
    Vec3 point = particles.centre[load.particle];
    point.head<2>() *= cylinder.radius / point.head<2>().norm();
    stress += point * load.force.transpose() / cylinder.volume();
  }
  const Mat3 expected = Vec3(-1, -1, 0).asDiagonal();
  EXPECT_LT((stress - expected).cwiseAbs().maxCoeff(), 0.01) << stress;
}

TEST(LateralPressure, PressesOnSpheresAtTheSurface)
{
  const Particles& particles = packing();
  for (const ParticleLoad& load : lateral_pressure(particles, cylinder, Vec3::Zero())) {
    const Vec3& centre = particles.centre[load.particle];
    const double gap = cylinder.radius - centre.head<2>().norm() - particles.radius[load.particle];
    EXPECT_LT(gap, 5e-3);
    EXPECT_LT(load.force.head<2>().dot(centre.head<2>()), 0); // inward
  }
}

TEST(LateralPressure, TurnsWithThePacking)
{
  const Particles& particles = packing();
  Particles turned = particles;
  const auto turn = [](const Vec3& v) { return Vec3(-v.y(), v.x(), v.z()); };
  for (Vec3& centre : turned.centre)
    centre = turn(centre);
  const auto before = lateral_pressure(particles, cylinder, Vec3::Zero());
  const auto after = lateral_pressure(turned, cylinder, Vec3::Zero());
  ASSERT_EQ(before.size(), after.size());
  const double small = 1e-13 * cylinder.area();
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_EQ(before[k].particle, after[k].particle);
    EXPECT_LT((turn(before[k].force) - after[k].force).norm(), small);
    EXPECT_LT((turn(before[k].moment) - after[k].moment).norm(), small * cylinder.radius);
  }
}

TEST(LateralPressure, MovesWithThePacking)
{
  Particles moved = packing();
  const Vec3 away(0.25, -0.5, 0.125);
  for (Vec3& centre : moved.centre)
    centre += away;
  const auto before = lateral_pressure(packing(), cylinder, Vec3::Zero());
  const auto after = lateral_pressure(moved, cylinder, away);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t k = 0; k < before.size(); ++k)
    EXPECT_LT((before[k].force - after[k].force).norm(), 1e-4 * cylinder.area()); // ties may turn
}

TEST(LateralPressure, FindsTheNearestSphereAsATrialOfAllDoes)
{
  const Particles& particles = packing();
  std::map<Index, double> area;
  const int n = 4 * int(std::ceil(2 * std::numbers::pi * cylinder.radius / 4 /
                                  (patch_share * std::ranges::min(particles.radius))));
  const int n_high =
      int(std::ceil(cylinder.height / (patch_share * std::ranges::min(particles.radius))));
  for (int k = 0; k < n_high; ++k)
    for (int j = 0; j < n; ++j) {
      const double angle = 2 * std::numbers::pi * (j + 0.5) / n;
      const Vec3 point(cylinder.radius * std::cos(angle), cylinder.radius * std::sin(angle),
                       (k + 0.5) * cylinder.height / n_high);
      double least = std::numeric_limits<double>::infinity();
      Index nearest = -1;
      for (std::size_t i = 0; i < particles.size(); ++i)
        if (const double gap = (particles.centre[i] - point).norm() - particles.radius[i];
            gap < least) {
          least = gap;
          nearest = Index(i);
        }
      area[nearest] += 1;
    }
  const auto found = lateral_pressure(particles, cylinder, Vec3::Zero());
  EXPECT_EQ(found.size(), area.size());
  for (const ParticleLoad& load : found)
    EXPECT_TRUE(area.contains(load.particle));
}

TEST(LateralPressure, RefusesSpheresOutsideOfTheCylinder)
{
  EXPECT_THROW(lateral_pressure(packing(), Cylinder{10e-3, 40e-3}, Vec3::Zero()),
               std::invalid_argument);
}

TEST(LateralPressure, IsRefusedBySolversThatCannotTakeIt)
{
  Assembly assembly = assemblies::block(3, 4, BondLaw{laws::burgers_set("asphalt"), 11, 1}, 1);
  const Loading loading = step_load(Loading::Control::force, -1, 1);
  EXPECT_NO_THROW(make_linear_model(assembly));
  assembly.confinement = {{20, Vec3(1, 0, 0), Vec3::Zero()}};
  EXPECT_NO_THROW(validate(assembly));
  EXPECT_THROW(make_linear_model(assembly), std::invalid_argument);
  EXPECT_THROW(make_events_model(assembly, loading, RateLaw{}, AfterBreakage::leave, 1),
               std::invalid_argument);
  EXPECT_THROW(make_dynamic_model(assembly, loading, RateLaw{}, DynamicSettings{}, 1, 0),
               std::invalid_argument);
  assembly.confinement = {{1000, Vec3(1, 0, 0), Vec3::Zero()}};
  EXPECT_THROW(validate(assembly), std::invalid_argument);
}

TEST(LateralPressure, LeavesAloneWhatTheSpecimenDoesNotCarry)
{
  Assembly assembly = assemblies::block(3, 4, BondLaw{laws::burgers_set("asphalt"), 11, 1}, 1);
  const Index carried = 20, alone = Index(assembly.particles.size());
  assembly.particles.centre.push_back(
      {30e-3, 4e-3, 6e-3}); // beside the block, in touch with nothing
  assembly.particles.radius.push_back(2e-3);
  assembly.particles.material_class.push_back(0);
  assembly.support.push_back(Support::free);
  assembly.confinement = {{carried, Vec3(-1, 0, 0), Vec3::Zero()},
                          {alone, Vec3(-1, 0, 0), Vec3::Zero()}};
  const Loading loading = step_load(Loading::Control::force, -1, 10);
  const QuasistaticModel model =
      make_quasistatic_model(assembly, loading, RateLaw{}, QuasistaticSettings{}, 1);
  const Eigen::VectorXd forces = carried_confinement(model, start(model).links);
  EXPECT_EQ(forces.segment<3>(model.dofs.first_dof[carried]), Vec3(-1, 0, 0));
  EXPECT_TRUE(forces.segment<6>(model.dofs.first_dof[alone]).isZero(0));
  QuasistaticSolver solver(model, 1);
  QuasistaticState state = start(model);
  while (state.end == RunEnd::running)
    state = solver.step(std::move(state));
  EXPECT_EQ(state.end, RunEnd::finished);
  EXPECT_EQ(state.centre[alone], assembly.particles.centre[alone]);
  EXPECT_LT(state.centre[carried].x(), assembly.particles.centre[carried].x());
}
