#include "dem/realisations.h"

#include "dem/one_thread.h"
#include "dem/thread_team.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <stdexcept>

namespace dem {

namespace {

std::vector<Mat6> tensors(std::span<const ElementBounds> bounds, Mat6 ElementBounds::*which)
{
  std::vector<Mat6> result;
  for (const ElementBounds& each : bounds)
    result.push_back(each.*which);
  return result;
}

Mat6 mean(std::span<const Mat6> tensors)
{
  Mat6 sum = Mat6::Zero();
  for (const Mat6& each : tensors)
    sum += each;
  return sum / double(tensors.size());
}

} // namespace

void for_each_realisation(int n, int n_threads, const std::function<void(int)>& work)
{
  if (n_threads < 1)
    throw std::invalid_argument(
        fmt::format("realisations: the number of threads must be >= 1, found {}", n_threads));
  const OneThread inside;
  std::atomic<int> next{0};
  std::vector<std::exception_ptr> failure(std::size_t(std::max(0, n)));
  run_on_threads(std::min(n_threads, std::max(1, n)), [&](int) {
    const OneThread here; // levels of OpenMP are counted by thread
    for (int k = next++; k < n; k = next++)
      try {
        work(k);
      } catch (...) {
        failure[std::size_t(k)] = std::current_exception();
      }
  });
  for (const std::exception_ptr& each : failure)
    if (each)
      std::rethrow_exception(each);
}

ElementBounds element_bounds(const VolumeElement& element)
{
  const auto stiffness = [&](BoundaryCondition condition) {
    return homogenize(element, condition).stiffness;
  };
  return {stiffness(BoundaryCondition::kinematic), stiffness(BoundaryCondition::periodic),
          stiffness(BoundaryCondition::uniform_traction),
          face_distances(element.cell).minCoeff() /
              (2 * std::ranges::max(element.particles.radius))};
}

std::vector<ElementBounds> realisations(const std::function<VolumeElement(std::uint64_t)>& make,
                                        std::uint64_t first_seed, int n, int n_threads)
{
  std::vector<ElementBounds> result(std::size_t(std::max(0, n)));
  for_each_realisation(n, n_threads, [&](int k) {
    result[std::size_t(k)] = element_bounds(make(first_seed + std::uint64_t(k)));
  });
  return result;
}

TensorStatistics statistics(std::span<const Mat6> tensors, double confidence)
{
  if (tensors.size() < 2)
    throw std::invalid_argument(
        fmt::format("statistics: at least two realisations are needed, found {}", tensors.size()));
  if (!(confidence > 0 && confidence < 1))
    throw std::invalid_argument(
        fmt::format("statistics: the confidence must lie between 0 and 1, found {:g}", confidence));
  const auto n = double(tensors.size());
  TensorStatistics result{int(tensors.size()), mean(tensors), Mat6::Zero(), Mat6::Zero()};
  for (const Mat6& each : tensors)
    result.standard_deviation += (each - result.mean).cwiseAbs2() / (n - 1);
  result.standard_deviation = result.standard_deviation.cwiseSqrt().eval();
  const double t = boost::math::quantile(boost::math::students_t(n - 1), 0.5 + 0.5 * confidence);
  result.band = result.standard_deviation * (t / std::sqrt(n));
  return result;
}

SizeVerdict judge_size(std::span<const ElementBounds> bounds, double tolerance, double confidence)
{
  const TensorStatistics periodic =
      statistics(tensors(bounds, &ElementBounds::periodic), confidence);
  const Mat6 kinematic = mean(tensors(bounds, &ElementBounds::kinematic));
  const Mat6 traction = mean(tensors(bounds, &ElementBounds::traction));
  const double size = periodic.mean.norm();
  SizeVerdict verdict{0.5 * (kinematic - traction).norm() / size,
                      periodic.standard_deviation.norm() / size,
                      periodic.band.norm() / size,
                      std::numeric_limits<double>::infinity(),
                      false,
                      {}};
  for (const ElementBounds& each : bounds)
    verdict.size_ratio = std::min(verdict.size_ratio, each.size_ratio);
  if (!(verdict.size_ratio >= smallest_size_ratio))
    verdict.reason =
        fmt::format("the cell holds only {:.1f} of the largest diameters, {:g} are asked",
                    verdict.size_ratio, smallest_size_ratio);
  else if (!(verdict.gap <= tolerance))
    verdict.reason = fmt::format("the bounds lie {:.2g} % from their middle, {:.2g} % are asked",
                                 100 * verdict.gap, 100 * tolerance);
  else if (!(verdict.scatter <= tolerance))
    verdict.reason = fmt::format("realisations scatter by {:.2g} %, {:.2g} % are asked",
                                 100 * verdict.scatter, 100 * tolerance);
  verdict.is_large_enough = verdict.reason.empty();
  return verdict;
}

} // namespace dem
