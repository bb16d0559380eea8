#include "apps/run_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace apps;

namespace {

/// Creep by t^0.3 at the given times, one bond broken every ten seconds.
RunCurve creep(const std::vector<double>& times, double factor = 1)
{
  RunCurve curve{"strain", times, {}, {}, std::nullopt};
  for (const double t : times) {
    curve.value.push_back(factor * std::pow(t, 0.3));
    curve.n_broken.push_back(std::floor(t / 10));
  }
  return curve;
}

const std::vector<double> times{0, 1, 10, 20, 50, 100};

} // namespace

TEST(RunComparison, OfARunWithItselfIsZero)
{
  const RunErrors errors = compare(creep(times), creep(times));
  EXPECT_EQ(errors.largest, 0);
  EXPECT_EQ(errors.at_end, 0);
  EXPECT_EQ(errors.broken, 0);
  EXPECT_EQ(errors.last_time, 100);
  EXPECT_EQ(errors.ruptures, Ruptures::neither);
  EXPECT_FALSE(errors.rupture);
}

TEST(RunComparison, MeasuresTheLargestDifferenceOverTheLargestValue)
{
  RunCurve run = creep(times);
  run.value[2] += 0.1; // at 10 s, where the strain is about half of what it is at the end
  const RunErrors errors = compare(run, creep(times));
  EXPECT_NEAR(*errors.largest, 0.1 / std::pow(100, 0.3), 1e-14);
  EXPECT_EQ(errors.at_end, 0);
  EXPECT_NEAR(*compare(creep(times, 1.02), creep(times)).at_end, 0.02, 1e-14);
}

TEST(RunComparison, DoesNotDependOnTheUnitsOfTheValue)
{
  const RunErrors a = compare(creep(times, 1.02), creep(times)),
                  b = compare(creep(times, 1.02e6), creep(times, 1e6));
  EXPECT_NEAR(*a.largest, *b.largest, 1e-14);
}

TEST(RunComparison, InterpolatesRunsThatStopALittleBeyondTheStatedTimes)
{
  std::vector<double> later = times;
  for (double& t : later)
    t *= 1.001;
  const RunErrors errors = compare(creep(later), creep(times));
  EXPECT_EQ(errors.last_time, 100);
  EXPECT_LT(*errors.largest, 2e-3);
  EXPECT_LT(*errors.at_end, 2e-4); // of a chord between 50 s and 100 s, near its end
}

TEST(RunComparison, EndsWhereTheFirstOfTheTwoEnds)
{
  const RunCurve first_part = creep({0, 1, 10, 20}, 1.1);
  const RunErrors errors = compare(first_part, creep(times));
  EXPECT_EQ(errors.last_time, 20);
  EXPECT_NEAR(*errors.largest, 0.1, 1e-14);
  EXPECT_EQ(errors.broken, 0);
  EXPECT_NEAR(*compare(creep(times), first_part).at_end, 1 - 1 / 1.1, 1e-14);
}

TEST(RunComparison, LeavesOutTheInstantsAtWhichTheLoadJumps)
{
  const std::vector<double> with_jump{0, 1, std::nextafter(10.0, 0.0), 10, 20};
  RunCurve run = creep(with_jump);
  run.value[0] += 1;
  run.value[2] += 1;
  run.value[3] += 1;
  EXPECT_EQ(compare(run, creep(with_jump)).largest, 0);
}

TEST(RunComparison, CountsBrokenBondsOverThoseOfTheReference)
{
  RunCurve run = creep(times), intact = creep(times);
  run.n_broken.back() = 11;
  EXPECT_NEAR(*compare(run, creep(times)).broken, 0.1, 1e-14);
  intact.n_broken.assign(times.size(), 0);
  EXPECT_FALSE(compare(run, intact).broken) << "there is nothing to measure it by";
  EXPECT_EQ(compare(intact, intact).broken, 0);
}

TEST(RunComparison, SaysWhichRunRuptures)
{
  RunCurve early = creep(times), late = creep(times);
  early.rupture_time = 90;
  late.rupture_time = 100;
  const RunErrors both = compare(early, late);
  EXPECT_EQ(both.ruptures, Ruptures::both);
  EXPECT_NEAR(*both.rupture, 0.1, 1e-14);
  EXPECT_EQ(compare(early, creep(times)).ruptures, Ruptures::only_run);
  EXPECT_EQ(compare(creep(times), late).ruptures, Ruptures::only_reference);
  EXPECT_FALSE(compare(creep(times), late).rupture);
}

TEST(RunComparison, DoesNotHideWhatIsNotANumber)
{
  RunCurve run = creep(times);
  run.value[1] = NAN;
  EXPECT_FALSE(compare(run, creep(times)).largest);
}

TEST(RunComparison, OfRunsThatReachedNothingIsEmpty)
{
  const RunErrors errors = compare(creep({}), creep(times));
  EXPECT_FALSE(errors.largest);
  EXPECT_FALSE(errors.broken);
}
