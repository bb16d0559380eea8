#pragma once
#include "apps/fit_data.h"
#include "fem/creep_compliance.h"
#include "fem/curve_fit.h"

#include <string>
#include <vector>

namespace apps {

/// A fit as it is reported.
struct FitReport {
  std::string title; ///< name of the data
  FitData data;
  fem::CurveFit fit;
  fem::SeriesApproximation series; ///< what the law file holds
  double poisson_ratio;
  std::vector<fem::Interval> intervals; ///< 95 %, of the first parameters; empty if not asked for
};

/// A parameter in the units of the laboratory.
struct LabParameter {
  std::string name, unit;
  double value, standard_error;
  double low, high; ///< 95 % interval
};

/// Parameters of a report: MPa, 1/GPa, kJ/mol. Without a bootstrap the intervals are 1.96 standard
/// errors wide on both sides.
std::vector<LabParameter> lab_parameters(const FitReport& report);

/// What was fitted, how well, the parameters, what to beware of; a few lines of text.
std::string summary(const FitReport& report);

/// One row per parameter.
std::string parameters_csv(const FitReport& report);

/// One row per measured point: measured, fitted, error, weight.
std::string residuals_csv(const FitReport& report);

/// The fitted form and the series over the range of the data, ten points a decade.
std::string curve_csv(const FitReport& report);

/// The names of forms and shifts on the command line, and their values.
fem::FormKind form_named(const std::string& name);
fem::ShiftKind shift_named(const std::string& name);
std::string name_of(fem::FormKind form);

} // namespace apps
