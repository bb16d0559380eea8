#include "coupling/quasistatic_points.h"

#include "dem/realisations.h"
#include "fem/processor_time.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

namespace coupling {

using dem::QuasistaticVolume;
using dem::QuasistaticVolumeState;
using fem::Mat6;
using fem::Vec6;

struct QuasistaticPoints::Idle {
  std::mutex lock;
  std::map<const QuasistaticVolume*, std::vector<std::unique_ptr<dem::VolumeFollower>>> followers;

  std::unique_ptr<dem::VolumeFollower> borrow(const QuasistaticVolume& volume)
  {
    const std::lock_guard guard(lock);
    auto& of = followers[&volume];
    if (of.empty())
      return std::make_unique<dem::VolumeFollower>(volume);
    auto one = std::move(of.back());
    of.pop_back();
    return one;
  }

  void give_back(const QuasistaticVolume& volume, std::unique_ptr<dem::VolumeFollower> one)
  {
    const std::lock_guard guard(lock);
    followers[&volume].push_back(std::move(one));
  }
};

namespace {

/// What a volume carries that is torn apart, over what it carried intact: nodes without stiffness
/// would go anywhere.
constexpr double residual_stiffness = 1e-8;

/// Largest ratio of force to strength; bonds without strength count as a very large one.
double largest(std::span<const double> ratios)
{
  return ratios.empty() ? 0 : std::min(std::ranges::max(ratios), without_strength);
}

/// The shortest time in which a bond creeps by as much as it is strained [s].
double shortest_time(const std::vector<dem::BondLaw>& laws)
{
  double shortest = std::numeric_limits<double>::infinity();
  for (const dem::BondLaw& law : laws) {
    if (law.creep.maxwell_viscosity)
      shortest = std::min(shortest, *law.creep.maxwell_viscosity / law.creep.maxwell_stiffness);
    for (const dem::KelvinBranch& branch : law.creep.branches)
      shortest = std::min(shortest, branch.viscosity / law.creep.maxwell_stiffness);
  }
  return shortest;
}

bool hangs_together(const QuasistaticVolume& volume, const QuasistaticVolumeState& state)
{
  std::vector<dem::BondStatus> status(volume.assembly.bonds.size());
  for (std::size_t b = 0; b < status.size(); ++b)
    status[b] = state.links.link[b].kind == dem::LinkKind::bond ? dem::BondStatus::intact
                                                                : dem::BondStatus::gone;
  const dem::Clusters clusters = dem::find_clusters(volume.element, status);
  return std::ranges::any_of(clusters.cluster,
                             [](const auto& each) { return !each.direction.empty(); });
}

} // namespace

QuasistaticPoints::QuasistaticPoints(std::vector<Volume> volumes, std::vector<int> volume_of_point,
                                     const VolumeSettings& settings, double start,
                                     std::optional<VolumePoints> law)
    : volumes_(std::move(volumes)), volume_of_point_(std::move(volume_of_point)),
      settings_(settings), law_(std::move(law)),
      record_(volume_of_point_.size(), settings.rate_law, start), idle_(std::make_shared<Idle>()),
      pace_(settings.first_pace)
{
  const std::size_t n = size();
  state_.resize(n);
  since_.assign(n, -1);
  trial_.resize(n);
  for (std::vector<Vec6>* field : {&stress_, &trial_stress_})
    field->assign(n, Vec6::Zero());
  tangents_.assign(n, Mat6::Zero());
  which_.resize(n);
  std::iota(which_.begin(), which_.end(), 0);
  is_lost_.assign(n, 0);
  overload_.assign(n, 0);
  costs_.assign(n, 0);
  for (const Volume& each : volumes_) {
    const auto rest = dem::at_rest(*each);
    const auto elastic = dem::VolumeFollower(*each).step(rest, Vec6::Zero(), 0);
    intact_.push_back(elastic ? elastic->tangent : Mat6::Zero());
  }
  if (!law_)
    for (std::size_t q = 0; q < n; ++q)
      state_[q] = std::make_shared<const QuasistaticVolumeState>(dem::at_rest(volume(q)));
}

void QuasistaticPoints::begin_step(double time, double duration)
{
  record_.begin_step(time, duration);
  if (law_)
    law_->begin_step(time, duration);
}

std::optional<dem::QuasistaticVolumeStep>
QuasistaticPoints::step_of(std::size_t point, const Vec6& increment, double duration) const
{
  auto follower = idle_->borrow(volume(point));
  auto step = follower->step(*state_[point], increment, duration);
  idle_->give_back(volume(point), std::move(follower));
  return step;
}

fem::ConstitutiveAnswer QuasistaticPoints::evaluate(std::span<const Vec6> increment, double step)
{
  assert(increment.size() == size());
  if (!(step >= 0) || !std::isfinite(step))
    throw std::invalid_argument("a time step must be a number that is not negative");
  step_ = step;
  record_.try_step(increment);
  std::vector<std::size_t> points;
  for (std::size_t q = 0; q < size(); ++q)
    if (state_[q])
      points.push_back(q);
  if (law_) {
    const fem::ConstitutiveAnswer answer = law_->evaluate(increment, step);
    if (points.empty())
      return answer;
    for (std::size_t q = 0; q < size(); ++q) {
      trial_stress_[q] = answer.stress[q];
      tangents_[q] = answer.tangent[answer.which.empty() ? 0 : std::size_t(answer.which[q])];
    }
  }
  dem::for_each_realisation(int(points.size()), settings_.n_threads, [&](int k) {
    const std::size_t q = points[std::size_t(k)];
    const fem::ProcessorTimer timer(costs_[q], 1. / settings_.n_threads);
    trial_[q] = step_of(q, increment[q], step);
    is_lost_[q] = char(!trial_[q]);
    trial_stress_[q] = trial_[q] ? trial_[q]->state.stress
                                 : Vec6::Constant(std::numeric_limits<double>::quiet_NaN());
    if (!trial_[q])
      return;
    const Mat6& intact = intact_[std::size_t(volume_of_point_[q])];
    trial_stress_[q] += residual_stiffness * intact * (record_.strain()[q] + increment[q]);
    tangents_[q] = trial_[q]->tangent + residual_stiffness * intact;
  });
  return {trial_stress_, tangents_, which_};
}

bool QuasistaticPoints::has_lost() const
{
  return std::ranges::any_of(is_lost_, [](char each) { return each != 0; });
}

fem::StepError QuasistaticPoints::step_error(std::span<const double> weights) const
{
  fem::StepError error;
  if (step_ == 0)
    return error;
  if (law_) {
    std::vector<double> on_law(weights.begin(), weights.end());
    for (std::size_t q = 0; q < size(); ++q)
      on_law[q] = state_[q] ? 0 : on_law[q];
    error = law_->step_error(on_law);
  }
  for (std::size_t q = 0; q < size(); ++q)
    if (state_[q] && trial_[q]) {
      const Vec6& increment = record_.increment()[q];
      error.square += weights[q] * std::pow(trial_[q]->error, 2) * increment.squaredNorm();
      error.size_square += weights[q] * (record_.strain()[q] + increment).squaredNorm();
    }
  return error;
}

/// Rate at which a point creeps under its stress: what the stress loses while the strain is held.
Vec6 QuasistaticPoints::creep_rate(std::size_t point) const
{
  constexpr double share = 0.01; // of the time in which something happens
  const double moment = share * shortest_time(volume(point).assembly.laws);
  if (!std::isfinite(moment))
    return Vec6::Zero();
  const auto held = step_of(point, Vec6::Zero(), moment);
  if (!held)
    return Vec6::Zero();
  const Vec6 lost = state_[point]->stress - held->state.stress;
  const Vec6 rate = pace_ / moment * held->tangent.ldlt().solve(lost);
  return rate.allFinite() ? rate : Vec6::Zero();
}

void QuasistaticPoints::commit()
{
  if (step_ > 0)
    pace_ = step_ / record_.duration();
  for (std::size_t q = 0; q < size(); ++q)
    if (state_[q] && trial_[q]) { // what was lost stays as it was
      n_passages_ += trial_[q]->n_passages;
      stress_[q] = trial_stress_[q];
      state_[q] = std::make_shared<const QuasistaticVolumeState>(std::move(trial_[q]->state));
      trial_[q].reset();
    }
  if (step_ > 0 || !has_changed_)
    last_step_ = step_;
  record_.commit(has_changed_);
  if (law_) {
    law_->commit();
    for (std::size_t q = 0; q < size(); ++q)
      if (!state_[q])
        stress_[q] = law_->stress()[q];
  }
  const bool at_jump = step_ == 0 && (!has_changed_ || record_.is_at_start());
  has_changed_ = false;
  step_ = 0;
  if (!at_jump || !record_.is_instantaneous())
    return;
  dem::for_each_realisation(int(size()), settings_.n_threads, [&](int k) {
    const auto q = std::size_t(k);
    record_.set_rate(q, state_[q] ? creep_rate(q) : law_->strain_rate(q));
  });
}

double QuasistaticPoints::share_without_change()
{
  if (step_ == 0)
    return 1;
  double share = law_ ? law_->share_without_change() : 1;
  for (std::size_t q = 0; q < size(); ++q) {
    if (!state_[q] || !trial_[q])
      continue;
    const std::vector<double> before = dem::strength_ratios(volume(q), *state_[q]);
    const std::vector<double> after = dem::strength_ratios(volume(q), trial_[q]->state);
    const double factor_before = record_.strength_factor(q, 0);
    const double factor_after = record_.strength_factor(q, 1);
    for (std::size_t b = 0; b < after.size(); ++b) {
      const double from = before[b] > 0 ? before[b] / factor_before : 0;
      const double to = after[b] > 0 ? after[b] / factor_after : 0;
      if (to >= 1 && from < 1)
        share = std::min(share, (1 - from) / (to - from));
    }
  }
  return share;
}

double QuasistaticPoints::overload()
{
  const double enough = 1 - settings_.breakage_tolerance;
  double worst = law_ ? law_->overload() : 0;
  for (std::size_t q = 0; q < size(); ++q) {
    overload_[q] = state_[q] ? std::min(strength_use(q), without_strength) : law_->overload_of(q);
    worst = std::max(worst, overload_[q]);
  }
  return worst >= enough ? std::max(1., worst) : worst;
}

void QuasistaticPoints::follow(std::span<const std::size_t> points)
{
  for (const std::size_t q : points)
    state_[q] = std::make_shared<const QuasistaticVolumeState>(dem::carried_over(
        volume(q), law_->elastic_strain(q), law_->kelvin_strains(q), record_.strain()[q]));
  if (law_)
    law_->release(points);
}

void QuasistaticPoints::change(double largest_overload)
{
  const double least = least_overload(largest_overload, settings_.breakage_tolerance);
  std::vector<std::size_t> changing, new_ones;
  for (std::size_t q = 0; q < size(); ++q)
    if (overload_[q] > 0 && overload_[q] >= least) {
      changing.push_back(q);
      if (!state_[q])
        new_ones.push_back(q);
    }
  follow(new_ones);
  for (const std::size_t q : changing) {
    const std::vector<double> ratios = dem::strength_ratios(volume(q), *state_[q]);
    const double from = largest(ratios) * (least / overload_[q]);
    std::vector<dem::Index> bonds;
    for (std::size_t b = 0; b < ratios.size(); ++b)
      if (ratios[b] > 0 && ratios[b] >= from)
        bonds.push_back(dem::Index(b));
    if (!bonds.empty() && since_[q] < 0)
      since_[q] = record_.time();
    state_[q] = std::make_shared<const QuasistaticVolumeState>(
        dem::with_broken(volume(q), *state_[q], bonds));
  }
  has_changed_ = true;
}

void QuasistaticPoints::set_last_step(double step)
{
  last_step_ = step;
  if (law_)
    law_->set_last_step(step);
}

std::size_t QuasistaticPoints::n_live() const
{
  return std::size_t(std::ranges::count_if(state_, [](const auto& each) { return bool(each); }));
}

std::size_t QuasistaticPoints::n_broken() const
{
  std::size_t n = 0;
  for (std::size_t q = 0; q < size(); ++q)
    n += state_[q] ? dem::n_broken(volume(q), *state_[q]) : 0;
  return n;
}

std::size_t QuasistaticPoints::n_bonds() const
{
  std::size_t n = 0;
  for (std::size_t q = 0; q < size(); ++q)
    n += volume(q).assembly.bonds.size();
  return n;
}

std::size_t QuasistaticPoints::n_failed() const
{
  std::size_t n = 0;
  for (std::size_t q = 0; q < size(); ++q)
    n += state_[q] && !hangs_together(volume(q), *state_[q]) ? 1 : 0;
  return n;
}

PointDamage QuasistaticPoints::damage(std::size_t point) const
{
  if (!state_[point])
    return {};
  const std::size_t broken = dem::n_broken(volume(point), *state_[point]);
  const auto elastic = step_of(point, Vec6::Zero(), 0);
  const double trace = intact_[std::size_t(volume_of_point_[point])].trace();
  return {true, double(broken) / double(volume(point).assembly.bonds.size()),
          elastic && trace > 0 ? 1 - elastic->tangent.trace() / trace : 1, since_[point]};
}

double QuasistaticPoints::strength_use(std::size_t point) const
{
  if (!state_[point])
    return law_->strength_use(point);
  const double loaded = largest(dem::strength_ratios(volume(point), *state_[point]));
  return loaded > 0 ? loaded / record_.strength_factor(point, 0) : 0;
}

double QuasistaticPoints::largest_strength_use() const
{
  double use = 0;
  for (std::size_t q = 0; q < size(); ++q)
    use = std::max(use, strength_use(q));
  return use;
}

} // namespace coupling
