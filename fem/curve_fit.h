#pragma once
#include "fem/form_parameters.h"
#include "fem/series_fit.h"
#include "fem/temperature_shift.h"

#include <optional>
#include <string>
#include <vector>

namespace fem {

enum class ShiftKind { none, wlf, arrhenius, free };

/// What to fit, and how.
struct CurveFitOptions {
  FormKind form = FormKind::series;
  /// Of a series: 0: chosen by the data (`number_of_terms`); up to 8: the best ones (`best_times`);
  /// more: on a grid.
  int n_terms = 0;
  bool robust = false; ///< Huber weights: errors beyond 1.345 standard deviations count linearly
  ShiftKind shift = ShiftKind::none;
  /// [K]; default: the measured one nearest to 20 degC
  std::optional<double> reference_temperature = std::nullopt;
};

/// A constant of a fit in SI units.
struct FittedParameter {
  std::string name, unit;
  double value;
  double standard_error; ///< linearised, from the scatter around the fit
};

/// One measured point and what the fit says about it.
struct FittedPoint {
  double reduced;        ///< reduced time [s] or frequency [Hz]
  double value;          ///< of the measured quantity
  double phase;          ///< phase angle [rad]; 0 where the quantity has none
  double relative_error; ///< value / measured - 1
  double weight;         ///< of the squared error, with the robust factor
};

enum class WarningKind {
  few_points,           ///< hardly more than constants
  few_decades,          ///< too short a range for a law
  unseen_instantaneous, ///< D_0 lies below what the data show
  uncertain_parameter,  ///< standard error as large as the value
  close_times,          ///< retardation times that data cannot tell apart
  weak_overlap,         ///< temperatures whose reduced ranges do not meet
  poor_fit,             ///< relative rms above 10 %
  not_converged,
  extrapolation ///< asked for outside the valid range
};

struct FitWarning {
  WarningKind kind;
  std::string text; ///< one sentence
};

/// A fitted curve.
struct CurveFit {
  Quantity quantity = Quantity::creep_compliance;
  FormKind kind = FormKind::series;
  Form form; ///< over reduced time
  TemperatureShift shift;
  double reference_temperature = 293.15;   ///< [K]
  std::vector<FittedParameter> parameters; ///< of the form, then of the shift
  std::vector<double> times;               ///< of a series, with those whose coefficient is 0 [s]
  std::vector<FittedPoint> points;         ///< in the order of the measurements
  double relative_rms = 0;                 ///< of `relative_error`, unweighted
  double largest_relative_error = 0;
  std::optional<double> phase_rms; ///< [rad]
  double criterion = 0;            ///< `corrected_akaike` of the minimised residuals
  TimeRange valid_time{};          ///< reduced times that were measured [s] (1/omega)
  double lowest_temperature = 0, highest_temperature = 0; ///< [K]
  std::vector<FitWarning> warnings;
};

/// Fits a curve, with the temperature shift at the same time if the data have several temperatures.
///
/// The series is solved by non-negative least squares inside the search for the shift (variable
/// projection); the other forms by Levenberg's and Marquardt's method from several fixed starts, in
/// the logarithms of modulus and compliance and the phase angle. The sigmoid looks at |E*| only.
/// Errors are relative everywhere. Fits are repeatable: nothing is drawn at random.
/// \throws std::invalid_argument saying what is wrong with the data or the choice: fewer than three
///         points, numbers that are not positive and finite, phase angles for some points only or
///         outside 0..90 degrees, several temperatures without a shift, too few for it, a free
///         shift whose reference temperature was not measured, a form that does not suit
CurveFit fit_curve(const Measurements& data, const CurveFitOptions& options);

/// The measurements at the reference temperature: times divided, frequencies multiplied by a_T.
Measurements reduced(const Measurements& data, const TemperatureShift& shift);

/// The law of a fit as a series, which is what a `ComplianceLaw` takes; exact for series and
/// Burgers element, else the nearest over the valid range with the error stated.
SeriesApproximation creep_series(const CurveFit& fit);

/// A warning if a reduced time [s] or a temperature [K] is outside what was measured.
std::optional<FitWarning> outside_range(const CurveFit& fit, double reduced_time,
                                        double temperature);

} // namespace fem
