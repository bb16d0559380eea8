#include "coupling/extraction.h"

#include "dem/element_creep.h"
#include "dem/frequency_response.h"
#include "fem/series_fit.h"
#include "fem/tensor_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace coupling {

namespace {

/// Up to so many times are moved to where they serve best.
constexpr int most_free_times = 6;

std::vector<double> sample_times(const SamplingOptions& options)
{
  if (!(options.first_time > 0) || !(options.last_time > options.first_time) || options.n_times < 3)
    throw std::invalid_argument(fmt::format(
        "creep tests need at least 3 times from a first above 0 to a later last one, found {} from "
        "{:g} s to {:g} s",
        options.n_times, options.first_time, options.last_time));
  std::vector<double> times{0};
  for (const double time :
       fem::retardation_grid(options.first_time, options.last_time, options.n_times))
    times.push_back(time);
  return times;
}

/// The mean over all directions, as a scalar curve.
fem::Measurements traces_of(const MeanCompliance& samples)
{
  fem::Measurements traces{fem::Quantity::creep_compliance, {}};
  for (std::size_t k = 0; k < samples.time.size(); ++k)
    if (samples.time[k] > 0) {
      fem::Measurement point;
      point.at = samples.time[k];
      point.value = samples.compliance[k].trace();
      traces.points.push_back(point);
    }
  return traces;
}

} // namespace

fem::ComplianceLaw proportional_law(const fem::Mat6& elastic, const dem::CreepLaw& creep)
{
  const double stiffness = creep.maxwell_stiffness;
  fem::Mat6 fluidity = fem::Mat6::Zero();
  if (creep.maxwell_viscosity)
    fluidity = elastic * (stiffness / *creep.maxwell_viscosity);
  std::vector<fem::RetardationTerm> terms;
  for (const dem::KelvinBranch& branch : creep.branches)
    terms.push_back({dem::retardation_time(branch), elastic * (stiffness / branch.stiffness)});
  return fem::make_compliance_law(elastic, fluidity, terms);
}

MeanCompliance sampled_compliance(const dem::VolumeElement& element, const SamplingOptions& options)
{
  const dem::ElementModel model = dem::make_element_model(element);
  const std::vector<double> times = sample_times(options);
  const dem::CreepHistory history = dem::creep_compliance(model, times, options.tolerance);
  MeanCompliance result{history.time, history.compliance, 0};
  for (const double error : history.error)
    result.stepping_error = std::max(result.stepping_error, error);
  return result;
}

MeanCompliance mean_of(std::span<const MeanCompliance> samples)
{
  MeanCompliance mean = samples.front();
  for (std::size_t k = 1; k < samples.size(); ++k) {
    for (std::size_t i = 0; i < mean.compliance.size(); ++i)
      mean.compliance[i] += samples[k].compliance[i];
    mean.stepping_error = std::max(mean.stepping_error, samples[k].stepping_error);
  }
  for (fem::Mat6& each : mean.compliance)
    each /= double(samples.size());
  return mean;
}

std::vector<fem::ComplexMat6> complex_compliances(const dem::VolumeElement& element,
                                                  std::span<const double> omega)
{
  std::vector<fem::ComplexMat6> result;
  for (const dem::ComplexMat6& stiffness : dem::frequency_response(element, omega).stiffness)
    result.push_back(dem::complex_compliance(stiffness));
  return result;
}

double frequency_difference(const fem::ComplianceLaw& law, std::span<const double> omega,
                            std::span<const fem::ComplexMat6> compliances)
{
  double largest = 0;
  for (std::size_t k = 0; k < omega.size(); ++k)
    largest = std::max(largest, (fem::complex_compliance(law, omega[k]) - compliances[k]).norm() /
                                    compliances[k].norm());
  return largest;
}

ExtractedLaw fitted_law(const MeanCompliance& samples, const SamplingOptions& options)
{
  std::vector<fem::ComplianceSample> points;
  for (std::size_t k = 0; k < samples.time.size(); ++k)
    points.push_back(
        {samples.time[k], 0.5 * (samples.compliance[k] + samples.compliance[k].transpose())});
  const auto fitted = [&](const std::vector<double>& times) {
    return fem::fit_compliance_law(points, times);
  };
  const fem::Measurements traces = traces_of(samples);
  const auto better_of_two = [&](int n) {
    const std::vector<double> grid =
        fem::retardation_grid(options.first_time, options.last_time, n);
    const std::vector<double> moved =
        n <= most_free_times ? fem::best_times(traces, n) : fem::moved_times(traces, grid);
    fem::TensorFit on_grid = fitted(grid);
    if (moved.empty())
      return on_grid;
    fem::TensorFit off_grid = fitted(moved);
    return off_grid.relative_rms < on_grid.relative_rms ? off_grid : on_grid;
  };
  fem::TensorFit fit;
  if (options.n_terms > 0)
    fit = fitted(fem::retardation_grid(options.first_time, options.last_time, options.n_terms));
  else {
    const double decades = std::log10(options.last_time / options.first_time);
    const int most = std::max(1, std::min(int(3 * decades) + 1, options.n_times / 2));
    int n = std::min(most, std::max(1, int(decades / 2)));
    fit = better_of_two(n);
    while (fit.relative_rms > sufficient_error && n < most) {
      n = std::min(most, n + std::max(1, n / 3));
      const fem::TensorFit next = better_of_two(n);
      if (next.relative_rms < fit.relative_rms)
        fit = next;
    }
  }
  return {fit.law,
          false,
          fit.relative_rms,
          fit.largest_relative_error,
          fit.optimality_gap,
          samples.stepping_error,
          options.first_time,
          options.last_time};
}

} // namespace coupling
