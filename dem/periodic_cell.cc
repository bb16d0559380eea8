#include "dem/periodic_cell.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace dem {

namespace {

bool is_first_of_two(Index i, Index j, const ImageShift& shift)
{
  if (i != j)
    return i < j;
  for (int k = 0; k < 3; ++k)
    if (shift[k] != 0)
      return shift[k] > 0;
  return false;
}

/// Spheres of the cell, then all their images that come within reach of the cell.
struct Images {
  std::vector<Vec3> centre;
  std::vector<double> radius;
  std::vector<Index> original;
  std::vector<ImageShift> shift; ///< from the wrapped original
};

Images images_near(const PeriodicCell& cell, std::span<const Vec3> wrapped,
                   std::span<const double> radius, double margin)
{
  Images images{{wrapped.begin(), wrapped.end()},
                {radius.begin(), radius.end()},
                std::vector<Index>(wrapped.size()),
                std::vector<ImageShift>(wrapped.size(), ImageShift::Zero())};
  std::iota(images.original.begin(), images.original.end(), 0);
  const Mat3 inverse = cell.edges.inverse();
  const Vec3 distance = face_distances(cell);
  const double largest = std::ranges::max(radius);
  for (std::size_t i = 0; i < wrapped.size(); ++i) {
    const Vec3 place = inverse * wrapped[i];
    std::array<int, 3> first, last;
    for (int k = 0; k < 3; ++k) {
      const double reach = (radius[i] + largest + margin) * (1 + 1e-9) / distance[k];
      first[k] = int(std::ceil(-reach - place[k]));
      last[k] = int(std::floor(1 + reach - place[k]));
    }
    for (int a = first[0]; a <= last[0]; ++a)
      for (int b = first[1]; b <= last[1]; ++b)
        for (int c = first[2]; c <= last[2]; ++c)
          if (const ImageShift shift(a, b, c); !shift.isZero()) {
            images.centre.push_back(wrapped[i] + cell.translation(shift));
            images.radius.push_back(radius[i]);
            images.original.push_back(Index(i));
            images.shift.push_back(shift);
          }
  }
  return images;
}

struct Neighbour {
  Index first, second;
  ImageShift shift;
};

} // namespace

PeriodicCell make_periodic_cell(const Mat3& edges)
{
  if (!edges.allFinite())
    throw std::invalid_argument("periodic cell: the edges must be finite numbers");
  const Vec3 lengths = edges.colwise().norm();
  if (!(edges.determinant() > 1e-9 * lengths.prod()))
    throw std::invalid_argument(
        "periodic cell: the three edges must be right-handed and must not lie in one plane");
  return {edges};
}

PeriodicCell box_cell(const Vec3& lengths)
{
  if (!(lengths.minCoeff() > 0))
    throw std::invalid_argument("periodic cell: the edges of a box must be > 0");
  return make_periodic_cell(lengths.asDiagonal());
}

Mat3 face_areas(const PeriodicCell& cell)
{
  return cell.volume() * cell.edges.inverse().transpose();
}

Vec3 face_distances(const PeriodicCell& cell)
{
  return cell.edges.inverse().rowwise().norm().cwiseInverse();
}

ImageShift shift_into_cell(const PeriodicCell& cell, const Vec3& point)
{
  constexpr double on_a_face = 1e-12;
  const Vec3 place = cell.edges.inverse() * point;
  ImageShift shift;
  for (int k = 0; k < 3; ++k)
    shift[k] = -int(std::floor(place[k] + on_a_face));
  return shift;
}

PeriodicNeighbours periodic_near_pairs(const PeriodicCell& cell, std::span<const Vec3> centre,
                                       std::span<const double> radius, double margin)
{
  PeriodicNeighbours result;
  result.list.start.assign(centre.size() + 1, 0);
  if (centre.empty())
    return result;
  const std::size_t n = centre.size();
  std::vector<Vec3> wrapped;
  std::vector<ImageShift> into;
  for (const Vec3& point : centre) {
    into.push_back(shift_into_cell(cell, point));
    wrapped.push_back(point + cell.translation(into.back()));
  }
  const Images images = images_near(cell, wrapped, radius, margin);
  const NeighbourList near = near_pairs(images.centre, images.radius, margin);
  std::vector<Neighbour> found;
  for (std::size_t p = 0; p < images.original.size(); ++p)
    for (Index k = near.start[p]; k < near.start[p + 1]; ++k)
      for (const auto [home, away] :
           {std::array{Index(p), near.neighbour[k]}, std::array{near.neighbour[k], Index(p)}}) {
        if (std::size_t(home) >= n)
          continue;
        const Index j = images.original[away];
        const bool both_at_home = std::size_t(away) < n;
        if (both_at_home ? home < away : is_first_of_two(home, j, images.shift[away]))
          found.push_back({home, j, images.shift[away] + into[j] - into[home]});
      }
  std::ranges::stable_sort(found, {}, &Neighbour::first);
  for (const auto& [first, second, shift] : found) {
    ++result.list.start[first + 1];
    result.list.neighbour.push_back(second);
    result.shift.push_back(shift);
  }
  std::partial_sum(result.list.start.begin(), result.list.start.end(), result.list.start.begin());
  return result;
}

} // namespace dem
