#include "fem/fit_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace fem {

namespace {

/// Neighbouring temperatures whose reduced ranges leave a gap.
std::vector<std::string> gaps(const CurveFit& fit, const Measurements& data)
{
  std::map<double, std::pair<double, double>> range; // by temperature
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const double at = fit.points[i].reduced;
    auto& [low, high] = range.try_emplace(data.points[i].temperature, at, at).first->second;
    low = std::min(low, at);
    high = std::max(high, at);
  }
  std::vector<std::string> result;
  for (auto here = range.begin(); here != range.end() && std::next(here) != range.end(); ++here) {
    const auto& [low, high] = here->second;
    const auto& [next_low, next_high] = std::next(here)->second;
    if (high < next_low || next_high < low)
      result.push_back(fmt::format("the reduced ranges of {:.4g} and {:.4g} degC do not overlap: "
                                   "their shift rests on the form of the curve",
                                   here->first - 273.15, std::next(here)->first - 273.15));
  }
  return result;
}

/// The glassy modulus stands at the bound that keeps it finite.
bool glassy_at_bound(const CurveFit& fit, const Measurements& data)
{
  const auto* law = std::get_if<TwoSpringsTwoParabolasDashpot>(&fit.form);
  double largest = 0;
  for (const Measurement& point : data.points)
    largest = std::max(largest, point.value);
  return law && law->glassy_modulus > 0.95 * largest_glassy_ratio * largest;
}

/// Times of a series closer than three a decade.
bool has_close_times(const CurveFit& fit)
{
  const auto* series = std::get_if<CreepCompliance>(&fit.form);
  if (!series || fit.kind != FormKind::series)
    return false;
  for (std::size_t k = 1; k < series->parts.size(); ++k)
    if (series->parts[k].time < 2.0 * series->parts[k - 1].time)
      return true;
  return false;
}

} // namespace

std::vector<FitWarning> fit_warnings(const CurveFit& fit, const Measurements& data,
                                     int n_parameters, bool instantaneous_at_bound)
{
  std::vector<FitWarning> result;
  const int n_values = int(data.points.size()) * (data.points.front().phase ? 2 : 1);
  if (n_values < n_parameters + 3)
    result.push_back({WarningKind::few_points,
                      fmt::format("{} numbers determine {} constants", n_values, n_parameters)});
  const double decades = std::log10(fit.valid_time.last / fit.valid_time.first);
  if (decades < 2)
    result.push_back(
        {WarningKind::few_decades,
         fmt::format("the data span {:.2g} decades of time; a law needs two or more", decades)});
  if (instantaneous_at_bound)
    result.push_back({WarningKind::unseen_instantaneous,
                      "the data do not show the instantaneous compliance; 1/1000 of the least "
                      "measured compliance was taken"});
  if (glassy_at_bound(fit, data))
    result.push_back({WarningKind::unseen_instantaneous,
                      fmt::format("the data do not show the glassy modulus E_0; it was kept below "
                                  "{:g} times the largest measured modulus",
                                  largest_glassy_ratio)});
  std::string uncertain;
  for (const FittedParameter& each : fit.parameters)
    if (each.unit != "log10 Pa" && !(each.standard_error < std::abs(each.value)))
      uncertain += (uncertain.empty() ? "" : ", ") + each.name;
  if (!uncertain.empty())
    result.push_back(
        {WarningKind::uncertain_parameter,
         "the data hardly determine " + uncertain + " (standard error as large as the value)"});
  if (has_close_times(fit))
    result.push_back({WarningKind::close_times,
                      "retardation times are closer than a factor of 2: the terms cannot be told "
                      "apart, use the curve and not the terms"});
  for (const std::string& gap : gaps(fit, data))
    result.push_back({WarningKind::weak_overlap, gap});
  if (fit.relative_rms > 0.1)
    result.push_back(
        {WarningKind::poor_fit,
         fmt::format("the relative error is {:.1f} % rms: another form may suit better",
                     100 * fit.relative_rms)});
  return result;
}

} // namespace fem
