#include "fem/tensor_fit.h"

#include "fem/creep_compliance.h"
#include "fem/least_squares.h"
#include "tests/fem/tables.h"

#include <chrono>

using namespace fem;

namespace {

std::vector<double> grid(double first, double last, int n)
{
  std::vector<double> result;
  for (int k = 0; k < n; ++k)
    result.push_back(first * std::pow(last / first, double(k) / (n - 1)));
  return result;
}

/// S(t) at 61 times over six decades, each entry disturbed (symmetrically).
std::vector<ComplianceSample> samples_of(const ComplianceLaw& law, double noise, int n = 61)
{
  std::mt19937_64 random(11);
  std::vector<ComplianceSample> samples;
  for (const double time : grid(1e-2, 1e4, n)) {
    const Mat6 exact = compliance(law, time);
    samples.push_back({time,
                       exact + noise * exact.norm() / 4 *
                                   (tables::random_matrix(random, 1.0) - 2 * Mat6::Identity()),
                       1.0});
  }
  return samples;
}

double smallest_of(const ComplianceLaw& law)
{
  double least =
      std::min(smallest_eigenvalue(law.instantaneous), smallest_eigenvalue(law.fluidity));
  for (const auto& term : law.terms)
    least = std::min(least, smallest_eigenvalue(term.compliance));
  return least;
}

} // namespace

TEST(TensorFit, FindsTheLawBehindExactSamples)
{
  const ComplianceLaw law = tables::anisotropic_law();
  const std::vector<double> times{0.5, 5.0, 50.0, 300.0, 2000.0};
  const TensorFit fit = fit_compliance_law(samples_of(law, 0), times);
  EXPECT_LE(fit.relative_rms, 1e-6);
  EXPECT_LE(fit.optimality_gap, 1e-10);
  for (const auto& term : fit.law.terms)
    if (term.time == 5.0) {
      EXPECT_LE(tables::difference(term.compliance, law.terms[0].compliance), 1e-3);
    }
  EXPECT_LE(tables::difference(fit.law.instantaneous, law.instantaneous), 1e-4);
}

TEST(TensorFit, NoisySamplesGiveAnAdmissibleLawAtTheOptimumInASecond)
{
  const ComplianceLaw law = tables::anisotropic_law();
  for (const double noise : {0.0, 0.001, 0.01, 0.05}) {
    const auto samples = samples_of(law, noise);
    const auto start = std::chrono::steady_clock::now();
    const TensorFit fit = fit_compliance_law(samples, grid(1e-2, 1e4, 13));
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    RecordProperty("seconds", std::to_string(spent.count()));
    EXPECT_LE(spent.count(), 3.0); // 1 s on a free core
    EXPECT_LE(fit.optimality_gap, 1e-9) << noise;
    EXPECT_GE(smallest_of(fit.law), -1e-14 * fit.law.instantaneous.norm()) << noise;
    EXPECT_LE(fit.relative_rms, 0.01 + 1.2 * noise); // 0.0079: times off the grid
  }
}

TEST(TensorFit, ProportionalSamplesGiveProportionalMatrices)
{
  std::mt19937_64 random(4);
  const Mat6 shape = tables::random_matrix(random, 1e-9);
  const auto table = reference::table("creep_fit_data.csv");
  std::vector<ComplianceSample> samples;
  Eigen::VectorXd values(Eigen::Index(table.size())), at(values.size());
  const std::vector<double> times = grid(0.1, 1e4, 11);
  Eigen::MatrixXd a(values.size(), 13);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double t = reference::number(table[i], "t"),
                 j = reference::number(table[i], "J_noise_1pct");
    samples.push_back({t, j * 1e6 * shape, 1.0});
    a(Eigen::Index(i), 0) = 1 / j;
    a(Eigen::Index(i), 1) = t / j;
    for (int k = 0; k < 11; ++k)
      a(Eigen::Index(i), 2 + k) = -std::expm1(-t / times[std::size_t(k)]) / j;
  }
  values.setOnes();
  const Eigen::VectorXd x = nonnegative_least_squares(a, values);
  const TensorFit fit = fit_compliance_law(samples, times);
  EXPECT_LE(tables::difference(fit.law.instantaneous, x[0] * 1e6 * shape), 1e-6);
  const Mat6 whole = compliance(fit.law, 1e4);
  for (const auto& [time, part] : fit.law.terms) {
    const double factor = part.cwiseProduct(shape).sum() / shape.squaredNorm();
    EXPECT_LE((part - factor * shape).norm(), 1e-6 * whole.norm()) << time;
  }
  EXPECT_NEAR(fit.relative_rms, (a * x - values).norm() / std::sqrt(61.0), 1e-9);
}

TEST(TensorFit, SamplesOverFrequencyWorkTheSame)
{
  const ComplianceLaw law = tables::anisotropic_law();
  std::vector<ComplexComplianceSample> samples;
  for (const double omega : grid(1e-4, 1e2, 31))
    samples.push_back({omega, complex_compliance(law, omega)});
  const std::vector<double> times{0.5, 5.0, 50.0, 300.0, 2000.0};
  const TensorFit fit = fit_compliance_law(samples, times);
  EXPECT_LE(fit.relative_rms, 1e-6);
  EXPECT_LE(tables::difference(compliance(fit.law, 30.0), compliance(law, 30.0)), 1e-5);
}

TEST(TensorFit, RefusesBadSamples)
{
  const std::vector<double> times{1.0};
  EXPECT_THROW(fit_compliance_law(std::vector<ComplianceSample>{}, times), std::invalid_argument);
  Mat6 bad = Mat6::Identity();
  bad(0, 1) = 0.5;
  EXPECT_THROW(fit_compliance_law(std::vector<ComplianceSample>{{1.0, bad}}, times),
               std::invalid_argument);
  const std::vector<double> wrong{0.0};
  EXPECT_THROW(fit_compliance_law(std::vector<ComplianceSample>{{1.0, Mat6::Identity()}}, wrong),
               std::invalid_argument);
}
