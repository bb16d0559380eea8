#pragma once
#include "fem/compliance_law.h"

#include <span>
#include <vector>

namespace fem {

/// Compliance tensor seen at one time.
struct ComplianceSample {
  double time;     ///< [s], >= 0
  Mat6 compliance; ///< S(t), Mandel [1/Pa], symmetric
  double weight = 1;
};

/// Complex compliance tensor seen at one angular frequency.
struct ComplexComplianceSample {
  double omega;           ///< [rad/s], > 0
  ComplexMat6 compliance; ///< S* = S' - i S'', Mandel [1/Pa]
  double weight = 1;
};

/// A law fitted to tensors.
struct TensorFit {
  ComplianceLaw law;   ///< terms whose matrix came out as zero are left out
  double relative_rms; ///< root mean square of |S_fit - S| / |S| over the samples (weighted)
  double largest_relative_error;
  double optimality_gap; ///< bound on what the squared relative rms could still lose [-]
  int iterations;
};

/// How `fit_compliance_law` finds its optimum.
struct TensorFitOptions {
  bool flow = true;   ///< with a fluidity S_v
  double gap = 1e-12; ///< the optimality gap asked for, of the mean squared sample (1)
  int max_iterations = 100;
};

/// Law with the given retardation times nearest to samples of S(t): least sum of squared relative
/// errors weight |S_fit - S|^2 / |S|^2 in Frobenius norm under the condition that S_0, S_v and
/// every S_k are positive semidefinite. Nothing is clipped afterwards.
///
/// The problem is convex with one solution. A primal-dual interior-point method (Nesterov-Todd
/// directions) comes close to it; sweeps over the matrices, each moved to its exact minimum in
/// the cone with the others held, then make ranks and zeros exact. The gap that is reported bounds
/// the distance from the optimum. A proportional set of samples gives proportional matrices.
/// Cost: about 30 solves with 21 unknowns per matrix; 13 times take some 0.3 s.
/// \throws std::invalid_argument for samples or times that are not finite, not symmetric (1e-8), or
///         fewer than one, or if the best S_0 is singular (the samples do not show it)
TensorFit fit_compliance_law(std::span<const ComplianceSample> samples,
                             std::span<const double> retardation_times,
                             const TensorFitOptions& options = {});

/// The same for samples of S*(omega); real and imaginary parts together are the sample.
TensorFit fit_compliance_law(std::span<const ComplexComplianceSample> samples,
                             std::span<const double> retardation_times,
                             const TensorFitOptions& options = {});

} // namespace fem
