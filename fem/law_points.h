#pragma once
#include "fem/material_points.h"
#include "fem/step_law.h"

namespace fem {

/// Points that follow creep laws.
class LawPoints final : public MaterialPoints {
public:
  /// Points in the virgin state.
  /// \param laws          one or more
  /// \param law_of_point  number of the law of each point
  LawPoints(std::span<const ComplianceLaw> laws, std::vector<int> law_of_point, TimeScheme scheme);

  std::size_t size() const override { return law_of_point_.size(); }
  std::span<const int> laws() const { return law_of_point_; } ///< number of each point's law

  ConstitutiveAnswer evaluate(std::span<const Vec6> increment, double step) override;

  /// The error of the step that was evaluated last, from the bend of the stress (or strain) path:
  /// its slope against that of the step before. A parabola of that bend, m off the straight line in
  /// the middle, gives 2/3 of what m held over the step gives. Third order in the step. After a
  /// jump the slope before counts as zero; a jump itself has no error.
  /// \param weights  of the points
  StepError step_error(std::span<const double> weights) const override;

  void commit() override;

  std::span<const Vec6> stress() const override { return stress_; }
  std::span<const Vec6> strain() const override { return strain_; }
  double last_step() const override { return last_step_; }
  void set_last_step(double step) override { last_step_ = step; }
  std::size_t numbers_per_point() const override { return 18 + n_internal_; }
  void store(std::size_t point, std::span<double> numbers) const override;
  void restore(std::size_t point, std::span<const double> numbers) override;

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
