#include "fem/rheological_forms.h"

#include "fem/series_fit.h"

#include <cmath>
#include <numbers>

namespace fem {

namespace {

using std::numbers::pi;

/// Ten points a decade.
std::vector<double> points(double first, double last)
{
  return retardation_grid(first, last, 1 + int(std::ceil(10 * std::log10(last / first))));
}

SeriesApproximation approximation(const Measurements& curve, double first, double last)
{
  const bool creep = curve.quantity == Quantity::creep_compliance;
  const double low = creep ? first : first / 10, high = creep ? last : last * 10;
  const int n = 1 + int(std::ceil(2 * std::log10(high / low)));
  const SeriesSolution found = solve_series(curve, retardation_grid(low, high, n));
  return {found.creep, relative_rms(found.residuals, curve.points)};
}

SeriesApproximation by_frequency(const auto& form, double first, double last, bool with_phase)
{
  Measurements curve{Quantity::dynamic_modulus, {}};
  for (const double t : points(first, last)) {
    const std::complex<double> modulus = complex_modulus(form, 1 / t);
    curve.points.push_back({1 / (2 * pi * t), std::abs(modulus), {}});
    if (with_phase)
      curve.points.back().phase = std::arg(modulus);
  }
  return approximation(curve, first, last);
}

} // namespace

double value(const PowerLaw& law, double t)
{
  return law.instantaneous + law.coefficient * std::pow(t, law.exponent);
}

std::complex<double> complex_modulus(const PowerLaw& law, double omega)
{
  const double m = law.exponent;
  return 1.0 / (law.instantaneous + law.coefficient * std::tgamma(1 + m) *
                                        std::polar(std::pow(omega, -m), -pi / 2 * m));
}

std::complex<double> complex_modulus(const SigmoidalModulus& law, double omega)
{
  const double argument = law.beta + law.gamma * std::log10(omega / (2 * pi));
  const double part = 1 / (1 + std::exp(argument));
  const double slope = -law.alpha * law.gamma * part * (1 - part); // d log|E*| / d log f
  return std::polar(std::pow(10, law.delta + law.alpha * part), pi / 2 * slope);
}

std::complex<double> complex_modulus(const TwoSpringsTwoParabolasDashpot& law, double omega)
{
  const auto power = [&](double exponent) {
    return std::polar(std::pow(omega * law.time, -exponent), -pi / 2 * exponent);
  };
  return law.static_modulus +
         (law.glassy_modulus - law.static_modulus) /
             (1.0 + law.delta * power(law.k) + power(law.h) + power(1) / law.beta);
}

SeriesApproximation creep_series(const PowerLaw& form, double first, double last)
{
  Measurements curve{Quantity::creep_compliance, {}};
  for (const double t : points(first, last))
    curve.points.push_back({t, value(form, t), {}});
  return approximation(curve, first, last);
}

SeriesApproximation creep_series(const SigmoidalModulus& form, double first, double last)
{
  return by_frequency(form, first, last, false);
}

SeriesApproximation creep_series(const TwoSpringsTwoParabolasDashpot& form, double first,
                                 double last)
{
  return by_frequency(form, first, last, true);
}

} // namespace fem
