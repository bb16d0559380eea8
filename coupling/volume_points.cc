#include "coupling/volume_points.h"

#include "dem/realisations.h"
#include "fem/processor_time.h"

#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace coupling {

using fem::Mat6;
using fem::Vec6;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double residual_stiffness = 1e-8; ///< of a damaged volume, of the intact one

dem::CreepLaw shared_law(const std::vector<VolumeFamily>& families)
{
  const dem::CreepLaw& first = families.front().element->creep();
  for (const VolumeFamily& family : families)
    if (!dem::proportionality(first, family.element->creep()))
      throw std::invalid_argument("all volumes of a body must have bond laws that are proportional "
                                  "to each other");
  return first;
}

} // namespace

VolumeFamily make_family(dem::VolumeElement element, dem::Strengths strengths,
                         dem::AfterBreakage after_breakage)
{
  auto shared = std::make_shared<const dem::BreakableElement>(std::move(element),
                                                              std::move(strengths), after_breakage);
  dem::SafeRegion region = dem::safe_region(*shared->intact(), shared->strengths());
  return {std::move(shared), std::move(region)};
}

LiveVolume live_volume(const VolumeFamily& family,
                       std::shared_ptr<const dem::DamagedElement> damage, double size_ratio,
                       double since)
{
  const Mat6 reach = dem::ratio_reach(*damage, family.element->strengths());
  if (damage->n_broken == 0)
    return {damage, damage->stiffness, Mat6::Identity(), reach, since};
  const Mat6& intact = family.stiffness();
  const Mat6 share = intact.ldlt().solve(damage->stiffness); // S_0 C
  const Mat6 series = size_ratio * Mat6::Identity() + (1 - size_ratio) * share;
  const Mat6 focus = series.partialPivLu().solve(Mat6::Identity());
  const Mat6 stiffness = damage->stiffness * focus;
  const Mat6 symmetric = 0.5 * (stiffness + stiffness.transpose()) + residual_stiffness * intact;
  return {std::move(damage), symmetric, focus, reach, since};
}

VolumePoints::VolumePoints(std::vector<VolumeFamily> families, std::vector<int> family_of_point,
                           std::vector<double> size_ratio, const VolumeSettings& settings,
                           double start)
    : families_(std::move(families)), family_of_point_(std::move(family_of_point)),
      size_ratio_(std::move(size_ratio)), settings_(settings), creep_(shared_law(families_)),
      start_(start), least_factor_(dem::strength_factor(settings.rate_law, 0)),
      window_(family_of_point_.size()), time_(start), pace_(settings.first_pace)
{
  assert(size_ratio_.size() == size());
  const std::size_t n = size();
  for (std::vector<Vec6>* field : {&strain_, &stress_, &elastic_, &slope_, &jumps_, &trial_stress_,
                                   &trial_increment_, &growth_})
    field->assign(n, Vec6::Zero());
  kelvin_.assign(n * creep_.n_branches(), Vec6::Zero());
  live_.resize(n);
  is_released_.assign(n, 0);
  looks_.resize(n);
  overload_.assign(n, 0);
  costs_.assign(n, 0);
  part_ = creep_.part(0);
  if (settings.use == VolumeUse::all_live) {
    std::vector<std::size_t> all(n);
    std::iota(all.begin(), all.end(), std::size_t(0));
    std::vector<std::vector<dem::BondStatus>> status;
    for (std::size_t q = 0; q < n; ++q)
      status.push_back(family(q).element->intact()->status);
    make_live(all, std::move(status));
  }
}

void VolumePoints::begin_step(double time, double duration)
{
  time_ = time;
  duration_ = duration;
}

std::span<const Vec6> VolumePoints::kelvin(std::size_t point) const
{
  return std::span(kelvin_).subspan(point * creep_.n_branches(), creep_.n_branches());
}

fem::ConstitutiveAnswer VolumePoints::evaluate(std::span<const Vec6> increment, double step)
{
  assert(increment.size() == size());
  if (!(step >= 0) || !std::isfinite(step))
    throw std::invalid_argument("a time step must be a number that is not negative");
  part_ = creep_.part(step);
  const double compliance = creep_.compliance(part_);
  const bool by_family = n_live_ == 0;
  tangents_.clear();
  for (std::size_t k = 0; by_family && k < families_.size(); ++k)
    tangents_.push_back(families_[k].stiffness() / compliance);
  for (std::size_t q = 0; q < size(); ++q) {
    const Mat6& stiffness = live_[q] ? live_[q]->stiffness : family(q).stiffness();
    const Vec6 still = creep_.gain(part_, elastic_[q], Vec6::Zero(), kelvin(q));
    trial_increment_[q] = increment[q];
    growth_[q] = (increment[q] - still) / compliance;
    trial_stress_[q] = stiffness * (elastic_[q] + growth_[q]);
    if (!by_family)
      tangents_.push_back(stiffness / compliance);
  }
  if (!by_family && which_.size() != size()) {
    which_.resize(size());
    std::iota(which_.begin(), which_.end(), 0);
  }
  return {trial_stress_, tangents_,
          !by_family             ? std::span<const int>(which_)
          : families_.size() > 1 ? std::span<const int>(family_of_point_)
                                 : std::span<const int>()};
}

fem::StepError VolumePoints::step_error(std::span<const double> weights) const
{
  fem::StepError error;
  const double h = part_.duration;
  if (h == 0)
    return error;
  const double before = last_step_ > 0 ? last_step_ : h;
  const double weight = 2. / 3 * creep_.held(part_) * h * h / 4 / (h + before);
  for (std::size_t q = 0; q < size(); ++q) {
    const Vec6 wrong = weight * (growth_[q] / h - slope_[q]);
    error.square += weights[q] * wrong.squaredNorm();
    error.size_square += weights[q] * (strain_[q] + trial_increment_[q]).squaredNorm();
  }
  return error;
}

void VolumePoints::commit()
{
  const double h = part_.duration;
  const std::size_t n_branches = creep_.n_branches();
  for (std::size_t q = 0; q < size(); ++q) {
    creep_.advance(part_, elastic_[q], growth_[q],
                   std::span(kelvin_).subspan(q * n_branches, n_branches));
    if (h > 0)
      slope_[q] = growth_[q] / h;
    else {
      jumps_[q] += trial_increment_[q];
      if (!has_changed_)
        slope_[q].setZero();
    }
    elastic_[q] += growth_[q];
    strain_[q] += trial_increment_[q];
    stress_[q] = trial_stress_[q];
  }
  if (h > 0)
    pace_ = h / duration_;
  time_ += duration_;
  duration_ = 0;
  if (h > 0 || !has_changed_)
    last_step_ = h;
  has_changed_ = false;
  if (h > 0 || window_.empty()) {
    std::vector<Vec6> smooth(size());
    for (std::size_t q = 0; q < size(); ++q)
      smooth[q] = strain_[q] - jumps_[q];
    window_.append(time_, smooth, window_start(time_));
  }
  part_ = creep_.part(0);
  for (std::vector<Vec6>* field : {&trial_increment_, &growth_})
    std::ranges::fill(*field, Vec6::Zero());
}

void VolumePoints::make_live(std::span<const std::size_t> points,
                             std::vector<std::vector<dem::BondStatus>> status)
{
  const auto work = [&](int k) {
    const std::size_t q = points[std::size_t(k)];
    const fem::ProcessorTimer timer(costs_[q], 1. / settings_.n_threads);
    const double since = live_[q] && live_[q]->damage->n_broken > 0 ? live_[q]->since : time_;
    looks_[q] = {};
    live_[q] = std::make_shared<const LiveVolume>(
        live_volume(family(q), family(q).element->answer(std::move(status[std::size_t(k)])),
                    size_ratio_[q], since));
  };
  dem::for_each_realisation(int(points.size()), settings_.n_threads, work);
  n_live_ = std::size_t(std::ranges::count_if(live_, [](const auto& each) { return bool(each); }));
}

std::size_t VolumePoints::n_broken() const
{
  std::size_t n = 0;
  for (const auto& live : live_)
    n += live ? live->damage->n_broken : 0;
  return n;
}

std::size_t VolumePoints::n_bonds() const
{
  std::size_t n = 0;
  for (std::size_t q = 0; q < size(); ++q)
    n += family(q).element->n_bonds();
  return n;
}

std::size_t VolumePoints::n_failed() const
{
  return std::size_t(std::ranges::count_if(
      live_, [](const auto& each) { return each && !each->damage->obstacle.empty(); }));
}

PointDamage VolumePoints::damage(std::size_t point) const
{
  const LiveVolume* volume = live(point);
  if (!volume)
    return {};
  return {true, double(volume->damage->n_broken) / double(family(point).element->n_bonds()),
          1 - volume->stiffness.trace() / family(point).stiffness().trace(), volume->since};
}

} // namespace coupling
