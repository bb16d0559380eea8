#pragma once
#include "dem/homogenization.h"
#include "fem/compliance_law.h"

#include <optional>
#include <span>
#include <vector>

/// Where the vocabularies of the discrete and of the continuous model meet.
///
/// SI units, tension positive, Mandel notation (order 11, 22, 33, 23, 13, 12) on both sides.
namespace coupling {

/// The law of a volume element whose bonds all follow one creep law J(t) up to factors: elastic
/// compliance times J(t) / J(0), term by term and exact for all times.
/// \param elastic  S(0) [1/Pa], positive definite
/// \throws std::invalid_argument if it is not, or two retardation times are equal
fem::ComplianceLaw proportional_law(const fem::Mat6& elastic, const dem::CreepLaw& creep);

/// How a law is taken from elements whose bonds follow several laws.
struct SamplingOptions {
  double first_time = 1e-3, last_time = 1e4; ///< of the creep tests [s]
  int n_times = 61;                          ///< evenly over the logarithm, besides t = 0+
  double tolerance = 1e-5;                   ///< of the time stepping, relative, per interval
  int n_terms = 0; ///< retardation times over the same range; 0: see `fitted_law`
};

/// A law that was taken from volume elements.
struct ExtractedLaw {
  fem::ComplianceLaw law;
  bool is_exact;                ///< no fit was needed
  double relative_rms = 0;      ///< of the fit over the samples [-]
  double largest_error = 0;     ///< of the fit over the samples, relative [-]
  double optimality_gap = 0;    ///< of the fit (fem/tensor_fit.h)
  double stepping_error = 0;    ///< largest estimated error of time stepping, relative [-]
  double first_time, last_time; ///< times for which it stands [s]; 0 to infinity if exact
};

/// Relative rms error of a fitted law that is good enough [-].
constexpr double sufficient_error = 1e-3;

/// Mean creep compliance of elements at some times.
struct MeanCompliance {
  std::vector<double> time;          ///< [s], the first is 0
  std::vector<fem::Mat6> compliance; ///< [1/Pa]
  double stepping_error;             ///< largest over elements and times
};

/// S(t) of one element whose laws may be any, by time stepping under six unit stresses.
/// \throws std::invalid_argument for an element that was cut out, or options out of range
MeanCompliance sampled_compliance(const dem::VolumeElement& element,
                                  const SamplingOptions& options);

/// S*(omega) of an element at angular frequencies [rad/s], by one complex solution each.
std::vector<fem::ComplexMat6> complex_compliances(const dem::VolumeElement& element,
                                                  std::span<const double> omega);

/// Largest relative difference of a law from complex compliances at these frequencies [-].
double frequency_difference(const fem::ComplianceLaw& law, std::span<const double> omega,
                            std::span<const fem::ComplexMat6> compliances);

/// Mean of several, at the same times.
MeanCompliance mean_of(std::span<const MeanCompliance> samples);

/// The admissible law nearest to samples (cone-constrained least squares). If their number is not
/// given, retardation times are added, from one per two decades to three per decade, until the rms
/// error is below 1e-3 (`sufficient_error`); more could not be told apart. They lie on a grid, or
/// where the trace of S(t) is met best (`fem::best_times`, `fem::moved_times`) if
/// that is nearer.
ExtractedLaw fitted_law(const MeanCompliance& samples, const SamplingOptions& options);

} // namespace coupling
