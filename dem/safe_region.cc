#include "dem/safe_region.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dem {

namespace {

constexpr int n_rounds = 4;        ///< of taking the leading bonds out of the ellipsoid
constexpr int one_by_one = 64;     ///< share of them in each round: one of so many
constexpr int n_improvements = 40; ///< of the weights
constexpr double weakest = 1e-3;   ///< strength over the median below which a bond is critical

using Rows = Eigen::Matrix<double, 3, 6>;

struct Weights {
  Mat6 sum = Mat6::Zero();    ///< of the squares
  std::vector<double> needed; ///< factor that each bond needs on it
};

/// Largest square of the tensile or the shear ratio over e^T X e, over all strains e.
double needed_factor(const Eigen::LLT<Mat6>& sum, const Rows& rows)
{
  const Eigen::Matrix<double, 6, 3> solved = sum.solve(rows.transpose());
  const Mat3 product = rows * solved;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> shear(product.bottomRightCorner<2, 2>(),
                                                             Eigen::EigenvaluesOnly);
  return std::max(product(0, 0), shear.eigenvalues()[1]);
}

Weights weighted(const std::vector<Rows>& rows, std::span<const std::size_t> bonds, int n_steps)
{
  Eigen::VectorXd weight =
      Eigen::VectorXd::Constant(Eigen::Index(bonds.size()), 1 / double(bonds.size()));
  Weights result;
  for (int k = 0; k <= n_steps; ++k) {
    result.sum.setZero();
    for (std::size_t i = 0; i < bonds.size(); ++i)
      result.sum += weight[Eigen::Index(i)] * rows[bonds[i]].transpose() * rows[bonds[i]];
    const double floor = 1e-12 * result.sum.trace();
    result.sum += floor * Mat6::Identity();
    const Eigen::LLT<Mat6> factor(result.sum);
    result.needed.clear();
    for (const std::size_t b : bonds)
      result.needed.push_back(needed_factor(factor, rows[b]));
    if (k < n_steps)
      for (std::size_t i = 0; i < bonds.size(); ++i)
        weight[Eigen::Index(i)] *= std::max(1e-3, result.needed[i] / 6);
    weight /= weight.sum();
  }
  return result;
}

} // namespace

Mat6 ratio_reach(const DamagedElement& element, const Strengths& strengths)
{
  constexpr int few = 3;
  std::vector<Rows> rows(element.status.size());
  std::vector<std::size_t> bonds;
  for (std::size_t b = 0; b < rows.size(); ++b) {
    if (element.status[b] != BondStatus::intact ||
        (std::isinf(strengths.normal[b]) && std::isinf(strengths.shear[b])))
      continue;
    rows[b] = element.force.middleRows<3>(3 * Eigen::Index(b));
    if (rows[b].isZero(0))
      continue;
    rows[b].row(0) /= strengths.normal[b];
    rows[b].bottomRows<2>() /= strengths.shear[b];
    if (!rows[b].allFinite())
      return Mat6::Constant(std::numeric_limits<double>::infinity());
    bonds.push_back(b);
  }
  if (bonds.empty())
    return Mat6::Zero();
  const Weights found = weighted(rows, bonds, few);
  return std::ranges::max(found.needed) * (1 + 1e-12) * found.sum;
}

SafeRegion safe_region(const DamagedElement& element, const Strengths& strengths)
{
  const std::size_t n = element.status.size();
  SafeRegion region;
  std::vector<double> sorted = strengths.normal;
  std::ranges::sort(sorted);
  const double least = n > 0 ? weakest * sorted[n / 2] : 0;
  std::vector<Rows> rows(n);
  std::vector<std::size_t> others;
  for (std::size_t b = 0; b < n; ++b) {
    if (element.status[b] != BondStatus::intact)
      continue;
    const double normal = strengths.normal[b], shear = strengths.shear[b];
    region.is_empty = region.is_empty || !(normal > 0) || !(shear > 0);
    rows[b] = element.force.middleRows<3>(3 * Eigen::Index(b));
    rows[b].row(0) /= normal;
    rows[b].bottomRows<2>() /= shear;
    if (std::isinf(normal) && std::isinf(shear))
      continue;
    if (!(normal > least) || !(shear > least * 1e-3))
      region.critical.push_back(Index(b));
    else
      others.push_back(b);
  }
  for (int round = 0; round <= n_rounds && !others.empty(); ++round) {
    const Weights found = weighted(rows, others, n_improvements);
    const double largest = std::ranges::max(found.needed);
    region.ellipsoid = largest * (1 + 1e-12) * found.sum;
    if (round == n_rounds)
      break;
    std::vector<std::size_t> order(others.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return found.needed[i]; });
    std::vector<bool> leads(others.size(), false);
    for (std::size_t i = 0; i < std::min(others.size(), n / one_by_one + 1); ++i) {
      leads[order[i]] = true;
      region.critical.push_back(Index(others[order[i]]));
    }
    std::vector<std::size_t> rest;
    for (std::size_t i = 0; i < others.size(); ++i)
      if (!leads[i])
        rest.push_back(others[i]);
    others = rest;
  }
  if (others.empty())
    region.ellipsoid.setZero();
  std::ranges::sort(region.critical);
  region.rows.resize(3 * Eigen::Index(region.critical.size()), 6);
  for (std::size_t k = 0; k < region.critical.size(); ++k)
    region.rows.middleRows<3>(3 * Eigen::Index(k)) = rows[std::size_t(region.critical[k])];
  return region;
}

double ratio_bound(const SafeRegion& region, const Vec6& strain)
{
  if (region.is_empty)
    return strain.isZero(0) ? 0 : std::numeric_limits<double>::infinity();
  double square = std::max(0., strain.dot(region.ellipsoid * strain)), tension = 0;
  for (Eigen::Index k = 0; k < region.rows.rows(); k += 3) {
    const Vec3 ratios = region.rows.middleRows<3>(k) * strain;
    tension = std::max(tension, ratios[0]);
    square = std::max(square, ratios[1] * ratios[1] + ratios[2] * ratios[2]);
  }
  return std::max(tension, std::sqrt(square));
}

} // namespace dem
