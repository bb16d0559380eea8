#include "fem/series_fit.h"

#include "fem/least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace fem {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using std::numbers::pi;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Equations A x = b of relative errors; coefficients in the order of `SeriesSolution`.
struct Equations {
  MatrixXd a;
  VectorXd b;
};

Equations creep_equations(const std::vector<Measurement>& points, std::span<const double> times)
{
  const Index n = Index(points.size());
  Equations result{MatrixXd(n, 2 + Index(times.size())), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const Measurement& point = points[std::size_t(i)];
    const double scale = std::sqrt(point.weight) / point.value;
    result.a(i, 0) = scale;
    result.a(i, 1) = scale * point.at;
    for (std::size_t k = 0; k < times.size(); ++k)
      result.a(i, 2 + Index(k)) = -scale * std::expm1(-point.at / times[k]);
    result.b[i] = std::sqrt(point.weight);
  }
  return result;
}

Equations relaxation_equations(const std::vector<Measurement>& points,
                               std::span<const double> times)
{
  const Index n = Index(points.size());
  Equations result{MatrixXd(n, 1 + Index(times.size())), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const Measurement& point = points[std::size_t(i)];
    const double scale = std::sqrt(point.weight) / point.value;
    result.a(i, 0) = scale;
    for (std::size_t k = 0; k < times.size(); ++k)
      result.a(i, 1 + Index(k)) = scale * std::exp(-point.at / times[k]);
    result.b[i] = std::sqrt(point.weight);
  }
  return result;
}

/// Rows of E_fit* / E* = 1: the real part is the error of the magnitude, the imaginary part (if
/// asked for) that of the phase.
Equations dynamic_equations(const std::vector<Measurement>& points, std::span<const double> times,
                            const std::vector<double>& phases, bool both)
{
  const Index n = Index(points.size());
  Equations result{MatrixXd(both ? 2 * n : n, 1 + Index(times.size())),
                   VectorXd::Zero(both ? 2 * n : n)};
  for (Index i = 0; i < n; ++i) {
    const Measurement& point = points[std::size_t(i)];
    const std::complex<double> scale =
        std::polar(std::sqrt(point.weight) / point.value, -phases[std::size_t(i)]);
    for (Index k = 0; k <= Index(times.size()); ++k) {
      const std::complex<double> term =
          k == 0
              ? scale
              : scale /
                    std::complex<double>(1, -1 / (2 * pi * point.at * times[std::size_t(k) - 1]));
      result.a(i, k) = term.real();
      if (both)
        result.a(n + i, k) = term.imag();
    }
    result.b[i] = std::sqrt(point.weight);
  }
  return result;
}

struct Solved {
  Equations equations;
  VectorXd x;
  VectorXd residuals;
};

Solved solved(Equations equations)
{
  VectorXd x = nonnegative_least_squares(equations.a, equations.b);
  VectorXd residuals = equations.a * x - equations.b;
  return {std::move(equations), std::move(x), std::move(residuals)};
}

RelaxationModulus modulus_of(const VectorXd& x, std::span<const double> times)
{
  RelaxationModulus law{x[0], {}};
  for (std::size_t k = 0; k < times.size(); ++k)
    if (x[1 + Index(k)] > 0)
      law.parts.push_back({times[k], x[1 + Index(k)]});
  return law;
}

/// Creep: D_0 = bound + x_0 with x_0 >= 0.
Solved solved_creep(const std::vector<Measurement>& points, std::span<const double> times)
{
  double least = infinity;
  for (const Measurement& point : points)
    least = std::min(least, point.value);
  const double bound = 1e-3 * least;
  Equations equations = creep_equations(points, times);
  equations.b -= bound * equations.a.col(0);
  Solved result = solved(std::move(equations));
  result.x[0] += bound;
  return result;
}

/// Magnitudes alone: each step is linear with the phases of the one before; the best is kept.
Solved solved_magnitudes(const std::vector<Measurement>& points, std::span<const double> times)
{
  std::vector<double> phases(points.size(), 0.4);
  Solved best;
  double least = infinity;
  for (int step = 0; step < 60; ++step) {
    Solved found = solved(dynamic_equations(points, times, phases, false));
    const RelaxationModulus law = modulus_of(found.x, times);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::complex<double> modulus = complex_modulus(law, 2 * pi * points[i].at);
      found.residuals[Index(i)] =
          (std::abs(modulus) / points[i].value - 1) * std::sqrt(points[i].weight);
      phases[i] = std::arg(modulus);
    }
    const double objective = found.residuals.squaredNorm();
    const bool settled = objective >= least * (1 - 1e-10);
    if (objective < least) {
      least = objective;
      best = std::move(found);
    }
    if (settled && step > 5)
      break;
  }
  return best;
}

Solved solved_dynamic(const std::vector<Measurement>& points, std::span<const double> times)
{
  if (!points.front().phase)
    return solved_magnitudes(points, times);
  std::vector<double> phases;
  for (const Measurement& point : points)
    phases.push_back(*point.phase);
  return solved(dynamic_equations(points, times, phases, true));
}

/// Standard errors of the coefficients off their bound.
std::vector<double> standard_errors(const Solved& found, const std::vector<Index>& active)
{
  std::vector<double> result(std::size_t(found.x.size()), 0.0);
  const MatrixXd spread =
      covariance(found.equations.a(Eigen::all, active), found.residuals.squaredNorm());
  for (std::size_t k = 0; k < active.size(); ++k)
    result[std::size_t(active[k])] = std::sqrt(spread(Index(k), Index(k)));
  return result;
}

} // namespace

std::vector<double> retardation_grid(double first, double last, int n)
{
  if (n == 1)
    return {std::sqrt(first * last)};
  std::vector<double> result;
  for (int k = 0; k < n; ++k)
    result.push_back(first * std::pow(last / first, double(k) / (n - 1)));
  return result;
}

SeriesSolution solve_series(const Measurements& data, std::span<const double> times)
{
  const bool creep = data.quantity == Quantity::creep_compliance;
  const Solved found = creep ? solved_creep(data.points, times)
                       : data.quantity == Quantity::relaxation_modulus
                           ? solved(relaxation_equations(data.points, times))
                           : solved_dynamic(data.points, times);
  const Index first = creep ? 2 : 1; // of the exponentials
  std::vector<Index> active;
  for (Index j = 0; j < found.x.size(); ++j)
    if (found.x[j] > 0)
      active.push_back(j);
  SeriesSolution result{{}, {}, found.residuals, int(active.size()), false};
  const std::vector<double> errors = standard_errors(found, active);
  for (Index j = 0; j < found.x.size(); ++j) {
    const double time = j >= first ? times[std::size_t(j - first)] : j == 0 ? 0.0 : infinity;
    result.coefficients.push_back({time, found.x[j], errors[std::size_t(j)]});
  }
  if (creep) {
    result.creep = {found.x[0], found.x[1], {}};
    for (std::size_t k = 0; k < times.size(); ++k)
      if (found.x[2 + Index(k)] > 0)
        result.creep.parts.push_back({times[k], found.x[2 + Index(k)]});
    double least = infinity;
    for (const Measurement& point : data.points)
      least = std::min(least, point.value);
    result.instantaneous_at_bound = found.x[0] <= 1.001e-3 * least;
  } else
    result.creep = creep_compliance(modulus_of(found.x, times));
  return result;
}

double relative_rms(const VectorXd& residuals, const std::vector<Measurement>& points)
{
  double weights = 0;
  for (const Measurement& point : points)
    weights += point.weight;
  return std::sqrt(residuals.squaredNorm() / weights);
}

double corrected_akaike(double sum_of_squares, int n_residuals, int n_parameters)
{
  const double n = n_residuals, k = n_parameters;
  if (n - k - 1 <= 0)
    return infinity;
  return n * std::log(std::max(sum_of_squares / n, 1e-24)) + 2 * k + 2 * k * (k + 1) / (n - k - 1);
}

TimeRange time_range(const Measurements& data)
{
  TimeRange range{infinity, 0};
  for (const Measurement& point : data.points) {
    const double time =
        data.quantity == Quantity::dynamic_modulus ? 1 / (2 * pi * point.at) : point.at;
    range = {std::min(range.first, time), std::max(range.last, time)};
  }
  return range;
}

std::vector<double> times_for(const Measurements& data, int n)
{
  const auto [first, last] = time_range(data);
  const double wider = data.quantity == Quantity::creep_compliance ? 1 : 10;
  return retardation_grid(first / wider, last * wider, n);
}

int number_of_terms(const Measurements& data, int n_other)
{
  const std::vector<double> ends = times_for(data, 2);
  const int most = std::max(1, 1 + int(std::floor(2 * std::log10(ends[1] / ends[0]))));
  int best = 1;
  double least = infinity;
  for (int n = 1; n <= most; ++n) {
    const SeriesSolution found = solve_series(data, times_for(data, n));
    const double criterion = corrected_akaike(
        found.residuals.squaredNorm(), int(found.residuals.size()), found.n_active + n_other);
    if (criterion < least) {
      least = criterion;
      best = n;
    }
  }
  return best;
}

namespace {

/// Times that were moved to the least sum of squares; none if two of them fell together.
struct MovedTimes {
  std::vector<double> times;
  double objective = infinity;
};

MovedTimes moved_from(const Measurements& data, const std::vector<double>& logarithms)
{
  const auto times_of = [](const VectorXd& x) {
    std::vector<double> times;
    for (const double each : x)
      times.push_back(std::exp(each));
    std::ranges::sort(times);
    return times;
  };
  const Eigen::Map<const VectorXd> from(logarithms.data(), Index(logarithms.size()));
  const Index n_residuals = solve_series(data, times_of(from)).residuals.size();
  const auto residuals = [&](const VectorXd& x) {
    if (x.cwiseAbs().maxCoeff() > 300)
      return VectorXd(VectorXd::Constant(n_residuals, infinity));
    return solve_series(data, times_of(x)).residuals;
  };
  const LeastSquaresResult found = levenberg_marquardt(residuals, from, 60);
  const std::vector<double> times = times_of(found.parameters);
  for (std::size_t k = 1; k < times.size(); ++k)
    if (times[k] < 1.01 * times[k - 1])
      return {};
  return {times, found.objective};
}

} // namespace

std::vector<double> moved_times(const Measurements& data, std::span<const double> grid)
{
  const SeriesSolution start = solve_series(data, grid);
  const std::size_t first = start.coefficients.size() - grid.size();
  std::vector<double> logarithms;
  for (std::size_t k = 0; k < grid.size(); ++k) {
    const double here = start.coefficients[first + k].value;
    const double next = k + 1 < grid.size() ? start.coefficients[first + k + 1].value : 0.0;
    if (here > 0 && next > 0) {
      logarithms.push_back((here * std::log(grid[k]) + next * std::log(grid[k + 1])) /
                           (here + next));
      ++k;
    } else if (here > 0)
      logarithms.push_back(std::log(grid[k]));
  }
  if (logarithms.empty())
    return {};
  return moved_from(data, logarithms).times;
}

std::vector<double> best_times(const Measurements& data, int n)
{
  MovedTimes best;
  std::vector<double> before; // logarithms of the best times, one fewer
  for (int m = 1; m <= n; ++m) {
    std::vector<std::vector<double>> starts;
    std::vector<double> grid;
    for (const double time : times_for(data, m))
      grid.push_back(std::log(time));
    starts.push_back(grid);
    const TimeRange range = time_range(data);
    std::vector<double> gaps{std::log(range.first)};
    gaps.insert(gaps.end(), before.begin(), before.end());
    gaps.push_back(std::log(range.last));
    std::ranges::sort(gaps);
    for (std::size_t k = 0; m > 1 && k + 1 < gaps.size(); ++k) { // one more in each gap
      starts.push_back(before);
      starts.back().push_back(0.5 * (gaps[k] + gaps[k + 1]));
    }
    best = {};
    for (const std::vector<double>& start : starts)
      if (const MovedTimes found = moved_from(data, start);
          !found.times.empty() && found.objective < best.objective)
        best = found;
    if (best.times.empty())
      return times_for(data, n);
    before.clear();
    for (const double time : best.times)
      before.push_back(std::log(time));
  }
  return best.times;
}

std::vector<Interval> bootstrap_intervals(const Measurements& data, std::span<const double> times,
                                          int n_samples, std::uint64_t seed)
{
  const SeriesSolution fit = solve_series(data, times);
  const std::size_t n = data.points.size();
  const bool both = std::size_t(fit.residuals.size()) == 2 * n;
  std::mt19937_64 random(seed);
  std::vector<std::vector<double>> drawn(fit.coefficients.size());
  for (int sample = 0; sample < n_samples; ++sample) {
    Measurements again = data;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t from = random() % n;
      Measurement& point = again.points[i];
      const auto error = [&](std::size_t of, std::size_t row) {
        return fit.residuals[Index(row * n + of)] / std::sqrt(data.points[of].weight);
      };
      // The fit at this point is value (1 + its own error); another's error is taken off it.
      point.value *= (1 + error(i, 0)) / (1 + error(from, 0));
      if (both)
        *point.phase += error(i, 1) - error(from, 1);
    }
    const SeriesSolution found = solve_series(again, times);
    for (std::size_t k = 0; k < drawn.size(); ++k)
      drawn[k].push_back(found.coefficients[k].value);
  }
  std::vector<Interval> result;
  for (std::vector<double>& values : drawn) {
    std::ranges::sort(values);
    const std::size_t tail = values.size() / 40;
    result.push_back({values[tail], values[values.size() - 1 - tail]});
  }
  return result;
}

} // namespace fem
