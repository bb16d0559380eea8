#include "dem/strength.h"

#include "dem/random.h"

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

void require(bool condition, const char* what, double found)
{
  if (!condition)
    throw std::invalid_argument(fmt::format("bond strength: {}, found {:g}", what, found));
}

void validate(const NormalStrength& law)
{
  require(std::isfinite(law.mean), "the mean must be a finite number", law.mean);
  require(law.standard_deviation > 0 && std::isfinite(law.standard_deviation),
          "the standard deviation must be a finite number > 0", law.standard_deviation);
}

void validate(const WeibullStrength& law)
{
  require(law.modulus > 0 && std::isfinite(law.modulus), "the Weibull modulus must be > 0",
          law.modulus);
  require(law.scale > 0 && std::isfinite(law.scale), "the Weibull scale must be > 0", law.scale);
}

double quantile_of(const NormalStrength& law, double u)
{
  return boost::math::quantile(boost::math::normal(law.mean, law.standard_deviation), u);
}

double quantile_of(const WeibullStrength& law, double u)
{
  return law.scale * std::pow(-std::log1p(-u), 1 / law.modulus);
}

/// Share of the distribution at or below zero.
double share_nonpositive(const StrengthDistribution& distribution)
{
  if (const auto* law = std::get_if<NormalStrength>(&distribution))
    return boost::math::cdf(boost::math::normal(law->mean, law->standard_deviation), 0.0);
  return 0;
}

double draw(const StrengthLaw& law, double share, std::int64_t id, std::uint64_t seed)
{
  const auto number = [&](std::uint32_t k) {
    return uniform(seed, RandomStream::strength, std::uint64_t(id), k);
  };
  if (law.rule == NonpositiveRule::truncate)
    return quantile(law.distribution, share + (1 - share) * number(0));
  double value = quantile(law.distribution, number(0));
  if (law.rule == NonpositiveRule::resample)
    for (std::uint32_t k = 1; value <= 0; ++k)
      value = quantile(law.distribution, number(k));
  return value;
}

} // namespace

double quantile(const StrengthDistribution& distribution, double u)
{
  return std::visit([&](const auto& law) { return quantile_of(law, u); }, distribution);
}

Strengths draw_strengths(const StrengthLaw& law, std::span<const std::int64_t> bond_id,
                         std::uint64_t seed)
{
  std::visit([](const auto& distribution) { validate(distribution); }, law.distribution);
  require(law.shear_ratio > 0 && std::isfinite(law.shear_ratio),
          "shear strength over normal strength must be > 0", law.shear_ratio);
  const double share = share_nonpositive(law.distribution);
  require(share < 1 - 1e-12, "nearly all draws are <= 0; share", share);
  Strengths strengths;
  for (const std::int64_t id : bond_id) {
    const double first =
        quantile(law.distribution, uniform(seed, RandomStream::strength, std::uint64_t(id)));
    strengths.n_nonpositive += first <= 0;
    strengths.normal.push_back(std::max(0.0, draw(law, share, id, seed)));
    strengths.shear.push_back(law.shear_ratio * strengths.normal.back());
  }
  if (law.rule == NonpositiveRule::error && strengths.n_nonpositive > 0)
    throw std::invalid_argument(fmt::format(
        "bond strength: {} of {} draws are <= 0; state what to do with them (clamp, truncate or "
        "resample)",
        strengths.n_nonpositive, bond_id.size()));
  return strengths;
}

double strength_factor(const RateLaw& law, double strain_rate)
{
  if (law.exponent == 0)
    return 1;
  return std::pow(std::max(std::abs(strain_rate), law.floor) / law.reference_rate, law.exponent);
}

} // namespace dem
