#include "fem/law_points.h"

#include <algorithm>
#include <cassert>

namespace fem {

LawPoints::LawPoints(std::span<const ComplianceLaw> laws, std::vector<int> law_of_point,
                     TimeScheme scheme)
    : law_of_point_(std::move(law_of_point))
{
  for (const ComplianceLaw& law : laws) {
    laws_.push_back(steppable_law(law, scheme));
    n_internal_ = std::max(n_internal_, std::size_t(laws_.back().time.size()));
  }
  const std::size_t n = law_of_point_.size();
  for (std::vector<Vec6>* field : {&strain_, &stress_, &slope_, &trial_stress_, &trial_increment_})
    field->assign(n, Vec6::Zero());
  internal_.assign(n * n_internal_, 0);
}

ConstitutiveAnswer LawPoints::evaluate(std::span<const Vec6> increment, double step)
{
  assert(increment.size() == size());
  if (steps_.empty() || steps_.front().step != step) {
    steps_.clear();
    tangents_.clear();
    for (const SteppableLaw& law : laws_) {
      steps_.push_back(step_operator(law, step));
      tangents_.push_back(steps_.back().tangent);
    }
  }
  for (std::size_t q = 0; q < size(); ++q) {
    const SteppableLaw& law = laws_[law_of_point_[q]];
    const Eigen::Map<const Eigen::VectorXd> internal(&internal_[q * n_internal_], law.time.size());
    trial_increment_[q] = increment[q];
    trial_stress_[q] = stress_[q] + stress_increment(law, steps_[law_of_point_[q]], stress_[q],
                                                     internal, increment[q]);
  }
  return {trial_stress_, tangents_,
          laws_.size() > 1 ? std::span<const int>(law_of_point_) : std::span<const int>()};
}

/// Of the stress or the strain over the trial step.
Vec6 LawPoints::trial_slope(std::size_t point) const
{
  if (laws_.front().scheme == TimeScheme::stress_linear)
    return (trial_stress_[point] - stress_[point]) / steps_.front().step;
  return trial_increment_[point] / steps_.front().step;
}

StepError LawPoints::step_error(std::span<const double> weights) const
{
  StepError error;
  const double h = steps_.front().step;
  if (h == 0)
    return error;
  const double before = last_step_ > 0 ? last_step_ : h;
  for (std::size_t q = 0; q < size(); ++q) {
    const Vec6 middle = h * h / 4 / (h + before) * (trial_slope(q) - slope_[q]);
    const Vec6 wrong = 2. / 3 * (steps_[law_of_point_[q]].held * middle);
    const bool of_strain = laws_.front().scheme == TimeScheme::stress_linear;
    const Vec6 size = of_strain ? Vec6(strain_[q] + trial_increment_[q]) : trial_stress_[q];
    error.square += weights[q] * wrong.squaredNorm();
    error.size_square += weights[q] * size.squaredNorm();
  }
  return error;
}

void LawPoints::commit()
{
  const double h = steps_.front().step;
  for (std::size_t q = 0; q < size(); ++q) {
    const SteppableLaw& law = laws_[law_of_point_[q]];
    Eigen::Map<Eigen::VectorXd> internal(&internal_[q * n_internal_], law.time.size());
    slope_[q] = h > 0 ? trial_slope(q) : Vec6::Zero();
    advance_internal(law, steps_[law_of_point_[q]], stress_[q], trial_stress_[q] - stress_[q],
                     trial_increment_[q], internal);
    stress_[q] = trial_stress_[q];
    strain_[q] += trial_increment_[q];
  }
  last_step_ = h;
}

void LawPoints::store(std::size_t point, std::span<double> numbers) const
{
  assert(numbers.size() == numbers_per_point());
  auto to = numbers.begin();
  for (const std::vector<Vec6>* field : {&strain_, &stress_, &slope_})
    to = std::copy_n((*field)[point].data(), 6, to);
  std::copy_n(internal_.begin() + long(point * n_internal_), n_internal_, to);
}

void LawPoints::restore(std::size_t point, std::span<const double> numbers)
{
  assert(numbers.size() == numbers_per_point());
  auto from = numbers.begin();
  for (std::vector<Vec6>* field : {&strain_, &stress_, &slope_}) {
    std::copy_n(from, 6, (*field)[point].data());
    from += 6;
  }
  std::copy_n(from, n_internal_, internal_.begin() + long(point * n_internal_));
}

} // namespace fem
