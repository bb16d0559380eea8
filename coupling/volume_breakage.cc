#include "coupling/volume_points.h"

#include "fem/processor_time.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

// When the points of a body change: rates, strengths, and the search for the next breakage.

namespace coupling {

using fem::Mat6;
using fem::Vec6;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int n_instants = 8;
constexpr int deepest_search = 5;

bool is_instantaneous(const dem::RateLaw& law)
{
  return law.window <= 0 && law.window_fraction <= 0;
}

} // namespace

/// Start of the window of the rate law that ends at a time.
double VolumePoints::window_start(double time) const
{
  const dem::RateLaw& law = settings_.rate_law;
  return std::max(start_, time - std::max(law.window, law.window_fraction * (time - start_)));
}

VolumePoints::Instant VolumePoints::instant(double share) const
{
  const double time = time_ + share * duration_;
  Instant at{share, time, window_start(time), {}, {}};
  at.part = creep_.part(share * part_.duration);
  if (at.from > time_ && duration_ > 0)
    at.from_part = creep_.part((at.from - time_) / duration_ * part_.duration);
  return at;
}

/// Strain without its jumps, at a share of the trial step.
Vec6 VolumePoints::smooth_strain(std::size_t point, double share,
                                 const SharedCreep::Part& part) const
{
  const Vec6 growth = share * growth_[point];
  return strain_[point] - jumps_[point] + growth +
         creep_.gain(part, elastic_[point], growth, kelvin(point));
}

Vec6 VolumePoints::smooth_rate(std::size_t point, const Instant& at) const
{
  const double span = at.time - at.from;
  if (is_instantaneous(settings_.rate_law) || !(span > 1e-14 * std::abs(at.time))) {
    const double h = part_.duration;
    const Vec6 growth = at.share * growth_[point];
    const Vec6 slope = h > 0 ? Vec6(growth_[point] / h) : slope_[point];
    const double pace = h > 0 ? h / duration_ : pace_;
    return pace * (slope + creep_.rate(at.part, elastic_[point], growth, kelvin(point)));
  }
  const Vec6 before = at.from > time_ && duration_ > 0
                          ? smooth_strain(point, (at.from - time_) / duration_, at.from_part)
                          : window_.at(point, at.from);
  return (smooth_strain(point, at.share, at.part) - before) / span;
}

Vec6 VolumePoints::in_volume(std::size_t point, const Vec6& elastic) const
{
  return live_[point] ? Vec6(live_[point]->focus * elastic) : elastic;
}

double VolumePoints::factor(std::size_t point, const Instant& at) const
{
  return dem::strength_factor(settings_.rate_law,
                              largest_principal(in_volume(point, smooth_rate(point, at))));
}

double VolumePoints::ratio(std::size_t point, const Vec6& elastic) const
{
  const VolumeFamily& volume = family(point);
  const dem::DamagedElement& now = live_[point] ? *live_[point]->damage : *volume.element->intact();
  return dem::largest_ratio(now, volume.element->strengths(), in_volume(point, elastic));
}

/// Upper bound of the ratio; of a live point from the last look at all its bonds, if there was one.
double VolumePoints::ratio_bound(std::size_t point, const Vec6& elastic) const
{
  if (!live_[point])
    return dem::ratio_bound(family(point).region, elastic);
  const Look& look = looks_[point];
  if (look.at != live_[point].get() || settings_.use == VolumeUse::all_live)
    return ratio(point, elastic);
  const Mat6& reach = live_[point]->reach;
  if (!reach.allFinite()) // a bond without strength
    return ratio(point, elastic);
  const Vec6 change = in_volume(point, elastic) - look.strain;
  return look.seen.ratio + std::sqrt(std::max(0., change.dot(reach * change)));
}

/// Looks at all bonds and contacts of a live point in its committed state.
void VolumePoints::look_at(std::size_t point)
{
  const fem::ProcessorTimer timer(costs_[point]);
  const Vec6 strain = in_volume(point, elastic_[point]);
  looks_[point] = {live_[point].get(), strain,
                   dem::look_at(*live_[point]->damage, family(point).element->strengths(), strain)};
}

double VolumePoints::strength_use(std::size_t point) const
{
  const double loaded = ratio(point, elastic_[point]);
  return loaded > 0 ? loaded / factor(point, instant(0)) : 0;
}

double VolumePoints::largest_strength_use() const
{
  const Instant now = instant(0);
  std::vector<std::pair<double, std::size_t>> bounds;
  for (std::size_t q = 0; q < size(); ++q)
    if (const double bound = ratio_bound(q, elastic_[q]); bound > 0)
      bounds.emplace_back(bound / factor(q, now), q);
  constexpr std::size_t most = 100;
  const auto end = bounds.begin() + long(std::min(most, bounds.size()));
  std::partial_sort(bounds.begin(), end, bounds.end(), std::greater());
  bounds.erase(end, bounds.end());
  double largest = 0;
  for (const auto& [bound, q] : bounds) {
    if (bound <= largest)
      break;
    largest = std::max(largest, strength_use(q));
  }
  return largest;
}

double VolumePoints::overload()
{
  const Instant now = instant(0);
  const double enough = 1 - settings_.breakage_tolerance;
  double worst = 0;
  for (std::size_t q = 0; q < size(); ++q) {
    overload_[q] = 0;
    if (is_released_[q])
      continue;
    if (live_[q]) {
      const Look& look = looks_[q];
      const double way =
          look.at == live_[q].get() ? (in_volume(q, elastic_[q]) - look.strain).norm() : infinity;
      if (!(way < look.seen.opening_margin) || settings_.use == VolumeUse::all_live)
        look_at(q);
      if (looks_[q].seen.opening_margin < 0) {
        overload_[q] = worst = infinity;
        continue;
      }
    }
    const double bound = ratio_bound(q, elastic_[q]);
    if (!(bound >= enough * least_factor_) || bound == 0)
      continue;
    const double strength = factor(q, now);
    if (bound < enough * strength)
      continue;
    if (live_[q])
      look_at(q);
    const double loaded = live_[q] ? looks_[q].seen.ratio : ratio(q, elastic_[q]);
    overload_[q] = std::min(loaded / strength, without_strength);
    worst = std::max(worst, overload_[q]);
  }
  return worst >= enough ? std::max(1., worst) : worst;
}

/// Status of a point after its contacts have opened, or else its bonds from a ratio on have broken.
std::vector<dem::BondStatus> VolumePoints::changed_status(std::size_t point, double at_least) const
{
  const VolumeFamily& volume = family(point);
  const dem::DamagedElement& now = live_[point] ? *live_[point]->damage : *volume.element->intact();
  const Vec6 strain = in_volume(point, elastic_[point]);
  if (overload_[point] < infinity)
    return dem::with_broken(now, volume.element->after_breakage(),
                            dem::bonds_from(now, volume.element->strengths(), strain, at_least));
  std::vector<dem::BondStatus> status = now.status;
  for (const dem::Index contact : dem::contacts_to_open(now, strain))
    status[contact] = dem::BondStatus::gone;
  return status;
}

void VolumePoints::change(double largest_overload)
{
  const double least = largest_overload < infinity
                           ? least_overload(largest_overload, settings_.breakage_tolerance)
                           : infinity;
  const Instant now = instant(0);
  std::vector<std::size_t> points;
  std::vector<std::vector<dem::BondStatus>> status;
  for (std::size_t q = 0; q < size(); ++q)
    if (overload_[q] > 0 && overload_[q] >= least) {
      points.push_back(q);
      status.push_back(changed_status(q, least < infinity ? least * factor(q, now) : infinity));
    }
  make_live(points, std::move(status));
  has_changed_ = true;
}

void VolumePoints::release(std::span<const std::size_t> points)
{
  for (const std::size_t q : points)
    is_released_[q] = 1;
  has_changed_ = true;
}

/// First share in (from, to] at which the ratio is not below the factor, which it is at `from`.
double VolumePoints::crossing(std::size_t point, double from, double to) const
{
  const auto is_over = [&](double share) {
    return ratio(point, elastic_[point] + share * growth_[point]) >= factor(point, instant(share));
  };
  for (int k = 0; k < 60 && to - from > 1e-15; ++k) {
    const double middle = 0.5 * (from + to);
    (is_over(middle) ? to : from) = middle;
  }
  return to;
}

double VolumePoints::share_until_breakage(std::size_t point, std::span<const Instant> instants)
{
  const Vec6 end = elastic_[point] + growth_[point];
  const double bound = std::max(ratio_bound(point, elastic_[point]), ratio_bound(point, end));
  if (!(bound >= least_factor_) || bound == 0)
    return 1;
  // strengths do not fall to half of what they are at both ends, and rise again, within a step
  if (bound < 0.5 * std::min(factor(point, instants.front()), factor(point, instants.back())))
    return 1;
  std::vector<double> factors;
  for (const Instant& at : instants)
    factors.push_back(factor(point, at));
  const double least = std::ranges::min(factors);
  if (bound < least)
    return 1;
  if (live_[point]) { // a fresh look is nearer
    look_at(point);
    if (std::max(looks_[point].seen.ratio, ratio_bound(point, end)) < least)
      return 1;
  }
  const fem::ProcessorTimer timer(costs_[point]);
  const auto ratio_at = [&](double share) {
    return ratio(point, elastic_[point] + share * growth_[point]);
  };
  // The ratio is convex over the step: between two shares it is at most the larger one.
  const auto search = [&](const auto& self, double a, double ratio_a, double factor_a, double b,
                          double ratio_b, double factor_b, int depth) -> double {
    if (std::max(ratio_a, ratio_b) < std::min(factor_a, factor_b))
      return 1;
    if (depth == deepest_search)
      return ratio_b >= factor_b ? crossing(point, a, b) : 1;
    const double middle = 0.5 * (a + b);
    const double ratio_m = ratio_at(middle), factor_m = factor(point, instant(middle));
    const double first = self(self, a, ratio_a, factor_a, middle, ratio_m, factor_m, depth + 1);
    return first < 1 || ratio_m >= factor_m
               ? first
               : self(self, middle, ratio_m, factor_m, b, ratio_b, factor_b, depth + 1);
  };
  double before = ratio_at(0);
  for (std::size_t k = 1; k < instants.size(); ++k) {
    const double after = ratio_at(instants[k].share);
    const double share = search(search, instants[k - 1].share, before, factors[k - 1],
                                instants[k].share, after, factors[k], 0);
    if (share < 1)
      return share;
    before = after;
  }
  return 1;
}

double VolumePoints::share_until_opening(std::size_t point) const
{
  if (!live_[point])
    return 1;
  const Vec6 end = in_volume(point, elastic_[point] + growth_[point]);
  if (const Look& look = looks_[point];
      look.at == live_[point].get() && (end - look.strain).norm() < look.seen.opening_margin)
    return 1;
  return dem::share_until_opening(*live_[point]->damage, in_volume(point, elastic_[point]), end);
}

double VolumePoints::share_without_change()
{
  if (part_.duration == 0)
    return 1;
  std::vector<Instant> instants;
  for (int k = 0; k <= n_instants; ++k)
    instants.push_back(instant(double(k) / n_instants));
  double share = 1;
  for (std::size_t q = 0; q < size(); ++q)
    if (!is_released_[q])
      share = std::min({share, share_until_breakage(q, instants), share_until_opening(q)});
  return share;
}

} // namespace coupling
