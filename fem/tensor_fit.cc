#include "fem/tensor_fit.h"

#include "fem/cone_quadratic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fem {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// One equation sum_j basis_j X_j = compliance with the weight of its squared error [Pa^2].
struct Row {
  VectorXd basis; ///< of S_0, S_v (if any), S_1, S_2, ...
  Mat6 compliance;
  double weight;
};

void require(bool condition, const std::string& what)
{
  if (!condition)
    throw std::invalid_argument("fit of a compliance law: " + what);
}

void require_sample(double at, const Mat6& compliance, double weight)
{
  require(std::isfinite(at) && compliance.allFinite() && std::isfinite(weight) && weight >= 0,
          "a sample has an entry that is not a finite number, or a negative weight");
  require((compliance - compliance.transpose()).norm() <= 1e-8 * compliance.norm(),
          fmt::format("the sample at {:g} is not symmetric", at));
}

/// \param whole  half the sum of the weights of the samples
TensorFit fitted(const std::vector<Row>& rows, std::span<const double> times,
                 const TensorFitOptions& options, double whole)
{
  const Index n = rows.front().basis.size();
  MatrixXd gram = MatrixXd::Zero(n, n);
  for (const Row& row : rows)
    gram += row.weight * row.basis * row.basis.transpose();
  const VectorXd scale = gram.diagonal().cwiseSqrt(); // unknowns become numbers without unit
  require(scale.minCoeff() > 0, "a term does not show in any sample");
  gram = scale.cwiseInverse().asDiagonal() * gram * scale.cwiseInverse().asDiagonal();
  std::vector<Mat6> linear(std::size_t(n), Mat6::Zero());
  for (const Row& row : rows)
    for (Index j = 0; j < n; ++j)
      linear[std::size_t(j)] += row.weight * row.basis[j] / scale[j] * 0.5 *
                                (row.compliance + row.compliance.transpose());
  ConeMinimum minimum =
      minimize_over_cone(gram, linear, options.gap * whole, options.max_iterations);
  for (Index j = 0; j < n; ++j)
    minimum.solution[std::size_t(j)] /= scale[j];

  std::vector<RetardationTerm> terms;
  const std::size_t first = options.flow ? 2 : 1;
  for (std::size_t k = 0; k < times.size(); ++k)
    if (minimum.solution[first + k].norm() > 0)
      terms.push_back({times[k], minimum.solution[first + k]});
  const Mat6 fluidity = options.flow ? minimum.solution[1] : Mat6(Mat6::Zero());
  return {make_compliance_law(minimum.solution[0], fluidity, terms), 0, 0, minimum.gap / whole,
          minimum.iterations};
}

VectorXd basis(std::span<const double> times, bool flow, double at_once, double flowing,
               const auto& retarded)
{
  std::vector<double> values{at_once};
  if (flow)
    values.push_back(flowing);
  for (const double time : times)
    values.push_back(retarded(time));
  return Eigen::Map<VectorXd>(values.data(), Index(values.size()));
}

/// Fills in the errors of a fit from the relative error of each sample.
TensorFit with_errors(TensorFit fit, const auto& samples, const auto& relative_error)
{
  double sum = 0, weights = 0;
  for (const auto& sample : samples) {
    const double error = relative_error(fit.law, sample);
    sum += sample.weight * error * error;
    weights += sample.weight;
    fit.largest_relative_error = std::max(fit.largest_relative_error, error);
  }
  fit.relative_rms = std::sqrt(sum / weights);
  return fit;
}

double total_weight(const auto& samples)
{
  double sum = 0;
  for (const auto& sample : samples)
    sum += sample.weight;
  require(sum > 0, "there are no samples");
  return sum;
}

} // namespace

TensorFit fit_compliance_law(std::span<const ComplianceSample> samples,
                             std::span<const double> retardation_times,
                             const TensorFitOptions& options)
{
  std::vector<Row> rows;
  for (const auto& [time, compliance, weight] : samples) {
    require_sample(time, compliance, weight);
    require(time >= 0 && compliance.norm() > 0, "a sample needs a time >= 0 and a compliance");
    const auto retarded = [t = time](double tau) { return -std::expm1(-t / tau); };
    rows.push_back({basis(retardation_times, options.flow, 1, time, retarded), compliance,
                    weight / compliance.squaredNorm()});
  }
  return with_errors(fitted(rows, retardation_times, options, 0.5 * total_weight(samples)), samples,
                     [](const ComplianceLaw& law, const ComplianceSample& sample) {
                       return (compliance(law, sample.time) - sample.compliance).norm() /
                              sample.compliance.norm();
                     });
}

TensorFit fit_compliance_law(std::span<const ComplexComplianceSample> samples,
                             std::span<const double> retardation_times,
                             const TensorFitOptions& options)
{
  std::vector<Row> rows;
  for (const auto& [omega, compliance, weight] : samples) {
    const Mat6 storage = compliance.real(), loss = -compliance.imag();
    require_sample(omega, storage, weight);
    require_sample(omega, loss, weight);
    require(omega > 0 && compliance.norm() > 0, "a sample needs a frequency > 0 and a compliance");
    const double relative = weight / compliance.squaredNorm();
    const auto stored = [w = omega](double tau) { return 1 / (1 + w * tau * w * tau); };
    const auto lost = [w = omega](double tau) { return w * tau / (1 + w * tau * w * tau); };
    rows.push_back({basis(retardation_times, options.flow, 1, 0, stored), storage, relative});
    rows.push_back({basis(retardation_times, options.flow, 0, 1 / omega, lost), loss, relative});
  }
  return with_errors(fitted(rows, retardation_times, options, 0.5 * total_weight(samples)), samples,
                     [](const ComplianceLaw& law, const ComplexComplianceSample& sample) {
                       return (complex_compliance(law, sample.omega) - sample.compliance).norm() /
                              sample.compliance.norm();
                     });
}

} // namespace fem
