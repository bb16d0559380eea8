#pragma once
#include "fem/compliance_law.h"

#include <Eigen/Core>

namespace fem {

/// What is taken to change linearly with time within a step. The update is then exact for any step
/// size; for other histories its error is of second order in the step.
enum class TimeScheme {
  stress_linear, ///< exact under constant and linearly growing stress: creep; not L-stable
  strain_linear  ///< exact under held and linearly growing strain: relaxation; L-stable
};

/// A creep law with scalar internal variables z, one per column of L and its time:
///
///   stress linear:  strain = S_0 sigma + S_v int sigma + L z,  tau z' = L^T sigma - z
///   strain linear:  stress = C_inf eps + L z,                  z' = L^T eps' - z / tau
///
/// with L diag L^T the matrices of the creep form or of the relaxation form.
struct SteppableLaw {
  TimeScheme scheme = TimeScheme::stress_linear;
  Mat6 instantaneous = Mat6::Zero();               ///< S_0 [1/Pa], or C(0) [Pa]
  Mat6 lasting = Mat6::Zero();                     ///< S_v [1/(Pa s)], or C_inf [Pa]
  Eigen::Matrix<double, 6, Eigen::Dynamic> factor; ///< L [1/sqrt(Pa)], or [sqrt(Pa)]
  Eigen::ArrayXd time;                             ///< retardation or relaxation times [s]
};

/// Directions in which a matrix of the law is below 1e-13 of its own largest carry no variable.
SteppableLaw steppable_law(const ComplianceLaw& law, TimeScheme scheme);

/// A law over a step of one size. The stress is affine in the strain increment,
/// d sigma = tangent (d eps - creep), and the tangent does not depend on the state.
struct StepOperator {
  double step = 0;             ///< [s], >= 0; 0 is a jump
  Mat6 tangent = Mat6::Zero(); ///< d stress / d strain increment [Pa], positive definite
  Mat6 held = Mat6::Zero();    ///< stress linear: strain of a constant unit stress [1/Pa];
                               ///< strain linear: stress lost under a held unit strain [Pa]
  Eigen::ArrayXd decay;        ///< 1 - exp(-h / tau)
  Eigen::ArrayXd ramp;         ///< stress linear: x phi_2(x); strain linear: phi_1(x)
};

/// \throws std::invalid_argument for a step that is negative or not finite
StepOperator step_operator(const SteppableLaw& law, double step);

/// Change of the stress over a step [Pa].
/// \param stress     at its start [Pa]
/// \param internal   variables at its start
/// \param increment  of the strain [-]
Vec6 stress_increment(const SteppableLaw& law, const StepOperator& step, const Vec6& stress,
                      const Eigen::Ref<const Eigen::VectorXd>& internal, const Vec6& increment);

/// Internal variables at the end of a step.
/// \param stress  at its start; `stress_change` and `increment` over the step
void advance_internal(const SteppableLaw& law, const StepOperator& step, const Vec6& stress,
                      const Vec6& stress_change, const Vec6& increment,
                      Eigen::Ref<Eigen::VectorXd> internal);

/// (1 - exp(-x)) / x, and (x - 1 + exp(-x)) / x^2, for x >= 0 to rounding.
double phi_1(double x);
double phi_2(double x);

} // namespace fem
