#include "fem/shift_fit.h"

#include "fem/least_squares.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

namespace fem {

namespace {

using Eigen::Index, Eigen::VectorXd;

void require(bool condition, const std::string& what)
{
  if (!condition)
    throw std::invalid_argument("fit: " + what);
}

/// Times spread over the reduced range of the data and a decade beyond.
std::vector<double> search_grid(const Measurements& reduced)
{
  const auto [first, last] = time_range(reduced);
  const int n = 1 + int(std::ceil(1.5 * (2 + std::log10(last / first))));
  return retardation_grid(first / 10, last * 10, n);
}

/// Free factors as another shift has them.
VectorXd factors_of(const TemperatureShift& shift, const ShiftParameters& parameters)
{
  std::vector<double> result;
  for (const double temperature : parameters.temperatures)
    if (temperature != parameters.reference_temperature)
      result.push_back(std::log10(shift_factor(shift, temperature)));
  return Eigen::Map<VectorXd>(result.data(), Index(result.size()));
}

} // namespace

ShiftParameters shift_parameters(const Measurements& data, const CurveFitOptions& options)
{
  std::set<double> different;
  for (const Measurement& point : data.points)
    different.insert(point.temperature);
  ShiftParameters result;
  result.kind = options.shift;
  result.temperatures = {different.begin(), different.end()};
  const auto from_20 = [](double temperature) { return std::abs(temperature - 293.15); };
  result.reference_temperature = options.reference_temperature.value_or(
      *std::ranges::min_element(result.temperatures, {}, from_20));
  const std::size_t n = result.temperatures.size();
  if (options.shift == ShiftKind::none) {
    require(n == 1, fmt::format("the data have {} temperatures: choose a shift", n));
    result.reference_temperature = result.temperatures.front();
    result.starts = {VectorXd(0)};
  } else if (options.shift == ShiftKind::wlf) {
    require(n >= 3, fmt::format("a WLF shift needs three temperatures, the data have {}", n));
    for (const double c2 : {100.0, 200.0})
      result.starts.push_back(Eigen::Vector2d(std::log(0.1 * c2), std::log(c2)));
    result.names = {"C_1", "C_2"};
    result.units = {"1", "K"};
  } else if (options.shift == ShiftKind::arrhenius) {
    require(n >= 2, "an Arrhenius shift needs two temperatures, the data have one");
    result.starts = {VectorXd::Constant(1, 2.0)};
    result.names = {"E_a"};
    result.units = {"J/mol"};
  } else {
    require(n >= 2, "a free shift needs two temperatures, the data have one");
    require(different.contains(result.reference_temperature),
            fmt::format("a free shift needs a measured temperature as reference; {:g} K is none",
                        result.reference_temperature));
    for (const double temperature : result.temperatures)
      if (temperature != result.reference_temperature) {
        result.names.push_back(fmt::format("log10 a_T({:g} degC)", temperature - 273.15));
        result.units.push_back("1");
      }
    result.starts = {factors_of(ArrheniusShift{2e5, result.reference_temperature}, result),
                     factors_of(ArrheniusShift{1e5, result.reference_temperature}, result)};
  }
  return result;
}

TemperatureShift make_shift(const ShiftParameters& parameters, const VectorXd& x)
{
  const double reference = parameters.reference_temperature;
  if (parameters.kind == ShiftKind::wlf)
    return WlfShift{std::exp(x[0]), std::exp(x[1]), reference};
  if (parameters.kind == ShiftKind::arrhenius)
    return ArrheniusShift{1e5 * x[0], reference};
  if (parameters.kind == ShiftKind::none)
    return {};
  FreeShift shift{parameters.temperatures, {}, reference};
  Index at = 0;
  for (const double temperature : parameters.temperatures)
    shift.log10_factors.push_back(temperature == reference ? 0.0 : x[at++]);
  return shift;
}

VectorXd shift_constants(const TemperatureShift& shift)
{
  if (const auto* wlf = std::get_if<WlfShift>(&shift))
    return Eigen::Vector2d(wlf->c1, wlf->c2);
  if (const auto* arrhenius = std::get_if<ArrheniusShift>(&shift))
    return VectorXd::Constant(1, arrhenius->activation_energy);
  if (const auto* free = std::get_if<FreeShift>(&shift)) {
    std::vector<double> result;
    for (std::size_t i = 0; i < free->temperatures.size(); ++i)
      if (free->temperatures[i] != free->reference_temperature)
        result.push_back(free->log10_factors[i]);
    return Eigen::Map<VectorXd>(result.data(), Index(result.size()));
  }
  return VectorXd(0);
}

VectorXd shifted_series_residuals(const Measurements& data, const ShiftParameters& parameters,
                                  const VectorXd& x, std::span<const double> times)
{
  const TemperatureShift shift = make_shift(parameters, x);
  const VectorXd nothing =
      VectorXd::Constant(Index(data.points.size()), std::numeric_limits<double>::quiet_NaN());
  for (const double temperature : parameters.temperatures) {
    try {
      if (!(std::abs(std::log10(shift_factor(shift, temperature))) < 30))
        return nothing;
    } catch (const std::invalid_argument&) { // WLF beyond its singular temperature
      return nothing;
    }
  }
  return solve_series(reduced(data, shift), times).residuals;
}

VectorXd fitted_shift(const Measurements& data, const ShiftParameters& parameters)
{
  if (parameters.kind == ShiftKind::none)
    return VectorXd(0);
  VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (VectorXd start : parameters.starts)
    for (int pass = 0; pass < 2; ++pass) { // the grid follows the shift once
      const std::vector<double> times = search_grid(reduced(data, make_shift(parameters, start)));
      const auto residuals = [&](const VectorXd& x) {
        VectorXd found = shifted_series_residuals(data, parameters, x, times);
        return found;
      };
      const LeastSquaresResult found = levenberg_marquardt(residuals, start, 60);
      start = found.parameters;
      if (pass == 1 && found.objective < least) {
        least = found.objective;
        best = found.parameters;
      }
    }
  return best;
}

} // namespace fem
