#include "fem/form_parameters.h"

#include "fem/series_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace fem {

namespace {

using Eigen::VectorXd;
using std::numbers::pi;

constexpr double largest_log_beta = 23; // beta up to 1e10: no flow that data show

double logistic(double x)
{
  return 1 / (1 + std::exp(-x));
}

double logit(double p)
{
  return std::log(p / (1 - p));
}

VectorXd vector(std::initializer_list<double> values)
{
  return Eigen::Map<const VectorXd>(values.begin(), Eigen::Index(values.size()));
}

/// Ends of the data: moduli and times where the material is stiffest and softest.
struct Ends {
  double stiff, soft; ///< [Pa]
  double first, last; ///< [s]
};

Ends ends_of(const Measurements& data)
{
  Ends ends{0, 0, 0, 0};
  const auto time_of = [&](const Measurement& point) {
    return data.quantity == Quantity::dynamic_modulus ? 1 / (2 * pi * point.at) : point.at;
  };
  const auto modulus_of = [&](const Measurement& point) {
    return data.quantity == Quantity::creep_compliance ? 1 / point.value : point.value;
  };
  const auto [low, high] = std::ranges::minmax(data.points, {}, time_of);
  ends.first = time_of(low);
  ends.last = time_of(high);
  ends.stiff = modulus_of(low);
  ends.soft = std::min(modulus_of(high), 0.99 * ends.stiff);
  return ends;
}

FormParameters burgers_parameters(const Ends& ends)
{
  FormParameters result{{"E_m", "eta_m", "E_k", "eta_k"}, {"Pa", "Pa s", "Pa", "Pa s"}, {}, {}, {}};
  const double decades = std::log(ends.last / ends.first);
  for (const double part : {0.2, 0.5, 0.8})
    for (const double flow : {1.5, 20.0}) {
      const double spring = std::sqrt(ends.stiff * ends.soft);
      result.starts.push_back(
          vector({std::log(1.2 * ends.stiff), std::log(flow * ends.soft * ends.last),
                  std::log(spring), std::log(spring * ends.first) + part * decades}));
    }
  result.form = [](const VectorXd& x) -> Form {
    return burgers_compliance(std::exp(x[0]), std::exp(x[1]), std::exp(x[2]), std::exp(x[3]));
  };
  result.constants = [](const Form& form) {
    const auto& law = std::get<CreepCompliance>(form);
    const auto& [time, part] = law.parts.front();
    return vector({1 / law.instantaneous, 1 / law.fluidity, 1 / part, time / part});
  };
  return result;
}

FormParameters power_parameters(const Ends& ends)
{
  FormParameters result{{"D_0", "D_1", "m"}, {"1/Pa", "1/(Pa s^m)", "1"}, {}, {}, {}};
  for (const double part : {0.2, 0.8})
    for (const double exponent : {0.2, 0.5})
      result.starts.push_back(
          vector({std::log(part / ends.stiff),
                  std::log((1 / ends.soft - part / ends.stiff) / std::pow(ends.last, exponent)),
                  logit(exponent)}));
  result.form = [](const VectorXd& x) -> Form {
    return PowerLaw{std::exp(x[0]), std::exp(x[1]), logistic(x[2])};
  };
  result.constants = [](const Form& form) {
    const auto& law = std::get<PowerLaw>(form);
    return vector({law.instantaneous, law.coefficient, law.exponent});
  };
  return result;
}

FormParameters sigmoid_parameters(const Ends& ends)
{
  FormParameters result{
      {"delta", "alpha", "beta", "gamma"}, {"log10 Pa", "1", "1", "1"}, {}, {}, {}};
  const double low = std::log10(ends.soft), height = std::log10(ends.stiff / ends.soft);
  const double middle = -0.5 * std::log10(4 * pi * pi * ends.first * ends.last); // log10 of f
  for (const double margin : {0.2, 1.0})
    for (const double slope : {0.4, 0.8})
      result.starts.push_back(
          vector({low - margin, std::log(height + 1.5 * margin), slope * middle, std::log(slope)}));
  result.form = [](const VectorXd& x) -> Form {
    return SigmoidalModulus{x[0], std::exp(x[1]), x[2], -std::exp(x[3])};
  };
  result.constants = [](const Form& form) {
    const auto& law = std::get<SigmoidalModulus>(form);
    return vector({law.delta, law.alpha, law.beta, law.gamma});
  };
  return result;
}

FormParameters two_springs_parameters(const Ends& ends)
{
  FormParameters result{{"E_00", "E_0", "delta", "k", "h", "tau", "beta"},
                        {"Pa", "Pa", "1", "1", "1", "s", "1"},
                        {},
                        {},
                        {}};
  for (const double low : {0.1, 0.7})
    for (const double high : {1.5, 3.5})
      for (const double time : {1.0, 0.01})
        result.starts.push_back(
            vector({std::log(low * ends.soft), logit(high / largest_glassy_ratio), std::log(2.0),
                    logit(0.2), logit(0.45), std::log(10 * time * ends.first),
                    logit(std::log(1e4) / largest_log_beta)}));
  const double bound = largest_glassy_ratio * ends.stiff;
  result.form = [bound](const VectorXd& x) -> Form {
    const double low = std::exp(x[0]), k = logistic(x[3]);
    return TwoSpringsTwoParabolasDashpot{low,
                                         low + bound * logistic(x[1]),
                                         std::exp(x[2]),
                                         k,
                                         k + (1 - k) * logistic(x[4]),
                                         std::exp(x[5]),
                                         std::exp(largest_log_beta * logistic(x[6]))};
  };
  result.constants = [](const Form& form) {
    const auto& law = std::get<TwoSpringsTwoParabolasDashpot>(form);
    return vector(
        {law.static_modulus, law.glassy_modulus, law.delta, law.k, law.h, law.time, law.beta});
  };
  return result;
}

Prediction polar(std::complex<double> modulus)
{
  return {std::abs(modulus), std::arg(modulus)};
}

[[noreturn]] void unsupported(const char* form, const char* what)
{
  throw std::invalid_argument(std::string("fit: the ") + form + " has no closed form of " + what);
}

std::vector<Prediction> predicted(const CreepCompliance& law, Quantity quantity,
                                  const std::vector<double>& at)
{
  std::vector<Prediction> result;
  const RelaxationModulus relaxation =
      quantity == Quantity::relaxation_modulus ? relaxation_modulus(law) : RelaxationModulus{};
  for (const double each : at)
    result.push_back(quantity == Quantity::creep_compliance ? Prediction{value(law, each), 0}
                     : quantity == Quantity::relaxation_modulus
                         ? Prediction{value(relaxation, each), 0}
                         : polar(complex_modulus(law, 2 * pi * each)));
  return result;
}

std::vector<Prediction> predicted(const PowerLaw& law, Quantity quantity,
                                  const std::vector<double>& at)
{
  if (quantity == Quantity::relaxation_modulus)
    unsupported("power law", "the relaxation modulus; use the series");
  std::vector<Prediction> result;
  for (const double each : at)
    result.push_back(quantity == Quantity::creep_compliance
                         ? Prediction{value(law, each), 0}
                         : polar(complex_modulus(law, 2 * pi * each)));
  return result;
}

std::vector<Prediction> predicted(const auto& law, Quantity quantity, const std::vector<double>& at)
{
  if (quantity != Quantity::dynamic_modulus)
    unsupported("sigmoid or 2S2P1D", "creep or relaxation; it needs the dynamic modulus over "
                                     "frequency");
  std::vector<Prediction> result;
  for (const double each : at)
    result.push_back(polar(complex_modulus(law, 2 * pi * each)));
  return result;
}

} // namespace

std::vector<Prediction> predictions(const Form& form, Quantity quantity,
                                    const std::vector<double>& at)
{
  return std::visit([&](const auto& law) { return predicted(law, quantity, at); }, form);
}

FormParameters form_parameters(FormKind kind, const Measurements& reduced)
{
  const Ends ends = ends_of(reduced);
  switch (kind) {
  case FormKind::burgers:
    return burgers_parameters(ends);
  case FormKind::power:
    return power_parameters(ends);
  case FormKind::sigmoid:
    return sigmoid_parameters(ends);
  case FormKind::two_springs:
    return two_springs_parameters(ends);
  case FormKind::series:
    break;
  }
  throw std::invalid_argument("fit: the series has no fixed set of parameters");
}

} // namespace fem
