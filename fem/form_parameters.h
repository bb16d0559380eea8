#pragma once
#include "fem/measurements.h"
#include "fem/rheological_forms.h"

#include <Eigen/Core>

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace fem {

/// The curves that can be fitted. Series and Burgers element are both a `CreepCompliance`.
enum class FormKind { series, burgers, power, sigmoid, two_springs };

using Form =
    std::variant<CreepCompliance, PowerLaw, SigmoidalModulus, TwoSpringsTwoParabolasDashpot>;

/// What a form says about a measured point.
struct Prediction {
  double value; ///< of the measured quantity
  double phase; ///< phase angle [rad]; 0 where the quantity has none
};

/// Predictions at reduced times or frequencies.
/// \throws std::invalid_argument if the form has no closed expression of the quantity: the power
///         law has no relaxation modulus, sigmoid and 2S2P1D are forms of the dynamic modulus only
std::vector<Prediction> predictions(const Form& form, Quantity quantity,
                                    const std::vector<double>& at);

/// A form of a few constants in terms of unbounded parameters of order one (logarithms of positive
/// constants, logits of those between 0 and 1).
struct FormParameters {
  std::vector<std::string> names; ///< of the constants
  std::vector<std::string> units;
  std::vector<Eigen::VectorXd> starts; ///< from which a search begins; fixed by the data's ends
  std::function<Form(const Eigen::VectorXd&)> form;
  std::function<Eigen::VectorXd(const Form&)> constants; ///< in SI units, in the order of the names
};

/// The glassy modulus E_0 of 2S2P1D is kept below E_00 plus so many times the largest measured
/// modulus: data that end before the plateau would let it grow without end.
inline constexpr double largest_glassy_ratio = 4;

/// Parameters of any form but the series, with starts for measurements over reduced time or
/// frequency.
FormParameters form_parameters(FormKind kind, const Measurements& reduced);

} // namespace fem
