#pragma once
#include "fem/curve_fit.h"

namespace fem {

/// A kind of temperature shift in terms of unbounded parameters of order one.
struct ShiftParameters {
  ShiftKind kind = ShiftKind::none;
  double reference_temperature = 293.15; ///< [K]
  std::vector<double> temperatures;      ///< measured ones [K], rising
  std::vector<Eigen::VectorXd> starts;   ///< from which a search begins
  std::vector<std::string> names, units; ///< of the constants
};

/// Parameters of a shift for the temperatures of the data.
/// \throws std::invalid_argument as `fit_curve`
ShiftParameters shift_parameters(const Measurements& data, const CurveFitOptions& options);

/// The shift of some parameters.
TemperatureShift make_shift(const ShiftParameters& parameters, const Eigen::VectorXd& x);

/// Constants of a shift in SI units, in the order of the names.
Eigen::VectorXd shift_constants(const TemperatureShift& shift);

/// Parameters of the shift that brings the data onto one non-negative series of 1.5 times a decade:
/// no form is assumed.
Eigen::VectorXd fitted_shift(const Measurements& data, const ShiftParameters& parameters);

/// Residuals of the series with the given times after a shift; not finite where the shift is
/// singular or moves data by more than 30 decades.
Eigen::VectorXd shifted_series_residuals(const Measurements& data,
                                         const ShiftParameters& parameters,
                                         const Eigen::VectorXd& x, std::span<const double> times);

} // namespace fem
