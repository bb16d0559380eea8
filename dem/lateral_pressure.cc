#include "dem/lateral_pressure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace dem {

namespace {

/// Cubic cells of particles, stored cell after cell.
struct Cells {
  Vec3 low;
  double size;
  std::array<int, 3> n;
  std::vector<Index> start;
  std::vector<Index> particle;

  std::array<int, 3> place(const Vec3& point) const
  {
    std::array<int, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = int(std::clamp((point[axis] - low[axis]) / size, 0.0, double(n[axis]) - 0.5));
    return cell;
  }
  std::size_t number(const std::array<int, 3>& cell) const
  {
    return (std::size_t(cell[2]) * n[1] + cell[1]) * n[0] + cell[0];
  }
};

/// Not many more cells than particles.
Cells make_cells(const Particles& particles)
{
  Vec3 low = particles.centre[0], high = low;
  for (const Vec3& centre : particles.centre) {
    low = low.cwiseMin(centre);
    high = high.cwiseMax(centre);
  }
  Cells cells{low, 0.5 * std::ranges::max(particles.radius), {}, {}, {}};
  const Vec3 extent = high - low;
  const double room = extent.prod() / double(particles.size());
  cells.size = std::max(cells.size, std::cbrt(room));
  for (int axis = 0; axis < 3; ++axis)
    cells.n[axis] = 1 + int(std::min(1e4, extent[axis] / cells.size));
  cells.start.assign(std::size_t(cells.n[0]) * cells.n[1] * cells.n[2] + 1, 0);
  for (const Vec3& centre : particles.centre)
    ++cells.start[cells.number(cells.place(centre)) + 1];
  std::partial_sum(cells.start.begin(), cells.start.end(), cells.start.begin());
  cells.particle.resize(particles.size());
  std::vector<Index> next(cells.start.begin(), cells.start.end() - 1);
  for (std::size_t i = 0; i < particles.size(); ++i)
    cells.particle[next[cells.number(cells.place(particles.centre[i]))]++] = Index(i);
  return cells;
}

/// Calls `visit` with the number of each cell that is `shell` cells away.
template <typename Visit>
void visit_shell(const Cells& cells, const std::array<int, 3>& home, int shell, Visit&& visit)
{
  std::array<int, 3> first{}, last{}, cell{};
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = std::max(0, home[axis] - shell);
    last[axis] = std::min(cells.n[axis] - 1, home[axis] + shell);
  }
  const auto away = [&](int axis) { return std::abs(cell[axis] - home[axis]); };
  for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2])
    for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
      for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
        if (std::max({away(0), away(1), away(2)}) == shell)
          visit(cells.number(cell));
}

/// Sphere whose surface is nearest to a point; of equally near ones the first.
///
/// Cells are searched in shells about that of the point until no sphere further out can be nearer.
Index nearest_sphere(const Particles& particles, const Cells& cells, double largest_radius,
                     const Vec3& point)
{
  const std::array<int, 3> home = cells.place(point);
  double least = std::numeric_limits<double>::infinity();
  Index nearest = -1;
  const auto compare = [&](std::size_t cell) {
    for (Index k = cells.start[cell]; k < cells.start[cell + 1]; ++k) {
      const Index i = cells.particle[k];
      const double gap = (particles.centre[i] - point).norm() - particles.radius[i];
      if (gap < least || (gap == least && i < nearest)) {
        least = gap;
        nearest = i;
      }
    }
  };
  for (int shell = 0; shell < std::ranges::max(cells.n); ++shell) {
    if ((shell - 1) * cells.size - largest_radius > least)
      break;
    visit_shell(cells, home, shell, compare);
  }
  return nearest;
}

void refuse_spheres_outside(const Particles& particles, const Cylinder& cylinder, const Vec3& base)
{
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double off_axis = (particles.centre[i] - base).head<2>().norm();
    if (!(off_axis <= cylinder.radius))
      throw std::invalid_argument(
          fmt::format("confining stress: the centre of particle {} is {:.4g} mm off the axis of "
                      "the cylinder (x = {:g} mm, y = {:g} mm), which has a radius of {:.4g} mm; "
                      "move the packing to the axis or correct the diameter",
                      i, 1e3 * off_axis, 1e3 * base.x(), 1e3 * base.y(), 1e3 * cylinder.radius));
  }
}

/// Outward normals at the middles of the patches around, the four quarters alike to the last bit.
std::vector<Vec3> normals(int n_quarter)
{
  std::vector<Vec3> all(4 * std::size_t(n_quarter));
  for (int k = 0; k < n_quarter; ++k) {
    const double angle = 0.5 * std::numbers::pi * (k + 0.5) / n_quarter;
    const double x = std::cos(angle), y = std::sin(angle);
    const Vec3 quarters[] = {{x, y, 0}, {-y, x, 0}, {-x, -y, 0}, {y, -x, 0}};
    for (int quarter = 0; quarter < 4; ++quarter)
      all[std::size_t(quarter) * n_quarter + k] = quarters[quarter];
  }
  return all;
}

} // namespace

std::vector<ParticleLoad> lateral_pressure(const Particles& particles, const Cylinder& cylinder,
                                           const Vec3& base)
{
  refuse_spheres_outside(particles, cylinder, base);
  if (particles.size() == 0)
    return {};
  const auto [smallest, largest] = std::ranges::minmax(particles.radius);
  const double spacing = patch_share * smallest;
  const double around = 2 * std::numbers::pi * cylinder.radius;
  const std::vector<Vec3> normal = normals(int(std::ceil(around / 4 / spacing)));
  const int n_high = int(std::ceil(cylinder.height / spacing));
  const double height = cylinder.height / n_high, area = around / double(normal.size()) * height;
  const Cells cells = make_cells(particles);
  std::vector<ParticleLoad> all(particles.size(), {-1, Vec3::Zero(), Vec3::Zero()});
  for (int k = 0; k < n_high; ++k)
    for (const Vec3& n : normal) {
      const Vec3 point = base + cylinder.radius * n + Vec3(0, 0, (k + 0.5) * height);
      const Index i = nearest_sphere(particles, cells, largest, point);
      const Vec3 force = -area * n;
      all[i].particle = i;
      all[i].force += force;
      all[i].moment += (point - particles.centre[i]).cross(force);
    }
  std::erase_if(all, [](const ParticleLoad& load) { return load.particle < 0; });
  return all;
}

} // namespace dem
