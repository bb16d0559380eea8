#pragma once
#include "fem/creep_compliance.h"
#include "fem/measurements.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

namespace fem {

/// One coefficient of a series.
struct SeriesCoefficient {
  double time;           ///< of its exponential [s]; 0: D_0 or E_inf; infinity: the fluidity
  double value;          ///< D_k or E_k [1/Pa or Pa], >= 0
  double standard_error; ///< linearised; 0 for a coefficient at its bound
};

/// Non-negative series with given times.
struct SeriesSolution {
  CreepCompliance creep; ///< the law in creep form, whatever was measured
  /// In the form of the data: D_0, fluidity, D_k for creep compliance; E_inf, E_k for moduli.
  std::vector<SeriesCoefficient> coefficients;
  Eigen::VectorXd residuals;   ///< relative errors times sqrt(weight), one or two rows per point
  int n_active;                ///< coefficients off their bound
  bool instantaneous_at_bound; ///< the data do not show the instantaneous compliance
};

/// Times spread evenly over the logarithm from first to last [s], both included; n = 1 gives the
/// middle.
std::vector<double> retardation_grid(double first, double last, int n);

/// Series of given times nearest to measurements: least sum of weighted squared relative errors
/// with coefficients >= 0 (fem/least_squares.h), so that the law is admissible.
///
/// Creep compliance is fitted in creep form; D_0 is kept above 1/1000 of the least measured
/// compliance. Moduli are fitted in relaxation form, which is as linear, and converted exactly.
/// With phase angles the error of a point is |E_fit* / E* - 1|; without them the error of the
/// magnitude, by Gauss-Newton iterations on its phase. Temperatures are not looked at: `at` is the
/// reduced time or frequency.
SeriesSolution solve_series(const Measurements& data, std::span<const double> times);

/// Root mean square of residuals per weight of the points.
double relative_rms(const Eigen::VectorXd& residuals, const std::vector<Measurement>& points);

/// Akaike's information criterion corrected for small samples, N ln(RSS/N) + 2k + 2k(k+1)/(N-k-1),
/// infinite when N <= k + 1. RSS is taken as at least N 1e-24 (rounding).
double corrected_akaike(double sum_of_squares, int n_residuals, int n_parameters);

/// Range of times that measurements speak about [s]: of the times, or of 1/omega.
struct TimeRange {
  double first, last;
};
TimeRange time_range(const Measurements& data);

/// Grid of n times over the range of the data; for moduli a decade wider on both sides, as the ends
/// of a relaxation spectrum lie outside the range in which they are seen.
std::vector<double> times_for(const Measurements& data, int n);

/// Number of times on the grid that makes `corrected_akaike` least, with active coefficients and
/// `n_other` further ones as parameters: from 1 to 2 a decade, beyond which the terms cannot be
/// told apart (condition number 300; 20 times more with each further term a decade).
int number_of_terms(const Measurements& data, int n_other = 0);

/// Retardation times that are free to move: those active on a grid, of each two neighbours one in
/// between (that is how a grid shows a time that it does not hold), moved to the least sum of
/// squares with the coefficients solved anew each time. A law of few times is found exactly.
/// \return nothing if two times fall together (closer than 1 %)
std::vector<double> moved_times(const Measurements& data, std::span<const double> grid);

/// The n times with which the series comes nearest to the data: as `moved_times`, from the grid and
/// from the best n - 1 times with one more in each gap. A local minimum that in general is the
/// best; the grid if times fall together.
std::vector<double> best_times(const Measurements& data, int n);

/// Interval of a coefficient.
struct Interval {
  double low, high;
};

/// 95 % intervals of the coefficients by residual bootstrap: residuals are drawn anew (with
/// replacement) around the fit and fitted again. The same seed gives the same intervals.
std::vector<Interval> bootstrap_intervals(const Measurements& data, std::span<const double> times,
                                          int n_samples, std::uint64_t seed);

} // namespace fem
