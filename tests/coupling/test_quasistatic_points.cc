#include "coupling/quasistatic_points.h"
#include "dem/element_creep.h"
#include "fem/cell_states.h"
#include "tests/coupling/volumes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

using namespace volumes;

namespace {

dem::QuasistaticSettings small_motion(dem::AfterBreakage rule)
{
  dem::QuasistaticSettings settings;
  settings.residual_tolerance = 1e-11;
  settings.geometry = dem::Geometry::small;
  settings.after_breakage = rule;
  return settings;
}

QuasistaticPoints::Volume followed_volume(dem::VolumeElement element, dem::Strengths strengths,
                                          const dem::QuasistaticSettings& settings)
{
  return std::make_shared<const dem::QuasistaticVolume>(
      dem::make_quasistatic_volume(std::move(element), std::move(strengths), settings));
}

/// The volume of a family, followed by the quasi-static solver.
QuasistaticPoints::Volume of(const VolumeFamily& family, const dem::QuasistaticSettings& settings)
{
  return followed_volume(family.element->element(), family.element->strengths(), settings);
}

QuasistaticPoints points_of(const VolumeFamily& family, std::size_t n_points,
                            const VolumeSettings& settings)
{
  const std::vector<int> all(n_points, 0);
  std::optional<VolumePoints> law;
  if (settings.use == VolumeUse::adaptive)
    law.emplace(std::vector<VolumeFamily>{family}, all, std::vector<double>(n_points, 1), settings,
                0.);
  return {{of(family, small_motion(family.element->after_breakage()))},
          all,
          settings,
          0,
          std::move(law)};
}

/// Points led through strains; what is overloaded breaks, most loaded first.
template <typename Points>
struct Led {
  Points points;
  double time = 0;

  void attempt(const Vec6& increment, double step)
  {
    points.begin_step(time, step);
    (void)points.evaluate(std::span(&increment, 1), step);
  }

  void move(const Vec6& increment, double step)
  {
    attempt(increment, step);
    points.commit();
    time += step;
  }

  /// The first load comes at once.
  void march(Vec6 increment, double step)
  {
    if (time == 0)
      move(1e-3 * increment, 0);
    while (step > 0) {
      attempt(increment, step);
      const double share = points.share_without_change();
      move(share * increment, share * step);
      increment *= 1 - share;
      step *= 1 - share;
      while (points.overload() >= 1) {
        points.change(points.overload());
        move(Vec6::Zero(), 0);
      }
      if (share == 1)
        return;
    }
  }
};

Vec6 some_strain()
{
  return 1e-3 * (Vec6() << 1, -0.5, 0.2, 0.7, -0.3, 0.4).finished();
}

VolumeSettings settings_of(VolumeUse use)
{
  VolumeSettings settings;
  settings.use = use;
  settings.breakage_tolerance = 1e-4;
  settings.rate_law.window = 3;
  return settings;
}

/// A cube of one element pulled or pressed along z, whose points the quasi-static solver follows.
struct FollowedCube {
  static constexpr double edge = 0.02;
  fem::Specimen<3> specimen;
  QuasistaticPoints points;
  fem::MarchState state;

  template <typename Make>
  explicit FollowedCube(const Make& make)
      : specimen(fem::box(MPI_COMM_SELF, {edge, edge, edge}, {edge, 0, false}),
                 {1, fem::Dilatation::pointwise}, uniaxial(), 1e-9),
        points(make(specimen.elements().n_points()))
  {
  }

  void run_to(const fem::History& history, double end, double tolerance = 1e-4)
  {
    if (state.time == 0 && state.n_steps == 0)
      fem::apply_jump(specimen, points, state, history);
    while (state.time < end && !state.has_lost)
      fem::march_step(specimen, points, state, history, {tolerance, 1e-2, 3}, end);
  }
};

} // namespace

TEST(QuasistaticPoints, BreakTheBondsThatTheClosedFormBreaks)
{
  const VolumeFamily family = random_family(60, 20, dem::AfterBreakage::leave);
  Led<VolumePoints> closed{{{family}, {0}, {1}, settings_of(VolumeUse::adaptive), 0}};
  Led<QuasistaticPoints> adaptive{points_of(family, 1, settings_of(VolumeUse::adaptive))};
  Led<QuasistaticPoints> live{points_of(family, 1, settings_of(VolumeUse::all_live))};
  EXPECT_EQ(adaptive.points.n_live(), 0u);
  EXPECT_EQ(live.points.n_live(), 1u);
  for (int k = 0; k < 8; ++k) {
    closed.march(some_strain(), 2);
    adaptive.march(some_strain(), 2);
    live.march(some_strain(), 2);
    // steps are cut at times that differ by the tolerance, and e is linear within each
    const double size = closed.points.stress()[0].norm();
    EXPECT_EQ(adaptive.points.n_broken(), closed.points.n_broken()) << k;
    EXPECT_EQ(live.points.n_broken(), closed.points.n_broken()) << k;

    EXPECT_LT((adaptive.points.stress()[0] - closed.points.stress()[0]).norm(), 1e-5 * size) << k;
    EXPECT_LT((live.points.stress()[0] - closed.points.stress()[0]).norm(), 1e-5 * size) << k;
  }
  EXPECT_GT(closed.points.n_broken(), 10u);
  EXPECT_NEAR(adaptive.points.damage(0).stiffness_loss, closed.points.damage(0).stiffness_loss,
              1e-6);
  EXPECT_NEAR(adaptive.points.strength_use(0), closed.points.strength_use(0), 1e-3);
}

TEST(QuasistaticPoints, FrictionHoldsWhatBondsHeld)
{
  double sideways[2];
  for (const bool slides : {false, true}) {
    const auto rule = slides ? dem::AfterBreakage::friction : dem::AfterBreakage::pressed;
    dem::VolumeElement element = elements::random_cube(60, 1);
    dem::Strengths strengths = weibull(element, 3, 0.3);
    VolumeSettings settings = settings_of(VolumeUse::all_live);
    settings.rate_law.exponent = 0;
    settings.breakage_tolerance = 0.05;
    dem::QuasistaticSettings followed = small_motion(rule);
    followed.residual_tolerance = 1e-6;
    const auto volume = followed_volume(std::move(element), std::move(strengths), followed);
    Led<QuasistaticPoints> led{{{volume}, {0}, settings, 0, {}}};
    const Vec6 pressed = -1e-3 * (Vec6() << 1, 1, 1, 0, 0, 0).finished();
    const Vec6 sheared = 4e-4 * (Vec6() << 0, 0, 0, 0, 0, 1).finished();
    for (int k = 0; k < 4; ++k)
      led.march(pressed, 1e-3);
    EXPECT_GT(led.points.n_broken(), 20u);
    for (int k = 0; k < 4; ++k)
      led.march(sheared, 1e-3);
    EXPECT_FALSE(led.points.has_lost());
    sideways[slides] = led.points.stress()[0][5];
  }
  EXPECT_GT(sideways[1], 1.1 * sideways[0]);
}

TEST(QuasistaticPoints, StoredAndRestoredGoOn)
{
  const VolumeFamily family = random_family(60, 10, dem::AfterBreakage::pressed);
  for (const VolumeUse use : {VolumeUse::adaptive, VolumeUse::all_live}) {
    Led<QuasistaticPoints> one{points_of(family, 1, settings_of(use))};
    for (int k = 0; k < 4; ++k)
      one.march(some_strain(), 2);
    ASSERT_GT(one.points.n_broken(), 0u);
    Led<QuasistaticPoints> other{points_of(family, 1, settings_of(use)), one.time};
    std::vector<double> numbers(one.points.numbers_per_point());
    one.points.store(0, numbers);
    other.points.restore(0, numbers);
    other.points.set_last_step(one.points.last_step());
    EXPECT_EQ(one.points.n_broken(), other.points.n_broken());
    for (int k = 0; k < 4; ++k) {
      one.march(some_strain(), 2);
      other.march(some_strain(), 2);
    }
    EXPECT_LT((one.points.stress()[0] - other.points.stress()[0]).norm(),
              1e-9 * one.points.stress()[0].norm());
    EXPECT_EQ(one.points.n_broken(), other.points.n_broken());
  }
}

TEST(QuasistaticPoints, OneElementOfTwoLawsCreepsAsItsVolume)
{
  const dem::VolumeElement element = elements::two_law_cube(40, 2);
  const std::vector<double> endless(element.bonds.size(), infinity);
  const auto volume =
      followed_volume(element, {endless, endless, 0}, small_motion(dem::AfterBreakage::leave));
  FollowedCube cube([&](std::size_t n) {
    return QuasistaticPoints({volume}, std::vector<int>(n, 0), settings_of(VolumeUse::all_live), 0,
                             {});
  });
  const double stress = -4e5, end = 200;
  cube.run_to(constant_force(stress * cube.edge * cube.edge), end);
  const dem::ElementModel model = dem::make_element_model(element);
  const double times[] = {0, end};
  const dem::CreepHistory creep = dem::creep_compliance(model, times, 1e-6);
  const Vec6 expected = stress * creep.compliance.back().col(2);
  EXPECT_NEAR(cube.points.strain()[0][2], expected[2], 3e-4 * std::abs(expected[2]));
  EXPECT_GT(std::abs(expected[2]), 2 * std::abs(stress * creep.compliance.front()(2, 2)));
}

TEST(QuasistaticPoints, ABodyGoesOnToTheEndOfItsVolumes)
{
  dem::VolumeElement element = elements::random_cube(30, 2);
  dem::Strengths strengths = weibull(element, 10, 0.5);
  dem::QuasistaticSettings finite;
  finite.residual_tolerance = 1e-8;
  const auto volume = followed_volume(std::move(element), std::move(strengths), finite);
  VolumeSettings settings = settings_of(VolumeUse::all_live);
  settings.breakage_tolerance = 0.1;
  FollowedCube cube([&](std::size_t n) {
    return QuasistaticPoints({volume}, std::vector<int>(n, 0), settings, 0, {});
  });
  EXPECT_NO_THROW(cube.run_to(constant_force(-3e6 * cube.edge * cube.edge), 100));
  EXPECT_TRUE(cube.state.has_lost);
  EXPECT_GT(cube.points.n_broken(), 0.3 * double(cube.points.n_bonds()));
}

TEST(QuasistaticPoints, ABodyCreepsAsInTheClosedForm)
{
  const dem::VolumeElement element = elements::random_cube(60, 1);
  const dem::Strengths clamped = dem::draw_strengths(
      {dem::NormalStrength{54, 44}, dem::NonpositiveRule::clamp, 0.5}, element.bonds.id, 1);
  VolumeSettings settings = settings_of(VolumeUse::adaptive);
  settings.breakage_tolerance = 0.02;
  settings.rate_law.floor = 1e-7; // at the load, strengths see the rate of creep
  settings.rate_law.window = 1;
  struct Case {
    dem::AfterBreakage rule;
    dem::Strengths strengths;
  };
  for (const auto& [rule, strengths] :
       {Case{dem::AfterBreakage::leave, clamped}, Case{dem::AfterBreakage::pressed, clamped},
        Case{dem::AfterBreakage::leave, weibull(element, 22, 0.5)}}) {
    const VolumeFamily family = make_family(element, strengths, rule);
    FollowedCube followed(
        [&](std::size_t n_points) { return points_of(family, n_points, settings); });
    const double edge = FollowedCube::edge;
    const fem::History history = constant_force(-2e5 * edge * edge);
    Body closed(fem::box(MPI_COMM_SELF, {edge, edge, edge}, {edge, 0, false}), uniaxial(), {family},
                settings, 1, 1e-9);
    followed.run_to(history, 20);
    closed.run_to(history, 20);
    EXPECT_GT(closed.points.n_broken(), 0u);
    EXPECT_EQ(followed.points.n_broken(), closed.points.n_broken());
    // contacts that have opened may close again here; and what breaks later, within the step
    // tolerance, breaks at another time
    const bool all_at_once = closed.state.n_changes <= 2;
    const double tolerance = rule == dem::AfterBreakage::leave && all_at_once ? 2e-5 : 2e-3;
    EXPECT_NEAR(followed.points.strain()[0][2], closed.points.strain()[0][2],
                tolerance * std::abs(closed.points.strain()[0][2]));
  }
}
