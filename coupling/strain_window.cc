#include "coupling/strain_window.h"

#include <algorithm>
#include <cassert>

namespace coupling {

void StrainWindow::append(double time, std::span<const fem::Vec6> strain, double oldest)
{
  assert(strain.size() == n_points_);
  std::size_t n_old = 0; // one at or before the oldest time stays
  while (n_old + 1 < times_.size() && times_[n_old + 1] <= oldest)
    ++n_old;
  times_.erase(times_.begin(), times_.begin() + long(n_old));
  strains_.erase(strains_.begin(), strains_.begin() + long(n_old));
  if (times_.size() == most_times) {
    std::size_t least = 1;
    for (std::size_t k = 2; k + 1 < times_.size(); ++k)
      if (times_[k + 1] - times_[k - 1] < times_[least + 1] - times_[least - 1])
        least = k;
    times_.erase(times_.begin() + long(least));
    strains_.erase(strains_.begin() + long(least));
  }
  times_.push_back(time);
  strains_.emplace_back(strain.begin(), strain.end());
}

fem::Vec6 StrainWindow::at(std::size_t point, double time) const
{
  if (times_.empty())
    return fem::Vec6::Zero();
  const auto after = std::ranges::upper_bound(times_, time);
  if (after == times_.begin())
    return strains_.front()[point];
  if (after == times_.end())
    return strains_.back()[point];
  const auto k = std::size_t(after - times_.begin());
  const double share = (time - times_[k - 1]) / (times_[k] - times_[k - 1]);
  return (1 - share) * strains_[k - 1][point] + share * strains_[k][point];
}

void StrainWindow::store(std::size_t point, std::span<double> numbers) const
{
  std::ranges::fill(numbers, 0);
  numbers[0] = double(times_.size());
  for (std::size_t k = 0; k < times_.size(); ++k) {
    numbers[1 + 7 * k] = times_[k];
    std::copy_n(strains_[k][point].data(), 6, &numbers[2 + 7 * k]);
  }
}

void StrainWindow::restore(std::size_t point, std::span<const double> numbers)
{
  const auto n = std::size_t(numbers[0]);
  times_.resize(n);
  strains_.resize(n, std::vector<fem::Vec6>(n_points_, fem::Vec6::Zero()));
  for (std::size_t k = 0; k < n; ++k) {
    times_[k] = numbers[1 + 7 * k];
    strains_[k][point] = Eigen::Map<const fem::Vec6>(&numbers[2 + 7 * k]);
  }
}

} // namespace coupling
