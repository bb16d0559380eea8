#pragma once
#include "fem/step_law.h"

#include <functional>
#include <span>
#include <vector>

namespace fem {

/// What the element code is told of all its points: the stress, and the tangents of the step.
struct ConstitutiveAnswer {
  std::span<const Vec6> stress;  ///< one per point [Pa]
  std::span<const Mat6> tangent; ///< the different tangents [Pa]
  std::span<const int> which;    ///< tangent of each point; empty: the first one for all
};

/// Stress and tangent at all points, given the strain increments since the last committed state and
/// the step [s] of reduced time. The element code asks this function and never sees a state. The
/// answer stands until the next call.
using ConstitutiveUpdate =
    std::function<ConstitutiveAnswer(std::span<const Vec6> increment, double step)>;

/// Error of a step that comes from what was taken as linear in it, against the size of what it is
/// an error of (strain, or stress): weighted sums of squares.
struct StepError {
  double square = 0;
  double size_square = 0;
};

/// Committed and trial states of many points that follow creep laws.
class MaterialPoints {
public:
  /// Points in the virgin state.
  /// \param laws          one or more
  /// \param law_of_point  number of the law of each point
  MaterialPoints(std::span<const ComplianceLaw> laws, std::vector<int> law_of_point,
                 TimeScheme scheme);

  std::size_t size() const { return law_of_point_.size(); }
  std::span<const int> laws() const { return law_of_point_; } ///< number of each point's law

  /// Trial states at the end of a step; the committed ones stay.
  /// \throws std::invalid_argument for a step that is negative or not finite
  ConstitutiveAnswer evaluate(std::span<const Vec6> increment, double step);

  /// The error of the step that was evaluated last, from the bend of the stress (or strain) path:
  /// its slope against that of the step before. A parabola of that bend, m off the straight line in
  /// the middle, gives 2/3 of what m held over the step gives. Third order in the step. After a
  /// jump the slope before counts as zero; a jump itself has no error.
  /// \param weights  of the points
  StepError step_error(std::span<const double> weights) const;

  /// The trial states become the committed ones.
  void commit();

  std::span<const Vec6> stress() const { return stress_; } ///< committed [Pa]
  std::span<const Vec6> strain() const { return strain_; } ///< committed [-]

  /// Size of the last committed step [s]; 0 at the start and after a jump.
  double last_step() const { return last_step_; }
  void set_last_step(double step) { last_step_ = step; }

  /// The state of a point as numbers, for storage and transfer.
  std::size_t numbers_per_point() const { return 18 + n_internal_; }
  void store(std::size_t point, std::span<double> numbers) const;
  void restore(std::size_t point, std::span<const double> numbers);

private:
  Vec6 trial_slope(std::size_t point) const;

  std::vector<SteppableLaw> laws_;
  std::vector<int> law_of_point_;
  std::size_t n_internal_ = 0; ///< most of any law
  std::vector<Vec6> strain_, stress_;
  std::vector<Vec6> slope_; ///< of what is taken as linear, over the last step [1/s], [Pa/s]
  std::vector<double> internal_;
  double last_step_ = 0;

  std::vector<StepOperator> steps_; ///< of the trial step, one per law
  std::vector<Mat6> tangents_;
  std::vector<Vec6> trial_stress_, trial_increment_;
};

} // namespace fem
