#include "coupling/strain_record.h"

#include "coupling/breaking_points.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace coupling {

using fem::Vec6;

namespace {

/// Whether a span of time is more than rounding.
bool is_span(double span, double time)
{
  return span > 1e-14 * std::abs(time);
}

} // namespace

StrainRecord::StrainRecord(std::size_t n_points, const dem::RateLaw& rate_law, double start)
    : rate_law_(rate_law), start_(start), time_(start), window_(n_points)
{
  for (std::vector<Vec6>* field : {&strain_, &increment_, &jumps_, &rate_})
    field->assign(n_points, Vec6::Zero());
}

void StrainRecord::begin_step(double time, double duration)
{
  time_ = time;
  duration_ = duration;
}

void StrainRecord::try_step(std::span<const Vec6> increment)
{
  std::ranges::copy(increment, increment_.begin());
}

void StrainRecord::commit(bool after_change)
{
  for (std::size_t q = 0; q < strain_.size(); ++q) {
    strain_[q] += increment_[q];
    if (duration_ > 0)
      rate_[q] = increment_[q] / duration_;
    else {
      jumps_[q] += increment_[q];
      if (!after_change)
        rate_[q].setZero();
    }
    increment_[q].setZero();
  }
  time_ += duration_;
  if (duration_ > 0 || window_.empty()) {
    std::vector<Vec6> smooth(strain_.size());
    for (std::size_t q = 0; q < strain_.size(); ++q)
      smooth[q] = strain_[q] - jumps_[q];
    window_.append(time_, smooth, window_start(time_));
  }
  duration_ = 0;
}

double StrainRecord::window_start(double time) const
{
  const double fraction = rate_law_.window_fraction * (time - start_);
  return std::max(start_, time - std::max(rate_law_.window, fraction));
}

bool StrainRecord::is_instantaneous() const
{
  return !is_span(time_ - window_start(time_), time_);
}

Vec6 StrainRecord::smooth_rate(std::size_t point, double share) const
{
  const double time = time_ + share * duration_, from = window_start(time), span = time - from;
  if (!is_span(span, time))
    return share > 0 && duration_ > 0 ? Vec6(increment_[point] / duration_) : rate_[point];
  const auto smooth = [&](double s) {
    return Vec6(strain_[point] - jumps_[point] + s * increment_[point]);
  };
  const bool within = from > time_ && duration_ > 0;
  const Vec6 before = within ? smooth((from - time_) / duration_) : window_.at(point, from);
  return (smooth(duration_ > 0 ? share : 0) - before) / span;
}

double StrainRecord::strength_factor(std::size_t point, double share) const
{
  return dem::strength_factor(rate_law_, largest_principal(smooth_rate(point, share)));
}

void StrainRecord::store(std::size_t point, std::span<double> numbers) const
{
  assert(numbers.size() == numbers_per_point());
  auto to = numbers.begin();
  for (const auto* field : {&strain_, &jumps_, &rate_})
    to = std::copy_n((*field)[point].data(), 6, to);
  window_.store(point, numbers.last(StrainWindow::n_numbers));
}

void StrainRecord::restore(std::size_t point, std::span<const double> numbers)
{
  assert(numbers.size() == numbers_per_point());
  auto from = numbers.begin();
  for (auto* field : {&strain_, &jumps_, &rate_}) {
    std::copy_n(from, 6, (*field)[point].data());
    from += 6;
  }
  window_.restore(point, numbers.last(StrainWindow::n_numbers));
}

} // namespace coupling
