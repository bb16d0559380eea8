#pragma once
#include "fem/law_points.h"
#include "fem/step_size.h"

#include <array>
#include <span>
#include <vector>

namespace fem {

/// What is prescribed at a time: for each component (Mandel) its strain [-] or its stress [Pa].
struct PointTarget {
  double time; ///< reduced [s]
  Vec6 value;
};

/// What a point of a material shows at a time.
struct PointReading {
  double time; ///< reduced [s]
  Vec6 strain; ///< Mandel [-]
  Vec6 stress; ///< Mandel [Pa]
};

/// Readings of a point, and the sum of the estimated errors of its time steps [-].
struct PointRun {
  std::vector<PointReading> readings; ///< one per target
  double error_sum = 0;
  long n_steps = 0;
};

/// A law under a history of strains and stresses, without a mesh. What is prescribed changes
/// linearly between targets; two targets at one time make a jump, and so does a first target that
/// is not zero. Steps are chosen by the error estimate of MaterialPoints.
/// \param strain_given  by component: strain, else stress
/// \throws std::invalid_argument if times decrease or the first is negative; std::runtime_error if
///         no step is small enough
PointRun drive_point(const ComplianceLaw& law, TimeScheme scheme,
                     const std::array<bool, 6>& strain_given, std::span<const PointTarget> targets,
                     const StepSettings& settings);

} // namespace fem
