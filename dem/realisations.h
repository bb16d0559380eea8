#pragma once
#include "dem/homogenization.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace dem {

/// Calls work(k) for k = 0 ... n - 1 on some threads, each k once. What work(k) does must depend on
/// k alone; then so do the results. If calls throw, the exception of the smallest k comes out.
/// \throws std::invalid_argument unless n_threads >= 1
void for_each_realisation(int n, int n_threads, const std::function<void(int)>& work);

/// Elastic stiffness of one volume element under three boundary conditions [Pa].
struct ElementBounds {
  Mat6 kinematic, periodic, traction;
  double size_ratio; ///< smallest distance of two faces over the largest diameter [-]
};
ElementBounds element_bounds(const VolumeElement& element);

/// Bounds of the elements that `make` gives for seeds first_seed, first_seed + 1, ...
std::vector<ElementBounds> realisations(const std::function<VolumeElement(std::uint64_t)>& make,
                                        std::uint64_t first_seed, int n, int n_threads);

/// Mean and scatter of a tensor over realisations, component by component.
struct TensorStatistics {
  int n;
  Mat6 mean;
  Mat6 standard_deviation; ///< of one realisation, with n - 1
  Mat6 band;               ///< half width of the confidence band of the mean (Student's t)
};

/// \param confidence  of the band, between 0 and 1
/// \throws std::invalid_argument for less than two tensors
TensorStatistics statistics(std::span<const Mat6> tensors, double confidence = 0.95);

/// Whether volume elements of a size are representative.
struct SizeVerdict {
  double gap;        ///< half of mean(kinematic - traction) over mean(periodic), in norm [-]
  double scatter;    ///< root mean square distance of a periodic stiffness from the mean [-]
  double band;       ///< confidence band of the mean periodic stiffness, in norm [-]
  double size_ratio; ///< smallest one
  bool is_large_enough;
  std::string reason; ///< why not, one clear sentence; empty if large enough
};

/// Smallest distance of two faces over the largest diameter that counts as representative.
constexpr double smallest_size_ratio = 5;

/// Large enough for a relative tolerance: gap and scatter are at most that, and the cell holds five
/// of the largest diameters. The gap is a strict criterion: it also contains what the surface does
/// to kinematic and traction conditions, which periodic ones avoid.
SizeVerdict judge_size(std::span<const ElementBounds> bounds, double tolerance,
                       double confidence = 0.95);

} // namespace dem
