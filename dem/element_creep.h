#pragma once
#include "dem/homogenization.h"
#include "dem/law_step.h"

#include <span>
#include <vector>

namespace dem {

/// A periodic volume element with any creep laws, small strain, no breakage: what does not change
/// in time.
struct ElementModel {
  MacroNetwork macro;
  std::vector<Pin> pins;
  std::vector<CreepLaw> laws;
  int n_parts; ///< numbers that a mode of a bond remembers
};

/// \throws std::invalid_argument if the element was cut out of a packing
ElementModel make_element_model(const VolumeElement& element);

/// Everything the future depends on: a value.
struct ElementState {
  double time = 0;            ///< [s]
  Vec6 strain = Vec6::Zero(); ///< mean, Mandel notation [-]
  Vec6 stress = Vec6::Zero(); ///< [Pa]
  Eigen::VectorXd dofs;       ///< motion of the particles on top of the mean strain [m]
  std::vector<double> memory; ///< of each mode of each bond, n_parts each (see LawStep)
};
ElementState virgin_state(const ElementModel& model);

/// A step of one length: law by law what it does to the memory of a bond, and the factorised
/// network with the algorithmic stiffnesses. Serves all states and loads.
class ElementStep {
public:
  /// \param duration  [s], >= 0; 0 for a jump of load
  ElementStep(const ElementModel& model, StepScheme scheme, double duration);

  /// The state after the step. The load holds at its end; bond forces (or displacements, by the
  /// scheme) are taken as linear in between. Second order in the length of the step, and exact
  /// while bond forces (displacements) are linear.
  ElementState advance(const ElementModel& model, const ElementState& state,
                       const MacroLoad& load) const;

  double duration() const { return duration_; }

private:
  double duration_;
  std::vector<LawStep> law_;
  std::vector<double> stiffness_; ///< of each law, algorithmic [N/m]
  MacroSolver solver_;
  Eigen::MatrixXd loads_; ///< nodal forces under unit mean strains
  Eigen::MatrixXd moves_; ///< dofs under unit mean strains
  Mat6 macro_stiffness_;  ///< [Pa]
};

/// What is prescribed at a time. Two entries with one time make a jump.
struct MacroPoint {
  double time; ///< [s]
  MacroLoad load;
};

/// States at the given points, one step to each; equal steps share a factorisation.
/// \throws std::invalid_argument if the times decrease or start before the state
std::vector<ElementState> follow(const ElementModel& model, const ElementState& start,
                                 std::span<const MacroPoint> points, StepScheme scheme);

/// S(t) at given times.
struct CreepHistory {
  std::vector<double> time;     ///< [s]
  std::vector<Mat6> compliance; ///< [1/Pa]
  std::vector<double> error;    ///< estimated, relative, of the last interval
  int n_steps = 0, n_factorisations = 0;
};

/// Six creep tests, each under one unit mean stress from t = 0+ on. Each interval between two times
/// is cut into equal steps, twice as many until the result changes by less than the tolerance.
/// Within an interval the steps share one factorisation.
/// \param times      [s], increasing, >= 0
/// \param tolerance  relative, per interval
/// \throws std::invalid_argument for times or a tolerance out of range
CreepHistory creep_compliance(const ElementModel& model, std::span<const double> times,
                              double tolerance);

} // namespace dem
