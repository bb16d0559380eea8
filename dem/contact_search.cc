#include "dem/contact_search.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>

namespace dem {

namespace {

struct Sphere {
  Vec3 centre;
  double radius;
  Index id;
};

/// Linked cells for the spheres of one size class, stored cell after cell.
struct Level {
  double largest_radius;
  Vec3 origin;
  double cell_size;
  std::array<int, 3> n_cells;
  std::vector<Index> start;
  std::vector<Sphere> sphere;

  int coordinate(double position, int axis) const
  {
    const int cell = int((position - origin[axis]) / cell_size);
    return std::clamp(cell, 0, n_cells[axis] - 1);
  }
  std::size_t cell(int x, int y, int z) const
  {
    return (std::size_t(z) * n_cells[1] + y) * n_cells[0] + x;
  }
};

/// Cells of about the largest radius (smaller ones cost more visits than they save tests), but not
/// more than a few per sphere.
Level make_level(const Vec3& low, const Vec3& high, double largest_radius, double margin,
                 std::size_t n_spheres)
{
  Level level{largest_radius, low, largest_radius + 0.5 * margin, {}, {}, {}};
  const Vec3 extent = high - low;
  double total;
  do {
    total = 1;
    for (int axis = 0; axis < 3; ++axis) {
      level.n_cells[axis] = std::max(1, int(std::min(1e6, extent[axis] / level.cell_size)));
      total *= level.n_cells[axis];
    }
    level.cell_size *= 1.25;
  } while (total > 8.0 * double(n_spheres) + 1000);
  level.cell_size /= 1.25;
  level.start.assign(std::size_t(total) + 1, 0);
  return level;
}

/// Size class of each sphere; class 0 holds the largest.
std::vector<int> size_classes(std::span<const double> radius, double largest, int n_levels)
{
  std::vector<int> result(radius.size());
  for (std::size_t i = 0; i < radius.size(); ++i)
    result[i] = std::clamp(int(std::floor(std::log2(largest / radius[i]))), 0, n_levels - 1);
  return result;
}

std::vector<Level> sorted_levels(std::span<const Vec3> centre, std::span<const double> radius,
                                 std::span<const int> size_class, int n_levels, double margin)
{
  const double largest = std::ranges::max(radius);
  Vec3 low = centre[0], high = centre[0];
  for (const Vec3& point : centre) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  std::vector<std::size_t> count(n_levels, 0);
  for (const int c : size_class)
    ++count[c];
  std::vector<Level> levels;
  for (int l = 0; l < n_levels; ++l)
    levels.push_back(make_level(low, high, std::ldexp(largest, -l), margin, count[l]));

  const auto cell_of = [&](std::size_t i) {
    const Level& level = levels[size_class[i]];
    return level.cell(level.coordinate(centre[i].x(), 0), level.coordinate(centre[i].y(), 1),
                      level.coordinate(centre[i].z(), 2));
  };
  std::vector<std::size_t> cell(centre.size());
  for (std::size_t i = 0; i < centre.size(); ++i)
    ++levels[size_class[i]].start[(cell[i] = cell_of(i)) + 1];
  std::vector<std::vector<Index>> next;
  for (Level& level : levels) {
    std::partial_sum(level.start.begin(), level.start.end(), level.start.begin());
    level.sphere.resize(level.start.back());
    next.emplace_back(level.start.begin(), level.start.end() - 1);
  }
  for (std::size_t i = 0; i < centre.size(); ++i)
    levels[size_class[i]].sphere[next[size_class[i]][cell[i]]++] = {centre[i], radius[i], Index(i)};
  return levels;
}

} // namespace

NeighbourList near_pairs(std::span<const Vec3> centre, std::span<const double> radius,
                         double margin)
{
  assert(centre.size() == radius.size());
  NeighbourList list;
  list.start.reserve(centre.size() + 1);
  list.start.push_back(0);
  if (centre.empty())
    return list;
  const auto [smallest, largest] = std::ranges::minmax(radius);
  const int n_levels = 1 + int(std::floor(std::log2(largest / smallest)));
  const std::vector<int> size_class = size_classes(radius, largest, n_levels);
  const std::vector<Level> levels = sorted_levels(centre, radius, size_class, n_levels, margin);

  for (std::size_t i = 0; i < centre.size(); ++i) {
    const Vec3 here = centre[i];
    const double own_reach = radius[i] + margin;
    for (int l = 0; l <= size_class[i]; ++l) {
      const Level& level = levels[l];
      const double reach = own_reach + level.largest_radius;
      std::array<int, 3> first, last;
      for (int axis = 0; axis < 3; ++axis) {
        first[axis] = level.coordinate(here[axis] - reach, axis);
        last[axis] = level.coordinate(here[axis] + reach, axis);
      }
      for (int z = first[2]; z <= last[2]; ++z)
        for (int y = first[1]; y <= last[1]; ++y) {
          const Index begin = level.start[level.cell(first[0], y, z)];
          const Index end = level.start[level.cell(last[0], y, z) + 1];
          for (Index k = begin; k < end; ++k) {
            const Sphere& other = level.sphere[k];
            const double cut = own_reach + other.radius;
            if ((other.centre - here).squaredNorm() < cut * cut &&
                (l < size_class[i] || other.id > Index(i)))
              list.neighbour.push_back(other.id);
          }
        }
    }
    list.start.push_back(Index(list.neighbour.size()));
  }
  return list;
}

} // namespace dem
