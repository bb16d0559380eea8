#include "apps/rank_costs.h"

#include "fem/balance.h"
#include "fem/processor_time.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace apps {

namespace {

constexpr double fading = 0.5;      ///< of what was before, at each look
constexpr double looks_a_price = 4; ///< so often at most while a price is spent

double sum(std::span<const double> costs)
{
  return std::accumulate(costs.begin(), costs.end(), 0.);
}

} // namespace

double common_cost(std::span<const RankTime> ranks)
{
  double least = std::numeric_limits<double>::infinity();
  for (const RankTime& rank : ranks)
    if (rank.n_cells > 0)
      least = std::min(least, std::max(0., rank.rest) / rank.n_cells);
  return least < std::numeric_limits<double>::infinity() ? least : 0;
}

double saving(double waited, double now, double then)
{
  return now > 1 ? waited * (now - then) / (now - 1) : 0;
}

void RankCosts::begin(double price, const Ranks& ranks)
{
  of_cells_.clear();
  seen_.clear();
  of_ranks_.assign(std::size_t(ranks.number()), 0.);
  all_of_ranks_ = of_ranks_;
  waited_ = 0;
  price_ = dealii::Utilities::MPI::max(price, ranks.all());
  clock_ = fem::processor_time();
}

bool RankCosts::is_due(std::span<const double> points, const Ranks& ranks) const
{
  return ranks.any(sum(points) - sum(seen_) > price_ / looks_a_price);
}

void RankCosts::look(std::span<const double> points, std::size_t n_cells, const Ranks& ranks)
{
  of_cells_.resize(n_cells, 0.);
  seen_.resize(points.size(), 0.);
  const double now = fem::processor_time(), own = sum(points) - sum(seen_);
  const double times[] = {own, now - clock_ - own, double(n_cells)};
  std::vector<RankTime> all(std::size_t(ranks.number()));
  MPI_Allgather(times, 3, MPI_DOUBLE, all.data(), 3, MPI_DOUBLE, ranks.all());
  const double common = common_cost(all);
  for (double& cost : of_cells_)
    cost = fading * cost + common;
  for (std::size_t q = 0; q < points.size(); ++q)
    of_cells_[q * n_cells / points.size()] += points[q] - seen_[q];
  seen_.assign(points.begin(), points.end());
  clock_ = now;
  double largest = 0, mean = 0;
  for (std::size_t rank = 0; rank < all.size(); ++rank) {
    const double cost = all[rank].points + common * all[rank].n_cells;
    of_ranks_[rank] = fading * of_ranks_[rank] + cost;
    all_of_ranks_[rank] += cost;
    largest = std::max(largest, cost);
    mean += cost / double(all.size());
  }
  waited_ += largest - mean;
}

double RankCosts::imbalance() const
{
  return fem::imbalance(of_ranks_);
}

void RankCosts::count_sharing()
{
  if (n_sharings_++ == 0)
    before_ = fem::imbalance(all_of_ranks_);
}

std::string RankCosts::summary() const
{
  const double now = fem::imbalance(all_of_ranks_);
  if (n_sharings_ == 0)
    return fmt::format("costs of the ranks: largest over mean {:.2f}", now);
  return fmt::format(
      "cells shared out anew {} time{}; costs of the ranks: largest over mean {:.2f} "
      "before, {:.2f} since",
      n_sharings_, n_sharings_ == 1 ? "" : "s", before_, now);
}

} // namespace apps
