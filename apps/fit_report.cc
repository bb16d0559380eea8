#include "apps/fit_report.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace apps {

namespace {

using std::numbers::pi;

bool over_frequency(const FitReport& report)
{
  return report.fit.quantity == fem::Quantity::dynamic_modulus;
}

/// Unit of the laboratory of a unit of a fit, and the factor to it.
std::pair<std::string, double> lab_unit(const std::string& unit)
{
  const std::map<std::string, std::pair<std::string, double>> units{
      {"Pa", {"MPa", 1e-6}},
      {"Pa s", {"MPa s", 1e-6}},
      {"1/Pa", {"1/GPa", 1e9}},
      {"1/(Pa s)", {"1/(GPa s)", 1e9}},
      {"1/(Pa s^m)", {"1/(GPa s^m)", 1e9}},
      {"J/mol", {"kJ/mol", 1e-3}}};
  const auto found = units.find(unit);
  return found == units.end() ? std::pair(unit, 1.0) : found->second;
}

/// Name of the measured column and the factor from SI to its unit.
std::pair<std::string, double> value_column(fem::Quantity quantity)
{
  if (quantity == fem::Quantity::creep_compliance)
    return {"creep compliance [1/GPa]", 1e9};
  return {quantity == fem::Quantity::relaxation_modulus ? "relaxation modulus [MPa]"
                                                        : "dynamic modulus [MPa]",
          1e-6};
}

std::string shift_text(const fem::TemperatureShift& shift)
{
  const std::string names[] = {"none", "WLF", "Arrhenius", "free"};
  return names[shift.index()];
}

std::string fitted_text(const FitReport& report)
{
  const fem::CurveFit& fit = report.fit;
  std::string text = fmt::format(
      "{}: {} points of {}", report.title, fit.points.size(),
      value_column(fit.quantity).first.substr(0, value_column(fit.quantity).first.find(" [")));
  if (report.data.has_temperature)
    text += fmt::format(", {:.4g} to {:.4g} degC", fit.lowest_temperature - 273.15,
                        fit.highest_temperature - 273.15);
  text += fmt::format("\nform {}, shift {}, reference temperature {:.4g} degC{}\n",
                      name_of(fit.kind), shift_text(fit.shift), fit.reference_temperature - 273.15,
                      report.data.has_temperature ? "" : " (assumed: the table has none)");
  text += fmt::format("error {:.2f} % rms, {:.2f} % at most", 100 * fit.relative_rms,
                      100 * fit.largest_relative_error);
  if (fit.phase_rms)
    text += fmt::format("; phase angle {:.2f} deg rms", *fit.phase_rms * 180 / pi);
  return text + fmt::format("\nreduced time {:.3g} s to {:.3g} s{}\n", fit.valid_time.first,
                            fit.valid_time.last, over_frequency(report) ? " (1/omega)" : "");
}

} // namespace

fem::FormKind form_named(const std::string& name)
{
  for (const fem::FormKind each :
       {fem::FormKind::series, fem::FormKind::burgers, fem::FormKind::power, fem::FormKind::sigmoid,
        fem::FormKind::two_springs})
    if (name_of(each) == name)
      return each;
  throw std::invalid_argument(
      fmt::format("there is no form '{}'; forms: series, burgers, power, sigmoid, 2s2p1d", name));
}

fem::ShiftKind shift_named(const std::string& name)
{
  const std::map<std::string, fem::ShiftKind> kinds{{"none", fem::ShiftKind::none},
                                                    {"wlf", fem::ShiftKind::wlf},
                                                    {"arrhenius", fem::ShiftKind::arrhenius},
                                                    {"free", fem::ShiftKind::free}};
  if (const auto found = kinds.find(name); found != kinds.end())
    return found->second;
  throw std::invalid_argument(
      fmt::format("there is no shift '{}'; shifts: none, wlf, arrhenius, free", name));
}

std::string name_of(fem::FormKind form)
{
  switch (form) {
  case fem::FormKind::series:
    return "series";
  case fem::FormKind::burgers:
    return "burgers";
  case fem::FormKind::power:
    return "power";
  case fem::FormKind::sigmoid:
    return "sigmoid";
  case fem::FormKind::two_springs:
    break;
  }
  return "2s2p1d";
}

std::vector<LabParameter> lab_parameters(const FitReport& report)
{
  std::vector<LabParameter> result;
  for (std::size_t k = 0; k < report.fit.parameters.size(); ++k) {
    const fem::FittedParameter& each = report.fit.parameters[k];
    const auto [unit, factor] = lab_unit(each.unit);
    LabParameter lab{each.name, unit, factor * each.value, factor * each.standard_error, 0, 0};
    if (unit == "log10 Pa") {
      lab.unit = "log10 MPa";
      lab.value -= 6;
    }
    lab.low = lab.value - 1.96 * lab.standard_error;
    lab.high = lab.value + 1.96 * lab.standard_error;
    if (k < report.intervals.size()) {
      lab.low = factor * report.intervals[k].low;
      lab.high = factor * report.intervals[k].high;
    }
    result.push_back(lab);
  }
  return result;
}

std::string summary(const FitReport& report)
{
  std::string text = fitted_text(report) + "\n";
  for (const LabParameter& each : lab_parameters(report))
    text += fmt::format("  {:<22} {:>12.5g} +- {:<10.2g} {}\n", each.name, each.value,
                        each.standard_error, each.unit == "1" ? "" : each.unit);
  if (report.series.relative_rms > 0)
    text += fmt::format("\nthe law file holds a series of {} times that follows the form within "
                        "{:.2g} % rms\n",
                        report.series.law.parts.size(), 100 * report.series.relative_rms);
  for (const fem::FitWarning& warning : report.fit.warnings)
    text += fmt::format("warning: {}\n", warning.text);
  return text;
}

std::string parameters_csv(const FitReport& report)
{
  std::string text = "parameter,value,standard error,low 95 %,high 95 %,unit\n";
  for (const LabParameter& each : lab_parameters(report))
    text += fmt::format("{},{},{},{},{},{}\n", each.name, each.value, each.standard_error, each.low,
                        each.high, each.unit);
  return text;
}

std::string residuals_csv(const FitReport& report)
{
  const auto [name, factor] = value_column(report.fit.quantity);
  const std::string at = over_frequency(report) ? "frequency [Hz]" : "time [s]";
  std::string text = fmt::format(
      "specimen,temperature [degC],{},reduced {},{},fitted {},error [%],phase angle [deg],fitted "
      "phase angle [deg],weight\n",
      at, at, name, name);
  for (std::size_t i = 0; i < report.fit.points.size(); ++i) {
    const fem::Measurement& measured = report.data.measurements.points[i];
    const fem::FittedPoint& fitted = report.fit.points[i];
    const std::string specimen = report.data.specimens.empty() ? "" : report.data.specimens[i];
    const std::string phase = measured.phase ? fmt::format("{}", *measured.phase * 180 / pi) : "";
    text +=
        fmt::format("{},{:.10g},{},{},{},{},{},{},{},{}\n", specimen, measured.temperature - 273.15,
                    measured.at, fitted.reduced, factor * measured.value, factor * fitted.value,
                    100 * fitted.relative_error, phase, fitted.phase * 180 / pi, fitted.weight);
  }
  return text;
}

std::string curve_csv(const FitReport& report)
{
  const auto [name, factor] = value_column(report.fit.quantity);
  const bool frequency = over_frequency(report);
  const auto [first, last] = report.fit.valid_time;
  const int n = 1 + int(std::ceil(10 * std::log10(last / first)));
  std::vector<double> at = fem::retardation_grid(first, last, std::max(n, 11));
  if (frequency)
    for (double& each : at)
      each = 1 / (2 * pi * each);
  const auto form = fem::predictions(report.fit.form, report.fit.quantity, at);
  const auto series = fem::predictions(fem::Form(report.series.law), report.fit.quantity, at);
  std::string text =
      fmt::format("# title = {}\n# form = {}\n# reference temperature [degC] = "
                  "{:.4g}\n# shift = {}\n",
                  report.title, name_of(report.fit.kind), report.fit.reference_temperature - 273.15,
                  shift_text(report.fit.shift));
  text += fmt::format("reduced {},{},phase angle [deg],series {},series phase angle [deg]\n",
                      frequency ? "frequency [Hz]" : "time [s]", name, name);
  for (std::size_t i = 0; i < at.size(); ++i)
    text += fmt::format("{},{},{},{},{}\n", at[i], factor * form[i].value, form[i].phase * 180 / pi,
                        factor * series[i].value, series[i].phase * 180 / pi);
  return text;
}

} // namespace apps
