#include "dem/random.h"
#include "dem/strength.h"
#include "dem/temperature_shift.h"
#include "tests/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

using namespace dem;

namespace {

const NormalStrength normal{54, 44};
const WeibullStrength weibull{1.1, 60};

std::vector<std::int64_t> ids(std::size_t n)
{
  std::vector<std::int64_t> result(n);
  std::iota(result.begin(), result.end(), 0);
  return result;
}

/// Largest distance between the distribution of a sample and a cumulative distribution.
double kolmogorov_smirnov(std::vector<double> sample, const std::function<double(double)>& cdf)
{
  std::ranges::sort(sample);
  double distance = 0;
  const double n = double(sample.size());
  for (std::size_t k = 0; k < sample.size(); ++k)
    distance = std::max({distance, std::abs(cdf(sample[k]) - double(k) / n),
                         std::abs(cdf(sample[k]) - double(k + 1) / n)});
  return distance;
}

double normal_cdf(double x)
{
  return 0.5 * std::erfc(-(x - 54) / 44 / std::sqrt(2.0));
}

double mean(const std::vector<double>& sample)
{
  return std::accumulate(sample.begin(), sample.end(), 0.0) / double(sample.size());
}

} // namespace

TEST(Philox, GivesTheKnownAnswers)
{
  // Vectors published with the generator (Random123, kat_vectors).
  using Words = std::array<std::uint32_t, 4>;
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Philox, UniformNumbersFillTheOpenInterval)
{
  std::vector<double> sample;
  for (std::uint64_t id = 0; id < 20000; ++id)
    sample.push_back(uniform(7, RandomStream::strength, id));
  EXPECT_GT(*std::ranges::min_element(sample), 0);
  EXPECT_LT(*std::ranges::max_element(sample), 1);
  EXPECT_LT(kolmogorov_smirnov(sample, [](double x) { return x; }), 1.95 / std::sqrt(20000.0));
  EXPECT_NE(uniform(7, RandomStream::strength, 1), uniform(8, RandomStream::strength, 1));
  EXPECT_NE(uniform(7, RandomStream::strength, 1), uniform(7, RandomStream::packing, 1));
}

TEST(Strength, QuantilesMatchTheTable)
{
  const double share =
      reference::number(reference::json("strength_statistics.json").at("normal_P_nonpositive"));
  for (const auto& row : reference::table("strength_quantiles.csv")) {
    const double u = reference::number(row, "u");
    const auto expect = [&](double found, const char* column) {
      const double expected = reference::number(row, column);
      EXPECT_NEAR(found, expected, 1e-10 * std::max(1.0, std::abs(expected))) << "u = " << u;
    };
    expect(quantile(normal, u), "normal_54_44");
    expect(quantile(normal, share + (1 - share) * u), "normal_54_44_truncated_at_0");
    expect(quantile(weibull, u), "weibull_1.1_60");
  }
}

TEST(Strength, SamplesFollowTheirDistributions)
{
  const std::size_t n = 20000;
  const double critical = 1.95 / std::sqrt(double(n)); // Kolmogorov-Smirnov at 1e-3
  const auto draw = [&](StrengthDistribution d, NonpositiveRule rule) {
    return draw_strengths({d, rule}, ids(n), 42).normal;
  };
  EXPECT_LT(kolmogorov_smirnov(draw(weibull, NonpositiveRule::error),
                               [](double x) { return -std::expm1(-std::pow(x / 60, 1.1)); }),
            critical);
  const auto truncated_cdf = [](double x) {
    return (normal_cdf(x) - normal_cdf(0)) / (1 - normal_cdf(0));
  };
  for (const NonpositiveRule rule : {NonpositiveRule::truncate, NonpositiveRule::resample})
    EXPECT_LT(kolmogorov_smirnov(draw(normal, rule), truncated_cdf), critical);
}

TEST(Strength, MomentsAndShareOfNonpositiveDrawsMatchTheTable)
{
  const auto statistics = reference::json("strength_statistics.json");
  const auto value = [&](const char* key) { return reference::number(statistics.at(key)); };
  const std::size_t n = 200000;
  const Strengths clamped = draw_strengths({normal, NonpositiveRule::clamp}, ids(n), 3);
  const double share = double(clamped.n_nonpositive) / double(n);
  EXPECT_NEAR(share, value("normal_P_nonpositive"), 4 * std::sqrt(0.11 * 0.89 / n));
  EXPECT_NEAR(mean(clamped.normal), value("clamped_at_zero_mean"), 4 * 40 / std::sqrt(n));
  EXPECT_EQ(std::ranges::count(clamped.normal, 0.0), std::ptrdiff_t(clamped.n_nonpositive));
  const Strengths truncated = draw_strengths({normal, NonpositiveRule::truncate}, ids(n), 3);
  EXPECT_NEAR(mean(truncated.normal), value("truncated_mean"), 4 * 37 / std::sqrt(n));
  EXPECT_GT(*std::ranges::min_element(truncated.normal), 0);
  EXPECT_EQ(truncated.n_nonpositive, clamped.n_nonpositive);
}

TEST(Strength, DrawsBelongToTheBondWhateverItsPlace)
{
  const std::vector<std::int64_t> some{4, 17, 2}, other{17, 2, 99, 4};
  const StrengthLaw law{weibull};
  const Strengths a = draw_strengths(law, some, 5), b = draw_strengths(law, other, 5);
  EXPECT_EQ(a.normal[0], b.normal[3]);
  EXPECT_EQ(a.normal[1], b.normal[0]);
  EXPECT_EQ(a.normal[2], b.normal[1]);
  EXPECT_NE(a.normal, draw_strengths(law, some, 6).normal);
}

TEST(Strength, ImpossibleLawsAreRefused)
{
  const auto message = [](const StrengthLaw& law) {
    try {
      draw_strengths(law, ids(16500), 1);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message({weibull}), "accepted");
  EXPECT_NE(message({normal}).find("draws are <= 0; state what to do with them"),
            std::string::npos);
  EXPECT_EQ(message({NormalStrength{54, 0}}),
            "bond strength: the standard deviation must be a finite number > 0, found 0");
  EXPECT_EQ(message({WeibullStrength{-1, 60}}),
            "bond strength: the Weibull modulus must be > 0, found -1");
  EXPECT_EQ(message({WeibullStrength{1, NAN}}),
            "bond strength: the Weibull scale must be > 0, found nan");
  EXPECT_NE(message({NormalStrength{-400, 10}, NonpositiveRule::resample}), "accepted");
}

TEST(Strength, RateLawIsThatOfEquation5)
{
  const RateLaw law{0.325, 0.005, 0, 0, 1e-7};
  EXPECT_DOUBLE_EQ(strength_factor(law, 0.005), 1);
  EXPECT_NEAR(strength_factor(law, -0.05), std::pow(10, 0.325), 1e-14);
  EXPECT_NEAR(strength_factor(law, 0.0005), 1 / std::pow(10, 0.325), 1e-14);
  EXPECT_EQ(strength_factor(law, 0), strength_factor(law, 1e-7));
  EXPECT_EQ(strength_factor(RateLaw{0, 0.005, 0, 0, 0}, 0), 1);
}

TEST(TemperatureShift, LawsAreThoseOfTheirDefinition)
{
  EXPECT_EQ(shift_factor(std::monostate{}, 300), 1);
  const WlfShift wlf{17.44, 51.6, 293.15};
  EXPECT_EQ(shift_factor(wlf, 293.15), 1);
  EXPECT_NEAR(std::log10(shift_factor(wlf, 303.15)), -17.44 * 10 / 61.6, 1e-13);
  const ArrheniusShift arrhenius{2e5, 293.15};
  EXPECT_EQ(shift_factor(arrhenius, 293.15), 1);
  EXPECT_NEAR(std::log(shift_factor(arrhenius, 283.15)),
              2e5 / 8.31446261815324 * (1 / 283.15 - 1 / 293.15), 1e-12);
  EXPECT_GT(shift_factor(wlf, 283.15), 1); // colder is more viscous
  EXPECT_THROW(shift_factor(wlf, 293.15 - 51.7), std::invalid_argument);
  EXPECT_THROW(shift_factor(arrhenius, 0), std::invalid_argument);
}
