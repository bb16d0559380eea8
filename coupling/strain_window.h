#pragma once
#include "fem/types.h"

#include <span>
#include <vector>

namespace coupling {

/// Strains of many points at the latest times: what an average over a window needs. Times are those
/// of all points; when there are too many, the one that is nearest to its neighbours goes.
/// Strains between two times are taken as linear.
class StrainWindow {
public:
  static constexpr std::size_t most_times = 32;

  explicit StrainWindow(std::size_t n_points) : n_points_(n_points) {}

  /// Appends the present strains; those that no window from `oldest` on needs are forgotten.
  void append(double time, std::span<const fem::Vec6> strain, double oldest);

  /// Strain at a time; before the first one that is kept, that one's.
  fem::Vec6 at(std::size_t point, double time) const;

  bool empty() const { return times_.empty(); }
  double first_time() const { return times_.front(); }

  /// What is kept of a point as numbers, and back; all points must be given the same times.
  static constexpr std::size_t n_numbers = 1 + 7 * most_times;
  void store(std::size_t point, std::span<double> numbers) const;
  void restore(std::size_t point, std::span<const double> numbers);

private:
  std::size_t n_points_;
  std::vector<double> times_;                   ///< [s], rising
  std::vector<std::vector<fem::Vec6>> strains_; ///< by time, by point
};

} // namespace coupling
