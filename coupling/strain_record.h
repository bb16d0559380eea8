#pragma once
#include "coupling/strain_window.h"
#include "dem/strength.h"

#include <span>
#include <vector>

namespace coupling {

/// Strains of many points and the rates that strengths see: without jumps, averaged over the window
/// of the rate law. Within a step strains are taken as linear.
class StrainRecord {
public:
  /// \param start  time at which all is at rest [s]
  StrainRecord(std::size_t n_points, const dem::RateLaw& rate_law, double start);

  void begin_step(double time, double duration);
  void try_step(std::span<const fem::Vec6> increment);

  /// \param after_change  it is a jump that follows from a change: rates are those before it
  void commit(bool after_change);

  std::span<const fem::Vec6> strain() const { return strain_; }       ///< committed [-]
  std::span<const fem::Vec6> increment() const { return increment_; } ///< of the trial step [-]
  double time() const { return time_; }                               ///< committed [s]
  double duration() const { return duration_; }                       ///< of the trial step [s]

  /// Whether strengths see the rate of the instant, as no window has passed yet or none is asked
  /// for.
  bool is_instantaneous() const;

  bool is_at_start() const { return time_ <= start_; } ///< no time has passed yet

  /// The rate of the instant [1/s], where a jump or a step does not tell it.
  void set_rate(std::size_t point, const fem::Vec6& rate) { rate_[point] = rate; }

  /// Factor of the strengths of a point at a share of the trial step [-].
  double strength_factor(std::size_t point, double share) const;

  std::size_t numbers_per_point() const { return 18 + StrainWindow::n_numbers; }
  void store(std::size_t point, std::span<double> numbers) const;
  void restore(std::size_t point, std::span<const double> numbers);

private:
  double window_start(double time) const;
  fem::Vec6 smooth_rate(std::size_t point, double share) const;

  dem::RateLaw rate_law_;
  double start_, time_, duration_ = 0;
  std::vector<fem::Vec6> strain_, increment_;
  std::vector<fem::Vec6> jumps_; ///< strain that came in jumps
  std::vector<fem::Vec6> rate_;  ///< at present, or over the last step in time [1/s]
  StrainWindow window_;
};

} // namespace coupling
