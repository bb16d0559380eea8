#include "dem/soft_spheres.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace dem {

namespace {

/// Calls wall(gap, unit normal into the container) for each wall that a sphere may touch.
template <typename Wall>
void for_each_wall(const Container& container, const Vec3& centre, double radius, Wall&& wall)
{
  const auto* cylinder = std::get_if<Cylinder>(&container);
  if (!cylinder)
    return;
  const double off_axis = centre.head<2>().norm();
  if (off_axis > 0)
    wall(cylinder->radius - radius - off_axis,
         Vec3(-centre.x() / off_axis, -centre.y() / off_axis, 0));
  wall(centre.z() - radius, Vec3(0, 0, 1));
  wall(cylinder->height - radius - centre.z(), Vec3(0, 0, -1));
}

/// Calls contact(i, j, overlap, unit normal from j to i) for overlapping spheres and, with j = -1,
/// wall(i, overlap, unit normal into the container).
template <typename Contact, typename Wall>
void for_each_contact(const SoftSpheres& spheres, const NearSpheres& near, Contact&& contact,
                      Wall&& wall)
{
  const auto& [container, centre, radius] = spheres;
  const auto* cylinder = std::get_if<Cylinder>(&container);
  const bool is_periodic = !near.offset.empty();
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const Vec3 here = centre[i];
    for (Index k = near.list.start[i]; k < near.list.start[i + 1]; ++k) {
      const Index j = near.list.neighbour[k];
      Vec3 branch = here - centre[j];
      if (is_periodic)
        branch -= near.offset[k];
      const double reach = radius[i] + radius[j], squared = branch.squaredNorm();
      if (squared >= reach * reach)
        continue;
      const double distance = std::max(std::sqrt(squared), 1e-9 * reach);
      contact(i, std::size_t(j), reach - distance, Vec3(branch / distance));
    }
    if (!cylinder)
      continue;
    const double room = cylinder->radius - radius[i], squared = here.head<2>().squaredNorm();
    if (squared > room * room) {
      const double off_axis = std::sqrt(squared);
      wall(i, off_axis - room, Vec3(-here.x() / off_axis, -here.y() / off_axis, 0));
    }
    if (const double overlap = radius[i] - here.z(); overlap > 0)
      wall(i, overlap, Vec3(0, 0, 1));
    if (const double overlap = here.z() + radius[i] - cylinder->height; overlap > 0)
      wall(i, overlap, Vec3(0, 0, -1));
  }
}

/// Fills in the near pairs.
void search(NearSpheres& near, const SoftSpheres& spheres)
{
  near.offset.clear();
  if (const auto* cell = std::get_if<PeriodicCell>(&spheres.container)) {
    PeriodicNeighbours found =
        periodic_near_pairs(*cell, spheres.centre, spheres.radius, near.skin);
    near.list = std::move(found.list);
    for (const ImageShift& shift : found.shift)
      near.offset.push_back(cell->translation(shift));
  } else
    near.list = near_pairs(spheres.centre, spheres.radius, near.skin);
  near.reference = spheres;
}

/// Largest loss of gap between two spheres since the reference [m].
double largest_approach(const SoftSpheres& spheres, const SoftSpheres& reference)
{
  double moved = 0, grown = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    moved = std::max(moved, (spheres.centre[i] - reference.centre[i]).squaredNorm());
    grown = std::max(grown, spheres.radius[i] - reference.radius[i]);
  }
  return 2 * (std::sqrt(moved) + grown);
}

/// Inverse masses that even out the frequencies: large spheres have many contacts.
std::vector<double> inverse_masses(const std::vector<double>& radius)
{
  const double smallest = *std::ranges::min_element(radius);
  std::vector<double> result;
  for (const double r : radius)
    result.push_back(std::pow(smallest / r, 1.5));
  return result;
}

/// Dot products that steer the minimiser.
struct Work {
  double power = 0, velocity_squared = 0, push_squared = 0, largest_force_squared = 0;
};

} // namespace

double volume(const Container& container)
{
  return std::visit([](const auto& each) { return each.volume(); }, container);
}

NearSpheres make_near_spheres(const SoftSpheres& spheres)
{
  NearSpheres near{0.4 * std::ranges::min(spheres.radius), {}, {}, {}};
  search(near, spheres);
  return near;
}

void refresh(NearSpheres& near, const SoftSpheres& spheres, double gap)
{
  if (largest_approach(spheres, near.reference) + gap <= near.skin)
    return;
  near.skin = std::max(near.skin, 2 * gap);
  search(near, spheres);
}

Compression compression(const SoftSpheres& spheres, NearSpheres& near)
{
  refresh(near, spheres);
  Compression result;
  result.force_sum.assign(spheres.size(), 0.0);
  double relative = 0;
  long n_contacts = 0;
  for_each_contact(
      spheres, near,
      [&](std::size_t i, std::size_t j, double overlap, const Vec3&) {
        const auto& r = spheres.radius;
        result.force_sum[i] += overlap;
        result.force_sum[j] += overlap;
        result.virial += overlap * (r[i] + r[j] - overlap);
        relative += overlap / std::min(r[i], r[j]);
        ++n_contacts;
      },
      [&](std::size_t i, double overlap, const Vec3&) {
        result.force_sum[i] += overlap;
        result.virial += overlap * (spheres.radius[i] - overlap);
      });
  result.mean_overlap = n_contacts > 0 ? relative / double(n_contacts) : 0;
  return result;
}

std::vector<double> gaps_to_neighbour(const SoftSpheres& spheres, NearSpheres& near, int n)
{
  const auto& [container, centre, radius] = spheres;
  refresh(near, spheres, 0.5 * near.skin);
  std::vector<std::vector<double>> gaps(spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (Index k = near.list.start[i]; k < near.list.start[i + 1]; ++k) {
      const Index j = near.list.neighbour[k];
      const double gap = (centre[i] - near.place(spheres, k)).norm() - radius[i] - radius[j];
      gaps[i].push_back(gap);
      gaps[j].push_back(gap);
    }
    for_each_wall(container, centre[i], radius[i],
                  [&](double gap, const Vec3&) { gaps[i].push_back(gap); });
  }
  std::vector<double> result(spheres.size(), near.skin);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (std::ssize(gaps[i]) < n)
      continue;
    std::ranges::nth_element(gaps[i], gaps[i].begin() + (n - 1));
    result[i] = std::min(gaps[i][n - 1], near.skin);
  }
  return result;
}

SoftSpheres relax(SoftSpheres spheres, NearSpheres& near, int n_steps, double tolerance)
{
  const std::size_t n = spheres.size();
  const std::vector<double> mobility = inverse_masses(spheres.radius);
  const double smallest = *std::ranges::min_element(spheres.radius);
  const double largest_move = 0.2 * smallest;
  std::vector<Vec3> velocity(n, Vec3::Zero()), force(n);
  double dt = 0.2, mixing = 0.1;
  int n_downhill = 0;
  for (int step = 0; step < n_steps; ++step) {
    refresh(near, spheres);
    std::ranges::fill(force, Vec3::Zero());
    for_each_contact(
        spheres, near,
        [&](std::size_t i, std::size_t j, double overlap, const Vec3& normal) {
          force[i] += overlap * normal;
          force[j] -= overlap * normal;
        },
        [&](std::size_t i, double overlap, const Vec3& normal) { force[i] += overlap * normal; });

    Work work;
    for (std::size_t i = 0; i < n; ++i) {
      const double squared = force[i].squaredNorm();
      work.power += force[i].dot(velocity[i]);
      work.velocity_squared += velocity[i].squaredNorm();
      work.push_squared += mobility[i] * mobility[i] * squared;
      work.largest_force_squared = std::max(work.largest_force_squared, squared);
    }
    if (work.largest_force_squared < tolerance * tolerance)
      break;
    double keep = 1 - mixing;
    double push = mixing * std::sqrt(work.velocity_squared / work.push_squared);
    if (work.power > 0) {
      if (++n_downhill > 5) {
        dt = std::min(1.1 * dt, 1.0);
        mixing *= 0.99;
      }
    } else {
      n_downhill = 0;
      dt = std::max(0.5 * dt, 0.02);
      mixing = 0.1;
      keep = push = 0;
    }
    for (std::size_t i = 0; i < n; ++i) {
      velocity[i] = keep * velocity[i] + ((push + dt) * mobility[i]) * force[i];
      const double move = dt * velocity[i].norm();
      spheres.centre[i] += (move > largest_move ? largest_move / move * dt : dt) * velocity[i];
    }
  }
  return spheres;
}

namespace {

/// A sphere among fixed neighbours and walls.
struct Cage {
  struct Neighbour {
    Index sphere;
    Vec3 offset; ///< of its image [m]
  };
  const SoftSpheres& spheres;
  std::vector<Neighbour> neighbours;

  /// Calls visit(gap, unit normal towards the sphere) for each neighbour and wall.
  template <typename Visit>
  void for_each_gap(const Vec3& centre, double radius, Visit&& visit) const
  {
    for (const auto& [j, offset] : neighbours) {
      const Vec3 branch = centre - (spheres.centre[j] + offset);
      const double distance = branch.norm();
      visit(distance - radius - spheres.radius[j], Vec3(branch / distance));
    }
    for_each_wall(spheres.container, centre, radius, visit);
  }
};

/// n-th smallest gap of a sphere in its cage [m].
double nth_gap(const Cage& cage, const Vec3& centre, double radius, int n)
{
  std::vector<double> gaps;
  cage.for_each_gap(centre, radius, [&](double gap, const Vec3&) { gaps.push_back(gap); });
  if (std::ssize(gaps) < n)
    return std::numeric_limits<double>::infinity();
  std::ranges::nth_element(gaps, gaps.begin() + (n - 1));
  return gaps[n - 1];
}

using Ball = std::pair<Vec3, double>;

/// The sphere grown and moved until it touches n others; nothing if it is squeezed between fewer,
/// or grows beyond `largest_radius`.
std::optional<Ball> grown_in(const Cage& cage, Ball ball, int n, double gap, double largest_radius)
{
  constexpr int n_growths = 400, n_moves = 200;
  auto& [centre, radius] = ball;
  for (int growth = 0; growth < n_growths && radius < largest_radius; ++growth) {
    double deepest = 0;
    for (int move = 0; move < n_moves; ++move) {
      Vec3 push = Vec3::Zero();
      deepest = 0;
      cage.for_each_gap(centre, radius, [&](double distance, const Vec3& normal) {
        push -= std::min(distance, 0.0) * normal;
        deepest = std::min(deepest, distance);
      });
      if (deepest > -0.1 * gap * radius)
        break;
      centre += 0.7 * push;
    }
    if (deepest <= -0.1 * gap * radius)
      return std::nullopt;
    const double missing = nth_gap(cage, centre, radius, n);
    if (missing < gap * radius)
      return ball;
    radius += std::min(0.5 * missing, 0.02 * radius);
  }
  return std::nullopt;
}

/// The sphere fitted into its cage; if it is squeezed, from a little smaller and to the side.
Ball fitted(const Cage& cage, const Ball& ball, int n, double gap)
{
  const auto& [centre, radius] = ball;
  if (const auto result = grown_in(cage, ball, n, gap, 3 * radius))
    return *result;
  for (const double shrunk : {0.9, 0.8, 0.7, 0.6, 0.5})
    for (int direction = 0; direction < 27; ++direction) {
      const Vec3 side(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
      const Vec3 moved = centre + (1 - shrunk) * radius * side.normalized();
      if (const auto result = grown_in(cage, {moved, shrunk * radius}, n, gap, 1.5 * radius))
        return *result;
    }
  return ball;
}

} // namespace

SoftSpheres fit_floaters(SoftSpheres spheres, NearSpheres& near, int n, double gap)
{
  const std::vector<double> missing_gap = gaps_to_neighbour(spheres, near, n);
  std::vector<std::vector<Cage::Neighbour>> neighbours(spheres.size());
  NearSpheres wide{2 * std::ranges::min(spheres.radius), {}, {}, {}};
  search(wide, spheres);
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (Index k = wide.list.start[i]; k < wide.list.start[i + 1]; ++k) {
      const Index j = wide.list.neighbour[k];
      const Vec3 offset = wide.offset.empty() ? Vec3::Zero() : wide.offset[k];
      neighbours[i].push_back({j, offset});
      if (j != Index(i)) // not its own image, which would move with it
        neighbours[j].push_back({Index(i), -offset});
    }
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (missing_gap[i] > gap * spheres.radius[i])
      std::tie(spheres.centre[i], spheres.radius[i]) = fitted(
          {spheres, std::move(neighbours[i])}, {spheres.centre[i], spheres.radius[i]}, n, gap);
  return spheres;
}

} // namespace dem
