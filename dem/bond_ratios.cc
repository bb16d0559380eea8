#include "dem/bond_ratios.h"

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

constexpr double tie = 1e-12;
constexpr double force_noise = 1e-12;

} // namespace

BondRatios bond_ratios(std::span<const BondStatus> status, const Strengths& strengths,
                       std::vector<ForcePair> force)
{
  const std::size_t n = force.size();
  BondRatios result{std::move(force), std::vector<double>(n, 0.0), std::vector<double>(n, 0.0), {}};
  double largest = 0;
  for (const auto& [normal, shear] : result.force)
    largest = std::max({largest, std::abs(normal), shear});
  const auto ratio = [&](double part, double strength) {
    return part > force_noise * largest ? part / strength : 0;
  };
  for (std::size_t b = 0; b < n; ++b) {
    if (status[b] != BondStatus::intact)
      continue;
    const auto [normal, shear] = result.force[b];
    const double by_shear = ratio(shear, strengths.shear[b]);
    result.positive[b] = std::max(by_shear, ratio(normal, strengths.normal[b]));
    result.negative[b] = std::max(by_shear, ratio(-normal, strengths.normal[b]));
    result.critical.positive = std::max(result.critical.positive, result.positive[b]);
    result.critical.negative = std::max(result.critical.negative, result.negative[b]);
  }
  return result;
}

std::vector<Index> critical_bonds(const BondRatios& ratios, bool positive_load)
{
  const std::vector<double>& ratio = positive_load ? ratios.positive : ratios.negative;
  const double largest = positive_load ? ratios.critical.positive : ratios.critical.negative;
  std::vector<Index> result;
  for (std::size_t b = 0; b < ratio.size(); ++b)
    if (ratio[b] > 0 && ratio[b] >= largest * (1 - tie))
      result.push_back(Index(b));
  return result;
}

} // namespace dem
