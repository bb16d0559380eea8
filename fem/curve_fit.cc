#include "fem/curve_fit.h"

#include "fem/fit_warnings.h"
#include "fem/least_squares.h"
#include "fem/shift_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace fem {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

void require(bool condition, const std::string& what)
{
  if (!condition)
    throw std::invalid_argument("fit: " + what);
}

void require_good(const Measurements& data)
{
  require(data.points.size() >= 3,
          fmt::format("three points or more are needed, found {}", data.points.size()));
  for (const Measurement& point : data.points) {
    const bool positive = point.at > 0 && point.value > 0 && point.temperature > 0;
    require(positive && std::isfinite(point.at + point.value + point.temperature),
            fmt::format("times, frequencies, values and temperatures must be finite and > 0, found "
                        "{:g}, {:g} and {:g} K",
                        point.at, point.value, point.temperature));
    require(point.weight > 0 && std::isfinite(point.weight), "weights must be finite and > 0");
    require(point.phase.has_value() == data.points.front().phase.has_value(),
            "either all points have a phase angle or none");
    require(!point.phase || (*point.phase >= 0 && *point.phase <= pi / 2),
            "phase angles lie between 0 and 90 degrees");
    require(!point.phase || data.quantity == Quantity::dynamic_modulus,
            "only the dynamic modulus has a phase angle");
  }
}

/// A fit before its report.
struct Solution {
  Form form;
  TemperatureShift shift;
  std::vector<FittedParameter> parameters;
  VectorXd residuals;
  int n_parameters; ///< of which the moved times of a series are not reported
  bool instantaneous_at_bound = false;
  bool converged = true;
  std::vector<double> times = {}; ///< of a series
};

void add_parameters(Solution& solution, const std::vector<std::string>& names,
                    const std::vector<std::string>& units, const VectorXd& values,
                    const VectorXd& errors)
{
  for (std::size_t k = 0; k < names.size(); ++k)
    solution.parameters.push_back({names[k], units[k], values[Index(k)], errors[Index(k)]});
}

/// Standard errors of constants that are functions of fitted parameters.
VectorXd errors_of(const std::function<VectorXd(const VectorXd&)>& constants, const VectorXd& x,
                   const MatrixXd& covariance)
{
  MatrixXd slope(constants(x).size(), x.size());
  for (Index j = 0; j < x.size(); ++j) {
    const VectorXd step = 1e-5 * VectorXd::Unit(x.size(), j);
    slope.col(j) = (constants(x + step) - constants(x - step)) / 2e-5;
  }
  return (slope * covariance * slope.transpose()).diagonal().cwiseMax(0).cwiseSqrt();
}

/// Few times are moved to where they serve best; many on a grid hardly gain by it.
constexpr int most_free_times = 8;

/// Times of the number that the data choose: those of the grid, or moved ones if the criterion, in
/// which each moved time counts as a parameter, is less with them.
std::vector<double> chosen_times(const Measurements& data, int n_other)
{
  const std::vector<double> grid = times_for(data, number_of_terms(data, n_other));
  const std::vector<double> moved = moved_times(data, grid);
  const auto criterion = [&](const std::vector<double>& times, int n_moved) {
    const SeriesSolution found = solve_series(data, times);
    return corrected_akaike(found.residuals.squaredNorm(), int(found.residuals.size()),
                            found.n_active + n_other + n_moved);
  };
  return !moved.empty() && criterion(moved, int(moved.size())) < criterion(grid, 0) ? moved : grid;
}

Solution solved_series(const Measurements& data, const CurveFitOptions& options,
                       const ShiftParameters& shift)
{
  const VectorXd start = fitted_shift(data, shift);
  const Measurements first = reduced(data, make_shift(shift, start));
  const std::vector<double> times = options.n_terms > most_free_times
                                        ? times_for(first, options.n_terms)
                                    : options.n_terms > 0 ? best_times(first, options.n_terms)
                                                          : chosen_times(first, int(start.size()));
  Solution solution;
  VectorXd x = start;
  if (x.size() > 0) {
    const auto residuals = [&](const VectorXd& at) {
      return shifted_series_residuals(data, shift, at, times);
    };
    const LeastSquaresResult found = levenberg_marquardt(residuals, start, 60);
    x = found.parameters;
    solution.converged = found.converged;
    const auto constants = [&](const VectorXd& at) {
      return shift_constants(make_shift(shift, at));
    };
    add_parameters(solution, shift.names, shift.units, constants(x),
                   errors_of(constants, x, covariance(found.jacobian, found.objective)));
  }
  solution.shift = make_shift(shift, x);
  const SeriesSolution found = solve_series(reduced(data, solution.shift), times);
  solution.times = times;
  solution.form = found.creep;
  solution.residuals = found.residuals;
  solution.n_parameters = found.n_active + int(x.size());
  solution.instantaneous_at_bound = found.instantaneous_at_bound;
  const bool creep = data.quantity == Quantity::creep_compliance;
  std::vector<FittedParameter> own;
  for (const auto& [time, value, error] : found.coefficients)
    if (value > 0)
      own.push_back({time == 0          ? (creep ? "D_0" : "E_inf")
                     : time == infinity ? std::string("fluidity")
                                        : fmt::format("{}({:.4g} s)", creep ? "D" : "E", time),
                     !creep             ? "Pa"
                     : time == infinity ? "1/(Pa s)"
                                        : "1/Pa",
                     value, error});
  solution.parameters.insert(solution.parameters.begin(), own.begin(), own.end());
  return solution;
}

/// Residuals of a form: errors of ln value and of the phase angle.
VectorXd form_residuals(const Form& form, const Measurements& reduced, bool with_phase)
{
  std::vector<double> at;
  for (const Measurement& point : reduced.points)
    at.push_back(point.at);
  const std::vector<Prediction> found = predictions(form, reduced.quantity, at);
  const Index n = Index(at.size());
  VectorXd result(with_phase ? 2 * n : n);
  for (Index i = 0; i < n; ++i) {
    const Measurement& point = reduced.points[std::size_t(i)];
    const double weight = std::sqrt(point.weight);
    result[i] = weight * std::log(found[std::size_t(i)].value / point.value);
    if (with_phase)
      result[n + i] = weight * (found[std::size_t(i)].phase - *point.phase);
  }
  return result;
}

Solution solved_form(const Measurements& data, const CurveFitOptions& options,
                     const ShiftParameters& shift)
{
  const bool with_phase = data.points.front().phase && options.form != FormKind::sigmoid;
  const VectorXd shift_start = fitted_shift(data, shift);
  const FormParameters form =
      form_parameters(options.form, reduced(data, make_shift(shift, shift_start)));
  const Index n_shift = shift_start.size(), n_form = form.starts.front().size();
  const auto residuals = [&](const VectorXd& x) -> VectorXd {
    try {
      const TemperatureShift now = make_shift(shift, x.tail(n_shift));
      return form_residuals(form.form(x.head(n_form)), reduced(data, now), with_phase);
    } catch (const std::invalid_argument&) { // WLF beyond its singular temperature
      return VectorXd::Constant(Index(data.points.size()) * (with_phase ? 2 : 1),
                                std::numeric_limits<double>::quiet_NaN());
    }
  };
  form_residuals(form.form(form.starts.front()), data, with_phase); // refuses what does not suit
  LeastSquaresResult best;
  best.objective = infinity;
  for (const VectorXd& start : form.starts) {
    VectorXd from(n_form + n_shift);
    from << start, shift_start;
    if (LeastSquaresResult found = levenberg_marquardt(residuals, from);
        found.objective < best.objective)
      best = std::move(found);
  }
  const VectorXd& x = best.parameters;
  Solution solution{form.form(x.head(n_form)),
                    make_shift(shift, x.tail(n_shift)),
                    {},
                    best.residuals,
                    int(x.size()),
                    false,
                    best.converged};
  const MatrixXd spread = covariance(best.jacobian, best.objective);
  const auto own = [&](const VectorXd& at) { return form.constants(form.form(at.head(n_form))); };
  const auto of_shift = [&](const VectorXd& at) {
    return shift_constants(make_shift(shift, at.tail(n_shift)));
  };
  add_parameters(solution, form.names, form.units, own(x), errors_of(own, x, spread));
  add_parameters(solution, shift.names, shift.units, of_shift(x), errors_of(of_shift, x, spread));
  return solution;
}

/// Huber's weights of the points from the residuals of a fit.
std::vector<double> huber_weights(const VectorXd& residuals, const Measurements& data)
{
  const Index n = Index(data.points.size());
  std::vector<double> size, sorted;
  for (Index i = 0; i < n; ++i) {
    const double own = residuals[i], phase = residuals.size() > n ? residuals[n + i] : 0.0;
    size.push_back(std::hypot(own, phase) / std::sqrt(data.points[std::size_t(i)].weight));
  }
  sorted = size;
  std::ranges::sort(sorted);
  const double limit = 1.345 * 1.4826 * sorted[sorted.size() / 2];
  for (double& each : size)
    each = each > limit ? limit / each : 1.0;
  return size;
}

/// Repeats a fit with Huber's weights until they stay.
Solution robust(const auto& solve, Measurements& data)
{
  const Measurements given = data;
  Solution solution = solve(data);
  for (int pass = 0; pass < 20; ++pass) {
    const std::vector<double> weights = huber_weights(solution.residuals, data);
    double change = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double next = std::max(weights[i], 1e-6) * given.points[i].weight;
      change = std::max(change, std::abs(next - data.points[i].weight));
      data.points[i].weight = next;
    }
    if (change < 1e-3)
      break;
    solution = solve(data);
  }
  return solution;
}

/// The report of a solution: points, errors, ranges.
CurveFit report(const Solution& solution, const Measurements& data, double reference_temperature,
                FormKind kind)
{
  const Measurements shifted = reduced(data, solution.shift);
  CurveFit fit;
  fit.quantity = data.quantity;
  fit.kind = kind;
  fit.form = solution.form;
  fit.shift = solution.shift;
  fit.reference_temperature = reference_temperature;
  fit.parameters = solution.parameters;
  fit.times = solution.times;
  fit.valid_time = time_range(shifted);
  fit.lowest_temperature = infinity;
  std::vector<double> at;
  for (const Measurement& point : shifted.points)
    at.push_back(point.at);
  const std::vector<Prediction> found = predictions(fit.form, data.quantity, at);
  double sum = 0, phases = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Measurement& point = data.points[i];
    const double error = found[i].value / point.value - 1;
    fit.points.push_back({at[i], found[i].value, found[i].phase, error, point.weight});
    sum += error * error;
    if (point.phase)
      phases += std::pow(found[i].phase - *point.phase, 2);
    fit.largest_relative_error = std::max(fit.largest_relative_error, std::abs(error));
    fit.lowest_temperature = std::min(fit.lowest_temperature, point.temperature);
    fit.highest_temperature = std::max(fit.highest_temperature, point.temperature);
  }
  fit.relative_rms = std::sqrt(sum / double(at.size()));
  if (data.points.front().phase)
    fit.phase_rms = std::sqrt(phases / double(at.size()));
  fit.criterion = corrected_akaike(solution.residuals.squaredNorm(), int(solution.residuals.size()),
                                   solution.n_parameters);
  return fit;
}

} // namespace

Measurements reduced(const Measurements& data, const TemperatureShift& shift)
{
  Measurements result = data;
  for (Measurement& point : result.points) {
    const double factor = shift_factor(shift, point.temperature);
    point.at = data.quantity == Quantity::dynamic_modulus ? point.at * factor : point.at / factor;
  }
  return result;
}

CurveFit fit_curve(const Measurements& given, const CurveFitOptions& options)
{
  require_good(given);
  require(options.n_terms >= 0 && options.n_terms <= 60, "a series has 1 to 60 terms");
  const ShiftParameters shift = shift_parameters(given, options);
  const auto solve = [&](const Measurements& data) {
    return options.form == FormKind::series ? solved_series(data, options, shift)
                                            : solved_form(data, options, shift);
  };
  Measurements data = given;
  const Solution solution = options.robust ? robust(solve, data) : solve(data);
  CurveFit fit = report(solution, data, shift.reference_temperature, options.form);
  fit.warnings = fit_warnings(fit, data, solution.n_parameters, solution.instantaneous_at_bound);
  if (!solution.converged)
    fit.warnings.push_back({WarningKind::not_converged, "the search did not settle"});
  return fit;
}

SeriesApproximation creep_series(const CurveFit& fit)
{
  if (const auto* series = std::get_if<CreepCompliance>(&fit.form))
    return {*series, 0.0};
  const auto [first, last] = fit.valid_time;
  if (const auto* power = std::get_if<PowerLaw>(&fit.form))
    return creep_series(*power, first, last);
  if (const auto* sigmoid = std::get_if<SigmoidalModulus>(&fit.form))
    return creep_series(*sigmoid, first, last);
  return creep_series(std::get<TwoSpringsTwoParabolasDashpot>(fit.form), first, last);
}

std::optional<FitWarning> outside_range(const CurveFit& fit, double reduced_time,
                                        double temperature)
{
  const auto [first, last] = fit.valid_time;
  if (reduced_time < first || reduced_time > last)
    return FitWarning{
        WarningKind::extrapolation,
        fmt::format("the reduced time {:.3g} s is outside the measured range {:.3g} s "
                    "to {:.3g} s",
                    reduced_time, first, last)};
  if (temperature < fit.lowest_temperature || temperature > fit.highest_temperature)
    return FitWarning{WarningKind::extrapolation,
                      fmt::format("{:.4g} degC is outside the measured range {:.4g} to {:.4g} degC",
                                  temperature - 273.15, fit.lowest_temperature - 273.15,
                                  fit.highest_temperature - 273.15)};
  return {};
}

} // namespace fem
