#include "tests/coupling/volumes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>

using namespace volumes;

namespace {

/// One point led through strains.
struct Point {
  VolumePoints points;
  double time = 0, pace = 1; ///< [s]; reduced over real time

  Point(const VolumeFamily& family, const VolumeSettings& settings, double size_ratio = 1)
      : points({family}, {0}, {size_ratio}, settings, 0)
  {
  }

  Vec6 attempt(const Vec6& increment, double step)
  {
    points.begin_step(time, step);
    return points.evaluate(std::span(&increment, 1), pace * step).stress[0];
  }

  void move(const Vec6& increment, double step)
  {
    attempt(increment, step);
    points.commit();
    time += step;
  }

  Mat6 tangent(double step)
  {
    const Vec6 still = Vec6::Zero();
    points.begin_step(time, step);
    return points.evaluate(std::span(&still, 1), step).tangent[0];
  }

  /// Moves to the end of a step, or to the first change; what is overloaded breaks.
  void march(Vec6 increment, double step)
  {
    attempt(increment, step);
    const double share = points.share_without_change();
    move(share * increment, share * step);
    while (points.overload() >= 1) {
      points.change(points.overload());
      move(Vec6::Zero(), 0);
    }
  }
};

Vec6 some_strain()
{
  return 1e-3 * (Vec6() << 1, -0.5, 0.2, 0.7, -0.3, 0.4).finished();
}

} // namespace

TEST(VolumePoints, IntactAreTheirLaw)
{
  const VolumeFamily family = random_family(60, 1e9, dem::AfterBreakage::leave);
  const fem::ComplianceLaw law = law_of(family);
  Point volume(family, {});
  fem::LawPoints points(std::span(&law, 1), {0}, fem::TimeScheme::stress_linear);
  const double steps[] = {0, 1, 7, 0, 100, 0.01, 3000};
  Vec6 increment = some_strain();
  const double weight = 1;
  for (const double step : steps) {
    volume.attempt(increment, step);
    const Vec6 expected = points.evaluate(std::span(&increment, 1), step).stress[0];
    EXPECT_NEAR(volume.points.step_error(std::span(&weight, 1)).square,
                points.step_error(std::span(&weight, 1)).square,
                1e-8 * points.step_error(std::span(&weight, 1)).square);
    volume.points.commit();
    volume.time += step;
    points.commit();
    EXPECT_LT((volume.points.stress()[0] - expected).norm(), 1e-11 * expected.norm()) << step;
    increment = (Vec6() << increment.tail<5>(), -0.5 * increment[0]).finished();
  }
}

TEST(VolumePoints, TangentIsThatOfDifferences)
{
  VolumeSettings settings;
  settings.rate_law.exponent = 0;
  Point point(random_family(60, 10, dem::AfterBreakage::pressed), settings);
  for (int k = 0; k < 12; ++k)
    point.march(some_strain(), 2);
  ASSERT_GT(point.points.n_broken(), 10u);
  for (const double step : {0., 5., 500.}) {
    const Mat6 tangent = point.tangent(step);
    Mat6 differences;
    const double size = 1e-5;
    for (int k = 0; k < 6; ++k)
      differences.col(k) =
          (point.attempt(size * Vec6::Unit(k), step) - point.attempt(-size * Vec6::Unit(k), step)) /
          (2 * size);
    EXPECT_LT((tangent - differences).norm(), 1e-9 * tangent.norm());
  }
}

TEST(VolumePoints, RejectedStepsLeaveNoTrace)
{
  const VolumeFamily family = random_family(60, 10, dem::AfterBreakage::pressed);
  Point one(family, {}), other(family, {});
  for (int k = 0; k < 5; ++k) {
    one.march(some_strain(), 2);
    other.attempt(-3 * some_strain(), 100);
    (void)other.points.share_without_change();
    other.march(some_strain(), 2);
  }
  EXPECT_GT(one.points.n_broken(), 0u);
  EXPECT_EQ(one.points.stress()[0], other.points.stress()[0]);
}

TEST(VolumePoints, StoredAndRestoredGoesOnBitForBit)
{
  const VolumeFamily family = random_family(60, 10, dem::AfterBreakage::pressed);
  Point one(family, {});
  for (int k = 0; k < 4; ++k)
    one.march(some_strain(), 2);
  ASSERT_GT(one.points.n_broken(), 0u);
  Point other(family, {});
  std::vector<double> numbers(one.points.numbers_per_point());
  one.points.store(0, numbers);
  other.points.restore(0, numbers);
  other.points.set_last_step(one.points.last_step());
  other.time = one.time;
  for (int k = 0; k < 4; ++k) {
    one.march(some_strain(), 2);
    other.march(some_strain(), 2);
  }
  EXPECT_EQ(one.points.stress()[0], other.points.stress()[0]);
  EXPECT_EQ(one.points.n_broken(), other.points.n_broken());
}

TEST(VolumePoints, BreakWhereForceMeetsStrength)
{
  VolumeSettings settings;
  settings.rate_law.exponent = 0; // strengths as they are
  const VolumeFamily family = random_family(60, 10, dem::AfterBreakage::leave);
  Point point(family, settings);
  const double ratio =
      dem::largest_ratio(*family.element->intact(), family.element->strengths(), some_strain());
  point.attempt(2 / ratio * some_strain(), 1e-9); // elastic: no time to creep
  EXPECT_NEAR(point.points.share_without_change(), 0.5, 1e-9);
  point.march(2 / ratio * some_strain(), 1e-9);
  EXPECT_NEAR(point.time, 0.5e-9, 1e-18);
  EXPECT_GE(point.points.n_broken(), 1u);
}

TEST(VolumePoints, BondsWithoutStrengthBreakUnderTheFirstLoad)
{
  dem::VolumeElement element = elements::random_cube(60, 1);
  dem::Strengths strengths = weibull(element, 1e3, 0.5);
  for (std::size_t b = 0; b < strengths.normal.size(); b += 10)
    strengths.normal[b] = strengths.shear[b] = 0;
  const std::size_t n_weak = (strengths.normal.size() + 9) / 10;
  Point point(make_family(std::move(element), std::move(strengths), dem::AfterBreakage::pressed),
              {});
  point.march(1e-3 * some_strain(), 1e-3);
  EXPECT_EQ(point.points.n_broken(), n_weak);
  EXPECT_TRUE(point.points.stress()[0].allFinite());
}

TEST(VolumePoints, ReducedTimeIsThatOfScaledViscosities)
{
  const double shift = 4; // colder: viscosities times this
  dem::VolumeElement element = elements::random_cube(60, 1), cold = element;
  cold.laws[0].creep = dem::with_viscosities_scaled(cold.laws[0].creep, shift);
  const dem::Strengths strengths = weibull(element, 10, 0.5);
  VolumeSettings settings;
  settings.rate_law.floor = 1e-12;
  for (const double window : {0., 3.}) {
    settings.rate_law.window = window;
    settings.first_pace = 1;
    Point direct(make_family(cold, strengths, dem::AfterBreakage::leave), settings);
    settings.first_pace = 1 / shift;
    Point reduced(make_family(element, strengths, dem::AfterBreakage::leave), settings);
    reduced.pace = 1 / shift;
    for (int k = 0; k < 6; ++k)
      for (Point* point : {&direct, &reduced})
        point->march(some_strain(), k == 0 ? 0 : 2);
    EXPECT_GT(direct.points.n_broken(), 0u);
    EXPECT_EQ(direct.points.n_broken(), reduced.points.n_broken()) << window;
    EXPECT_NEAR(direct.time, reduced.time, 1e-9);
    EXPECT_LT((direct.points.stress()[0] - reduced.points.stress()[0]).norm(),
              1e-8 * direct.points.stress()[0].norm());
  }
}

TEST(VolumePoints, TheirOwnSizeChangesNothing)
{
  const VolumeFamily family = random_family(60, 10, dem::AfterBreakage::leave);
  std::vector<dem::BondStatus> status = family.element->intact()->status;
  for (std::size_t b = 0; b < status.size(); b += 4)
    status[b] = dem::BondStatus::gone;
  const auto damage = family.element->answer(status);
  const LiveVolume same = live_volume(family, damage, 1, 0);
  EXPECT_LT((same.stiffness - damage->stiffness).norm(), 1e-7 * damage->stiffness.norm());
  EXPECT_LT((same.focus - Mat6::Identity()).norm(), 1e-12);
}

TEST(VolumePoints, InALargerElementTheyAreInSeriesWithIntactMaterial)
{
  const VolumeFamily family = random_family(60, 10, dem::AfterBreakage::leave);
  std::vector<dem::BondStatus> status = family.element->intact()->status;
  for (std::size_t b = 0; b < status.size(); b += 4)
    status[b] = dem::BondStatus::gone;
  const auto damage = family.element->answer(status);
  const double r = 0.3;
  const LiveVolume mixed = live_volume(family, damage, r, 0);
  const Mat6 expected =
      (1 - r) * dem::compliance(family.stiffness()) + r * dem::compliance(damage->stiffness);
  EXPECT_LT((mixed.stiffness.inverse() - expected).norm(), 1e-6 * expected.norm());
  // the volume is under the stress of the point
  EXPECT_LT((damage->stiffness * mixed.focus - mixed.stiffness).norm(),
            1e-7 * mixed.stiffness.norm());
}

TEST(VolumePoints, WithoutBondsThePointFailsAndDoesNotCrash)
{
  VolumeSettings settings;
  settings.rate_law.exponent = 0;
  Point point(random_family(40, 1, dem::AfterBreakage::leave), settings);
  for (int k = 0; k < 200; ++k)
    point.march(some_strain(), 1e-6);
  EXPECT_LT(point.points.stress()[0].norm(),
            1e-4 * (point.points.family(0).stiffness() * point.points.strain()[0]).norm());
  EXPECT_TRUE(point.points.stress()[0].allFinite());
}

TEST(StrainWindow, KeepsWhatTheWindowNeeds)
{
  StrainWindow window(2);
  const auto strain = [](double t) {
    return std::vector<Vec6>{t * Vec6::Ones(), -t * Vec6::Ones()};
  };
  for (int k = 0; k <= 1000; ++k)
    window.append(k, strain(k), k - 10);
  EXPECT_NEAR(window.at(0, 992.5)[0], 992.5, 1e-12);
  EXPECT_NEAR(window.at(1, 990)[3], -990, 1e-12);
  EXPECT_LE(window.first_time(), 990);
  EXPECT_EQ(window.at(1, 2000)[3], -1000);
  std::vector<double> numbers(StrainWindow::n_numbers);
  StrainWindow copy(2);
  for (std::size_t q = 0; q < 2; ++q) {
    window.store(q, numbers);
    copy.restore(q, numbers);
  }
  EXPECT_EQ(copy.at(0, 995.25), window.at(0, 995.25));
}

TEST(StrainWindow, HoldsLongWindowsWithFewTimes)
{
  StrainWindow window(1);
  for (int k = 0; k <= 1000; ++k) {
    const std::vector<Vec6> strain{std::sqrt(double(k)) * Vec6::Ones()};
    window.append(k, strain, 0);
  }
  EXPECT_EQ(window.first_time(), 0);
  EXPECT_NEAR(window.at(0, 500)[0], std::sqrt(500.), 0.1);
}
