#include "apps/fit.h"

#include "apps/files.h"
#include "apps/fit_report.h"
#include "apps/interrupt.h"
#include "apps/plot.h"
#include "apps/quantity.h"
#include "apps/run.h"
#include "apps/text.h"
#include "fem/law_file.h"

#include <fmt/format.h>

#include <stdexcept>

namespace apps {

namespace {

constexpr int most_terms = 60;

fem::CurveFitOptions curve_options(const FitOptions& options)
{
  fem::CurveFitOptions result;
  result.form = form_named(options.form);
  result.n_terms = count_or_auto("--terms", options.terms, most_terms);
  if (result.n_terms > 0 && result.form != fem::FormKind::series)
    throw std::invalid_argument("--terms is an option of the form series");
  if (options.bootstrap > 0 && result.form != fem::FormKind::series)
    throw std::invalid_argument("--bootstrap is an option of the form series");
  result.robust = options.robust;
  result.shift = shift_named(options.shift);
  if (!options.reference.empty())
    result.reference_temperature = Units().parse(options.reference, "K", "degC");
  return result;
}

/// The fit; what is wrong with data or options is said with the name of the file.
fem::CurveFit fitted(const std::filesystem::path& file, const FitData& data,
                     const fem::CurveFitOptions& options)
{
  try {
    return fem::fit_curve(data.measurements, options);
  } catch (const std::invalid_argument& problem) {
    throw std::invalid_argument(fmt::format("{}: {}", file.string(), problem.what()));
  }
}

/// Bootstrap intervals of the coefficients off their bound, which are the first parameters.
std::vector<fem::Interval> intervals(const FitReport& report, const FitOptions& options)
{
  fem::Measurements data = fem::reduced(report.data.measurements, report.fit.shift);
  for (std::size_t i = 0; i < data.points.size(); ++i)
    data.points[i].weight = report.fit.points[i].weight;
  const auto all =
      fem::bootstrap_intervals(data, report.fit.times, options.bootstrap, options.seed);
  const auto found = fem::solve_series(data, report.fit.times).coefficients;
  std::vector<fem::Interval> result;
  for (std::size_t k = 0; k < found.size(); ++k)
    if (found[k].value > 0)
      result.push_back(all[k]);
  return result;
}

fem::LawRecord law_record(const FitReport& report, const std::string& source)
{
  fem::LawRecord record;
  record.law = fem::isotropic_law(report.series.law, report.poisson_ratio);
  record.reference_temperature = report.fit.reference_temperature;
  record.shift = report.fit.shift;
  record.first_time = report.fit.valid_time.first;
  record.last_time = report.fit.valid_time.last;
  if (report.data.has_temperature)
    record.temperatures = {report.fit.lowest_temperature, report.fit.highest_temperature};
  record.relative_error = std::hypot(report.fit.relative_rms, report.series.relative_rms);
  record.provenance = {
      "mastic " MASTIC_VERSION " (" MASTIC_REVISION "), verb fit", "data: " + source,
      "form: " + name_of(report.fit.kind),
      fmt::format("isotropic, Poisson's ratio {} (taken, not measured)", report.poisson_ratio)};
  return record;
}

} // namespace

int fit_verb(const std::filesystem::path& file, const FitOptions& options)
{
  if (!(options.poisson_ratio > -1 && options.poisson_ratio < 0.5))
    throw std::invalid_argument(fmt::format("--poisson: must be above -1 and below 0.5, found {:g}",
                                            options.poisson_ratio));
  if (!std::filesystem::exists(file))
    throw std::invalid_argument(fmt::format("{}: there is no such file", file.string()));
  const fem::CurveFitOptions curve = curve_options(options);
  const std::string name = file.stem().string();
  const std::filesystem::path folder =
      options.output.empty() ? std::filesystem::path("results") / (name + "-fit") : options.output;
  require_writable(folder);
  FitReport report{name, read_fit_data(file), {}, {}, options.poisson_ratio, {}};
  report.fit = fitted(file, report.data, curve);
  report.series = fem::creep_series(report.fit);
  if (options.bootstrap > 0)
    report.intervals = intervals(report, options);

  make_folder(folder);
  const std::string text = summary(report);
  write_text_file(folder / (name + ".law"), fem::law_text(law_record(report, file.string())));
  write_text_file(folder / "report.txt", text);
  write_text_file(folder / "parameters.csv", parameters_csv(report));
  write_text_file(folder / "residuals.csv", residuals_csv(report));
  write_text_file(folder / "curve.csv", curve_csv(report));
  fmt::print("{}\nlaw: {}\n", text, (folder / (name + ".law")).string());
  if (options.plots)
    for (const std::string& figure : make_fit_figures(folder))
      fmt::print("figure: {}\n", figure);
  return exit_ok;
}

} // namespace apps
