#include "fem/curve_fit.h"

#include "tests/fem/sma.h"
#include "tests/fem/tables.h"

#include <numbers>

using namespace fem;
using std::numbers::pi;

namespace {

std::vector<double> times(double first, double last, int n)
{
  return retardation_grid(first, last, n);
}

/// Points of a form, with relative noise.
Measurements points_of(const Form& form, Quantity quantity, const std::vector<double>& at,
                       double noise = 0, double temperature = 293.15, double shift = 1)
{
  std::mt19937_64 random(17);
  const auto draw = [&] { // sum of twelve: nearly normal
    double sum = -6;
    for (int k = 0; k < 12; ++k)
      sum += double(random() % 1000001) / 1e6;
    return sum;
  };
  std::vector<double> reduced;
  for (const double each : at)
    reduced.push_back(quantity == Quantity::dynamic_modulus ? each * shift : each / shift);
  const std::vector<Prediction> exact = predictions(form, quantity, reduced);
  Measurements data{quantity, {}};
  for (std::size_t i = 0; i < at.size(); ++i) {
    data.points.push_back({at[i], exact[i].value * (1 + noise * draw()), {}, temperature});
    if (quantity == Quantity::dynamic_modulus)
      data.points.back().phase = exact[i].phase;
  }
  return data;
}

double parameter(const CurveFit& fit, const std::string& name)
{
  for (const FittedParameter& each : fit.parameters)
    if (each.name == name)
      return each.value;
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

bool warns(const CurveFit& fit, WarningKind kind)
{
  return std::ranges::any_of(fit.warnings, [&](const auto& each) { return each.kind == kind; });
}

std::string refusal(const Measurements& data, const CurveFitOptions& options = {})
{
  try {
    fit_curve(data, options);
  } catch (const std::invalid_argument& problem) {
    return problem.what();
  }
  return "accepted";
}

const PowerLaw power{1e-10, 4e-10, 0.35};
const TwoSpringsTwoParabolasDashpot two_springs{5.4e7, 3.02e10, 1.52, 0.139, 0.424, 2e-4, 1.5e5};

} // namespace

TEST(CurveFit, FormsComeBackFromTheirOwnPoints)
{
  const Form burgers = burgers_compliance(1.5e9, 2e11, 4e8, 1.2e9);
  for (const Quantity quantity :
       {Quantity::creep_compliance, Quantity::relaxation_modulus, Quantity::dynamic_modulus}) {
    const CurveFit fit =
        fit_curve(points_of(burgers, quantity, times(1e-2, 1e3, 31)), {.form = FormKind::burgers});
    EXPECT_LE(fit.largest_relative_error, 1e-6) << int(quantity);
    EXPECT_NEAR(parameter(fit, "E_m") / 1.5e9, 1, 1e-5);
    EXPECT_NEAR(parameter(fit, "eta_k") / 1.2e9, 1, 1e-5);
  }
  for (const Quantity quantity : {Quantity::creep_compliance, Quantity::dynamic_modulus}) {
    const CurveFit fit = fit_curve(points_of(Form(power), quantity, times(1e-1, 1e3, 31)),
                                   {.form = FormKind::power});
    EXPECT_NEAR(parameter(fit, "m") / 0.35, 1, 1e-5) << int(quantity);
  }
  const SigmoidalModulus sigmoid{7.5, 3.0, -0.4, -0.5};
  const CurveFit fit =
      fit_curve(points_of(Form(sigmoid), Quantity::dynamic_modulus, times(1e-5, 1e4, 31)),
                {.form = FormKind::sigmoid});
  EXPECT_NEAR(parameter(fit, "delta"), 7.5, 1e-4);
  EXPECT_NEAR(parameter(fit, "gamma"), -0.5, 1e-4);
  const CurveFit found =
      fit_curve(points_of(Form(two_springs), Quantity::dynamic_modulus, times(1e-6, 1e5, 41)),
                {.form = FormKind::two_springs});
  EXPECT_LE(found.largest_relative_error, 1e-4);
  EXPECT_NEAR(parameter(found, "k") / 0.139, 1, 1e-2);
  EXPECT_NEAR(parameter(found, "E_0") / 3.02e10, 1, 1e-2);
}

TEST(CurveFit, SeriesFollowsNoisyCreepWithinItsNoise)
{
  const auto rows = reference::table("creep_fit_data.csv");
  for (const auto& [column, noise] : std::map<std::string, double>{
           {"J_noise_0.1pct", 1e-3}, {"J_noise_1pct", 1e-2}, {"J_noise_5pct", 5e-2}}) {
    Measurements data;
    for (const auto& row : rows)
      data.points.push_back({reference::number(row, "t"), reference::number(row, column), {}});
    const CurveFit fit = fit_curve(data, {});
    const auto& law = std::get<CreepCompliance>(fit.form);
    EXPECT_LE(law.parts.size(), 4U) << column;
    for (const auto& row : rows) {
      const double exact = reference::number(row, "J_noise_0");
      EXPECT_LE(std::abs(value(law, reference::number(row, "t")) / exact - 1), 2 * noise)
          << column << " " << row.at("t");
    }
  }
}

TEST(CurveFit, SeriesTakesModuliInExactlyTheSameLaw)
{
  const Form series = CreepCompliance{1e-10, 1e-13, {{0.1, 2e-10}, {10, 5e-10}}};
  for (const Quantity quantity : {Quantity::relaxation_modulus, Quantity::dynamic_modulus}) {
    const CurveFit fit = fit_curve(points_of(series, quantity, times(1e-3, 1e3, 41)), {});
    EXPECT_LE(fit.relative_rms, 0.01) << int(quantity);
    EXPECT_NEAR(value(std::get<CreepCompliance>(fit.form), 1.0) /
                    value(std::get<CreepCompliance>(series), 1.0),
                1, 0.02);
  }
  Measurements magnitudes = points_of(series, Quantity::dynamic_modulus, times(1e-3, 1e3, 41));
  for (Measurement& point : magnitudes.points)
    point.phase.reset();
  const CurveFit fit = fit_curve(magnitudes, {});
  EXPECT_LE(fit.relative_rms, 0.01);
  EXPECT_FALSE(fit.phase_rms.has_value());
}

TEST(CurveFit, StandardErrorsAreThoseOfRepeatedTests)
{
  // Power law with 1 % noise: the exponent of the fit scatters as the report says.
  const Measurements exact = points_of(Form(power), Quantity::creep_compliance, times(1, 1e3, 40));
  std::mt19937_64 random(3);
  double sum = 0, squares = 0, reported = 0;
  const int n = 60;
  for (int repeat = 0; repeat < n; ++repeat) {
    Measurements data = exact;
    for (Measurement& point : data.points)
      point.value *= 1 + 0.01 * std::sqrt(3.0) * (double(random() % 2000001) / 1e6 - 1);
    const CurveFit fit = fit_curve(data, {.form = FormKind::power});
    sum += parameter(fit, "m");
    squares += std::pow(parameter(fit, "m"), 2);
    reported += fit.parameters[2].standard_error / n;
  }
  const double scatter = std::sqrt(squares / n - std::pow(sum / n, 2));
  EXPECT_NEAR(scatter / reported, 1, 0.35);
}

TEST(CurveFit, ShiftsComeBack)
{
  const WlfShift wlf{12, 120, 293.15};
  Measurements data{Quantity::dynamic_modulus, {}};
  for (const double celsius : {-10.0, 5.0, 20.0, 40.0}) {
    const double temperature = celsius + 273.15;
    const Measurements more =
        points_of(Form(two_springs), Quantity::dynamic_modulus, times(0.01, 25, 12), 0, temperature,
                  shift_factor(wlf, temperature));
    data.points.insert(data.points.end(), more.points.begin(), more.points.end());
  }
  for (const FormKind form : {FormKind::series, FormKind::two_springs}) {
    const CurveFit fit = fit_curve(data, {.form = form, .shift = ShiftKind::wlf});
    EXPECT_EQ(fit.reference_temperature, 293.15);
    for (const double temperature : {263.15, 313.15})
      EXPECT_NEAR(std::log10(shift_factor(fit.shift, temperature)),
                  std::log10(shift_factor(wlf, temperature)), 0.03)
          << int(form);
  }
  const CurveFit fit = fit_curve(data, {.shift = ShiftKind::free});
  EXPECT_NEAR(parameter(fit, "log10 a_T(40 degC)"), std::log10(shift_factor(wlf, 313.15)), 0.03);
  EXPECT_TRUE(outside_range(fit, 1e9, 293.15).has_value());
  EXPECT_TRUE(outside_range(fit, 1.0, 353.15).has_value());
  EXPECT_FALSE(outside_range(fit, 1.0, 300).has_value());
}

TEST(CurveFit, OneWildPointHardlyMovesARobustFit)
{
  Measurements data = points_of(Form(power), Quantity::creep_compliance, times(1, 1e3, 30), 0.005);
  data.points[25].value *= 3;
  const CurveFit plain = fit_curve(data, {.form = FormKind::power});
  const CurveFit robust = fit_curve(data, {.form = FormKind::power, .robust = true});
  EXPECT_LE(std::abs(parameter(robust, "m") - 0.35), 0.02);
  EXPECT_GE(std::abs(parameter(plain, "m") - 0.35), 2 * std::abs(parameter(robust, "m") - 0.35));
  EXPECT_LT(robust.points[25].weight, 0.1);
}

TEST(CurveFit, MeasuredAsphaltIsReproducedWithinSevenPercent)
{
  const Measurements data = sma::mean_dynamic_modulus();
  const CurveFit fit = fit_curve(data, {.shift = ShiftKind::free});
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    EXPECT_LE(std::abs(fit.points[i].relative_error), 0.07) << i;
    EXPECT_LE(std::abs(fit.points[i].phase - *data.points[i].phase), 5 * pi / 180) << i;
  }
  EXPECT_NEAR(parameter(fit, "log10 a_T(4 degC)"), 1.92, 0.15);
  EXPECT_NEAR(parameter(fit, "log10 a_T(45 degC)"), -2.49, 0.2);
  EXPECT_NEAR(value(std::get<CreepCompliance>(fit.form), 10) / 3.454e-9, 1, 0.06);
  EXPECT_NEAR(value(std::get<CreepCompliance>(fit.form), 1) / 1.467e-9, 1, 0.06);
}

TEST(CurveFit, FormsBecomeSeries)
{
  for (const FormKind form : {FormKind::sigmoid, FormKind::two_springs}) {
    const CurveFit fit =
        fit_curve(sma::dynamic_modulus(), {.form = form, .shift = ShiftKind::free});
    const SeriesApproximation series = creep_series(fit);
    EXPECT_LE(series.relative_rms, 0.02) << int(form);
    EXPECT_NO_THROW(isotropic_law(series.law, 0.35));
  }
}

TEST(CurveFit, BootstrapCoversAndRepeats)
{
  const Form series = CreepCompliance{1e-10, 1e-13, {{1, 2e-10}, {100, 5e-10}}};
  const Measurements data =
      points_of(series, Quantity::creep_compliance, times(1e-1, 1e4, 61), 0.01);
  const std::vector<double> grid{1, 100};
  const auto found = bootstrap_intervals(data, grid, 200, 5);
  const auto again = bootstrap_intervals(data, grid, 200, 5);
  const std::vector<double> exact{1e-10, 1e-13, 2e-10, 5e-10};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LE(found[k].low, exact[k] * 1.02);
    EXPECT_GE(found[k].high, exact[k] * 0.98);
    EXPECT_LT(found[k].high / found[k].low, 1.2);
    EXPECT_EQ(found[k].low, again[k].low);
  }
}

TEST(CurveFit, WarnsOfWhatTheDataDoNotShow)
{
  const CurveFit narrow =
      fit_curve(points_of(Form(power), Quantity::creep_compliance, times(10, 100, 20)), {});
  EXPECT_TRUE(warns(narrow, WarningKind::few_decades));
  const CurveFit few =
      fit_curve(points_of(Form(power), Quantity::creep_compliance, times(1, 1e3, 4)),
                {.form = FormKind::burgers});
  EXPECT_TRUE(warns(few, WarningKind::few_points));
  const CurveFit close = fit_curve(
      points_of(Form(power), Quantity::creep_compliance, times(1, 1e3, 60)), {.n_terms = 19});
  EXPECT_TRUE(warns(close, WarningKind::close_times) ||
              warns(close, WarningKind::uncertain_parameter) ||
              std::get<CreepCompliance>(close.form).parts.size() < 19);
}

TEST(CurveFit, RefusesBadDataInOneSentence)
{
  Measurements data = points_of(Form(power), Quantity::creep_compliance, times(1, 1e3, 5));
  EXPECT_EQ(refusal({data.quantity, {data.points[0], data.points[1]}}),
            "fit: three points or more are needed, found 2");
  Measurements bad = data;
  bad.points[1].value = -1;
  EXPECT_NE(refusal(bad).find("> 0"), std::string::npos);
  bad = data;
  bad.points[2].temperature = 300;
  EXPECT_EQ(refusal(bad), "fit: the data have 2 temperatures: choose a shift");
  EXPECT_NE(refusal(bad, {.shift = ShiftKind::wlf}).find("three temperatures"), std::string::npos);
  EXPECT_NE(refusal(bad, {.shift = ShiftKind::free, .reference_temperature = 310.0})
                .find("310 K is none"),
            std::string::npos);
  EXPECT_NE(refusal(data, {.form = FormKind::sigmoid}).find("dynamic modulus"), std::string::npos);
  data.quantity = Quantity::relaxation_modulus;
  EXPECT_NE(refusal(data, {.form = FormKind::power}).find("use the series"), std::string::npos);
}
