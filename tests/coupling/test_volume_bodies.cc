#include "fem/cell_states.h"
#include "tests/coupling/volumes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>

using namespace volumes;

namespace {

constexpr double edge = 0.01;

fem::Mesh<3> cube(int n_cells = 1)
{
  return fem::box(bodies::ranks, fem::Vec3::Constant(edge), {edge / n_cells, 0, false});
}

/// A cylinder between bonded platens: stresses differ a little from place to place.
fem::BodyLoads bonded_platens()
{
  return {{{"bottom", {0., 0., 0.}}, {"top", {0., 0., 1.}}}, {}, fem::Vec3::Zero()};
}

/// A beam that is clamped at one end and bent at the other: stresses differ much.
fem::Mesh<3> beam()
{
  return fem::box(bodies::ranks, fem::Vec3(0.08, 0.02, 0.02), {0.01, 0, false});
}
fem::BodyLoads bent()
{
  const std::optional<double> free;
  return {{{"left", {0., 0., 0.}}, {"right", {free, free, 1.}}}, {}, fem::Vec3::Zero()};
}

VolumeSettings settings_of(VolumeUse use, double exponent = 0.325)
{
  VolumeSettings settings;
  settings.use = use;
  settings.rate_law.exponent = exponent;
  settings.rate_law.floor = 1e-9;
  settings.breakage_tolerance = 1e-9;
  return settings;
}

/// Events of one volume under a constant stress, from scratch: every network is homogenised anew
/// without the bonds that are gone, creep is that of closed forms.
struct OwnRun {
  std::vector<double> times;
  std::vector<double> strains; ///< along z, after all that happens at each time
};

OwnRun own_run(const dem::VolumeElement& whole, const dem::Strengths& all, const Vec6& stress,
               const dem::RateLaw& rates, double end, std::size_t most_breakages)
{
  const dem::CreepLaw& law = whole.laws[0].creep;
  const double fluidity = law.maxwell_stiffness / *law.maxwell_viscosity;
  const double tau = dem::retardation_time(law.branches[0]);
  const double share = law.maxwell_stiffness / law.branches[0].stiffness;
  std::vector<dem::BondStatus> status(whole.bonds.size(), dem::BondStatus::intact);
  Vec6 viscous = Vec6::Zero(), kelvin = Vec6::Zero();
  OwnRun run;
  double t = 0;
  std::size_t n_broken = 0;
  while (n_broken < most_breakages) {
    dem::PeriodicContacts contacts{{}, {}, 0};
    std::vector<std::size_t> kept;
    for (std::size_t b = 0; b < status.size(); ++b)
      if (status[b] == dem::BondStatus::intact) {
        contacts.pairs.push_back(whole.bonds.ends[b]);
        contacts.shift.push_back(whole.shift[b]);
        kept.push_back(b);
      }
    const dem::VolumeElement now = dem::make_volume_element(whole.cell, whole.particles, contacts,
                                                            whole.laws, whole.pair_laws);
    const dem::Homogenization answer = dem::homogenize(now);
    const Vec6 elastic = dem::compliance(answer.stiffness) * stress;
    double worst = 0;
    std::size_t critical = 0;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      const dem::Vec3 normal = dem::branch(now, k).normalized(),
                      force = answer.per_strain[k].force * elastic;
      const double pull = force.dot(normal), shear = (force - pull * normal).norm();
      const double ratio = std::max(pull / all.normal[kept[k]], shear / all.shear[kept[k]]);
      if (ratio > worst) {
        worst = ratio;
        critical = kept[k];
      }
    }
    const auto kelvin_at = [&](double dt) {
      return Vec6(share * elastic + std::exp(-dt / tau) * (kelvin - share * elastic));
    };
    const auto is_over = [&](double dt) {
      const Vec6 rate = fluidity * elastic + (share * elastic - kelvin_at(dt)) / tau;
      const double principal = Eigen::SelfAdjointEigenSolver<dem::Mat3>(dem::from_mandel(rate))
                                   .eigenvalues()
                                   .cwiseAbs()
                                   .maxCoeff();
      return worst >= dem::strength_factor(rates, principal);
    };
    double dt = 0;
    if (!is_over(0)) {
      if (!run.times.empty() && t > run.times.back())
        run.times.push_back(t);
      double low = 0, high = end - t;
      if (!is_over(high))
        break;
      for (int k = 0; k < 200; ++k)
        (is_over(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
      dt = high;
    }
    viscous += dt * fluidity * elastic;
    kelvin = kelvin_at(dt);
    t += dt;
    status[critical] = dem::BondStatus::gone;
    ++n_broken;
    run.times.push_back(t);
    run.strains.push_back((viscous + kelvin)[2]);
  }
  return run;
}

} // namespace

TEST(VolumeBodies, OneSphereCellsAreTheirClosedForms)
{
  const double diameter = 4e-3, kn = 1e6, ks = kn / 11;
  const struct {
    dem::Crystal crystal;
    double young; ///< along an edge of the cube [Pa]
  } cases[] = {{dem::simple_cubic(diameter), kn / diameter},
               {dem::primitive_face_centred_cubic(diameter), 0}};
  for (const auto& [crystal, given] : cases) {
    double young = given;
    if (young == 0) {
      const double c11 = std::sqrt(2.) * (kn + ks) / diameter,
                   c12 = (kn - ks) / (std::sqrt(2.) * diameter);
      young = (c11 - c12) * (c11 + 2 * c12) / (c11 + c12);
    }
    const VolumeFamily family =
        unbreakable(dem::bonded_crystal(crystal, diameter, elements::law()));
    Body body(cube(2), uniaxial(), {family}, settings_of(VolumeUse::all_live), 2);
    const double force = -40;
    body.run_to(constant_force(force), 200);
    const dem::CreepLaw& creep = family.element->creep();
    const double expected = force / (edge * edge) / young * edge * creep.maxwell_stiffness *
                            dem::creep_compliance(creep, 200);
    EXPECT_NEAR(body.specimen.drive_displacement(), expected, 1e-10 * std::abs(expected));
  }
}

TEST(VolumeBodies, OneElementOfOneVolumeBreaksAsTheVolumeDoesEventByEvent)
{
  const dem::VolumeElement element = elements::random_cube(60, 1);
  const dem::Strengths strengths = weibull(element, 16, 0.5);
  VolumeSettings settings = settings_of(VolumeUse::adaptive);
  settings.rate_law.floor = 1e-12;
  const double stress = -4e5;
  Vec6 uniform = Vec6::Zero();
  uniform[2] = stress;
  const OwnRun own = own_run(element, strengths, uniform, settings.rate_law, 1e4, 25);
  ASSERT_EQ(own.times.size(), 25u);
  ASSERT_GT(own.times.back(), own.times.front()); // some are delayed

  Body body(cube(), uniaxial(), {make_family(element, strengths, dem::AfterBreakage::leave)},
            settings);
  // without shear of the cell's faces: the stress is that of the own run
  const fem::History history = constant_force(stress * edge * edge);
  const double n_points =
      dealii::Utilities::MPI::sum(double(body.specimen.elements().n_points()), bodies::ranks);
  fem::apply_jump(body.specimen, body.points, body.state, history);
  std::vector<double> times(std::size_t(body.n_broken() / n_points), 0.);
  while (times.size() < own.times.size()) {
    fem::march_step(body.specimen, body.points, body.state, history, {1e-5, 1e-2, 3}, 1e4);
    times.resize(std::size_t(body.n_broken() / n_points), body.state.time);
  }
  for (std::size_t k = 0; k < own.times.size(); ++k)
    EXPECT_NEAR(times[k], own.times[k], 1e-7 * own.times[k]) << k;
}

TEST(VolumeBodies, ProportionalMeansElasticTimesTheCreepFunction)
{
  const VolumeFamily family = random_family(60, 1e9, dem::AfterBreakage::leave);
  Body body(fem::cylinder(bodies::ranks, 0.06, 0.12, {0.02, 0, false}), bonded_platens(), {family},
            settings_of(VolumeUse::adaptive));
  const fem::History history = constant_force(-1000);
  fem::apply_jump(body.specimen, body.points, body.state, history);
  const double elastic = body.specimen.drive_displacement();
  body.run_to(history, 500);
  const dem::CreepLaw& creep = family.element->creep();
  const double expected = elastic * creep.maxwell_stiffness * dem::creep_compliance(creep, 500);
  EXPECT_NEAR(body.specimen.drive_displacement(), expected, 1e-9 * std::abs(expected));
  EXPECT_EQ(body.n_live(), 0);
}

TEST(VolumeBodies, AdaptiveIsAllLive)
{
  for (const dem::AfterBreakage rule : {dem::AfterBreakage::leave, dem::AfterBreakage::pressed}) {
    const std::vector<VolumeFamily> families{random_family(60, 60, rule, 1),
                                             random_family(60, 60, rule, 2)};
    const fem::Mesh<3> mesh = beam();
    Body adaptive(mesh, bent(), families, settings_of(VolumeUse::adaptive), 1, 1e-11);
    Body live(mesh, bent(), families, settings_of(VolumeUse::all_live), 1, 1e-11);
    const fem::History history = constant_force(-10);
    adaptive.run_to(history, 100);
    live.run_to(history, 100);
    const double n_points = double(live.n_live());
    EXPECT_GT(adaptive.n_live(), 0.03 * n_points);
    EXPECT_LT(adaptive.n_live(), 0.6 * n_points);
    EXPECT_EQ(adaptive.n_broken(), live.n_broken());
    EXPECT_NEAR(adaptive.specimen.drive_displacement(), live.specimen.drive_displacement(),
                1e-8 * std::abs(live.specimen.drive_displacement()));
  }
}

TEST(VolumeBodies, GoOnAfterARestartInTheMidstOfAnAvalanche)
{
  const dem::VolumeElement element = elements::random_cube(60, 1);
  const VolumeFamily family =
      make_family(element, weibull(element, 16, 0.5), dem::AfterBreakage::pressed);
  VolumeSettings settings = settings_of(VolumeUse::adaptive);
  settings.rate_law.window = 1;
  const fem::Mesh<3> mesh = cube();
  const fem::History history = constant_force(-4e5 * edge * edge);
  Body whole(mesh, uniaxial(), {family}, settings);
  fem::apply_jump(whole.specimen, whole.points, whole.state, history);
  while (!(whole.state.time > 0 && !whole.state.is_settled) && whole.state.time < 1e5)
    fem::march_step(whole.specimen, whole.points, whole.state, history, {1e-5, 1e-2, 3}, 1e5);
  ASSERT_FALSE(whole.state.is_settled);
  ASSERT_FALSE(whole.state.has_lost);
  Body again(mesh, uniaxial(), {family}, settings);
  fem::restore_cell_states(again.specimen, again.points,
                           fem::cell_states(whole.specimen, whole.points),
                           whole.specimen.drive_displacement());
  again.points.set_last_step(whole.points.last_step());
  again.state = whole.state;
  const double before = whole.n_broken();
  for (Body* body : {&whole, &again})
    fem::march_step(body->specimen, body->points, body->state, history, {1e-5, 1e-2, 3}, 1e5);
  EXPECT_GT(whole.n_broken(), before);
  EXPECT_EQ(whole.n_broken(), again.n_broken());
  EXPECT_EQ(whole.state.is_settled, again.state.is_settled);
  EXPECT_NEAR(whole.specimen.drive_displacement(), again.specimen.drive_displacement(),
              1e-9 * std::abs(whole.specimen.drive_displacement()));
}

TEST(VolumeBodies, ThreadsChangeNothing)
{
  const std::vector<VolumeFamily> families{random_family(60, 60, dem::AfterBreakage::pressed, 1)};
  VolumeSettings one = settings_of(VolumeUse::adaptive), two = one;
  two.n_threads = 2;
  const fem::Mesh<3> mesh = beam();
  Body first(mesh, bent(), families, one), second(mesh, bent(), families, two);
  first.run_to(constant_force(-10), 50);
  second.run_to(constant_force(-10), 50);
  EXPECT_GT(first.n_broken(), 0);
  EXPECT_EQ(first.n_broken(), second.n_broken());
  EXPECT_NEAR(first.specimen.drive_displacement(), second.specimen.drive_displacement(),
              1e-12 * std::abs(first.specimen.drive_displacement()));
}

TEST(VolumeBodies, DrivenApartTheyLoseTheirStress)
{
  Body body(cube(), uniaxial(), {random_family(60, 10, dem::AfterBreakage::leave)},
            settings_of(VolumeUse::adaptive, 0));
  const fem::History history = constant_speed(5e-3 * edge);
  double largest = 0;
  fem::apply_jump(body.specimen, body.points, body.state, history);
  while (body.state.time < 40) {
    fem::march_step(body.specimen, body.points, body.state, history, {1e-4, 1e-2, 3}, 40);
    largest = std::max(largest, body.specimen.drive_force());
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(std::abs(body.specimen.drive_force()), 0.05 * largest);
}
