#include "dem/packing.h"

#include "dem/random.h"
#include "dem/soft_spheres.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <tuple>

namespace dem {

namespace {

/// A request for either.
using Aims = PackingRequestIn<Container>;

Aims aims(const auto& request)
{
  return {request.container,
          request.grading,
          request.n_particles,
          request.solid_fraction,
          request.density,
          request.min_contacts,
          request.contact_gap,
          request.residual_stress_bound,
          request.preparation_stiffness};
}

double size_scale(const Aims& wanted)
{
  const double mean = mean_particle_volume(wanted.grading);
  return std::cbrt(wanted.solid_fraction * volume(wanted.container) /
                   (mean * double(wanted.n_particles)));
}

void require(bool condition, const char* what, double found)
{
  if (!condition)
    throw std::invalid_argument(fmt::format("packing: {}, found {:g}", what, found));
}

void validate(const Cylinder& container, double coarsest)
{
  require(container.radius > 0, "the diameter must be > 0", container.radius);
  require(container.height > 0, "the height must be > 0", container.height);
  require(coarsest < 2 * container.radius && coarsest < container.height,
          "the coarsest sieve must be smaller than the container; sieve in mm", 1e3 * coarsest);
}

void validate(const PeriodicCell& cell, double coarsest)
{
  make_periodic_cell(cell.edges);
  require(coarsest < face_distances(cell).minCoeff(),
          "the coarsest sieve must be smaller than the cell; sieve in mm", 1e3 * coarsest);
}

void validate(const Aims& wanted)
{
  require(wanted.n_particles > 0, "the number of particles must be > 0", 0);
  require(wanted.solid_fraction > 0 && wanted.solid_fraction < 0.9,
          "the solid fraction must lie between 0 and 0.9", wanted.solid_fraction);
  require(wanted.contact_gap > 0 && wanted.contact_gap < 0.1,
          "the contact gap must lie between 0 and 0.1 radii", wanted.contact_gap);
  require(wanted.preparation_stiffness > 0, "the preparation stiffness must be > 0",
          wanted.preparation_stiffness);
  const double coarsest = wanted.grading.sieves.back().opening;
  std::visit([&](const auto& container) { validate(container, coarsest); }, wanted.container);
  const double scale = size_scale(wanted);
  if (std::abs(scale - 1) > 0.05)
    throw std::invalid_argument(fmt::format(
        "packing: {} particles of this grading would need diameters scaled by {:.3f} to fill the "
        "solid fraction {:g}; about {:.0f} particles fit",
        wanted.n_particles, scale, wanted.solid_fraction,
        double(wanted.n_particles) * scale * scale * scale));
}

/// A place for a sphere, even over the container, from three even numbers in (0, 1).
Vec3 place_in(const Cylinder& container, double radius, const Vec3& number)
{
  const double angle = 2 * std::numbers::pi * number[1];
  const double off_axis = (container.radius - radius) * std::sqrt(number[0]);
  return {off_axis * std::cos(angle), off_axis * std::sin(angle),
          radius + (container.height - 2 * radius) * number[2]};
}

Vec3 place_in(const PeriodicCell& cell, double, const Vec3& number)
{
  return cell.edges * number;
}

/// Spheres of the grading, in random order of size, at random places. Numbered along layers of
/// cells, so that near spheres are near in memory.
SoftSpheres scattered(const Aims& request, std::uint64_t seed)
{
  const std::size_t n = request.n_particles;
  const auto number = [&](std::size_t i, std::uint32_t draw) {
    return uniform(seed, RandomStream::packing, i, draw);
  };
  std::vector<double> radius = representative_diameters(request.grading, n);
  for (double& r : radius)
    r *= 0.5 * size_scale(request);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t i) { return number(i, 0); });

  struct Sphere {
    std::tuple<int, int, int> cell;
    Vec3 centre;
    double radius;
  };
  const double cell_size = 2.5 * radius.back();
  std::vector<Sphere> sphere;
  for (std::size_t i = 0; i < n; ++i) {
    const double r = radius[order[i]];
    const Vec3 even(number(i, 1), number(i, 2), number(i, 3));
    const Vec3 centre = std::visit(
        [&](const auto& container) { return place_in(container, r, even); }, request.container);
    const auto cell = [&](double x) { return int(std::floor(x / cell_size)); };
    sphere.push_back({{cell(centre.z()), cell(centre.y()), cell(centre.x())}, centre, r});
  }
  std::ranges::stable_sort(sphere, {}, &Sphere::cell);
  SoftSpheres result{request.container, {}, {}};
  for (const Sphere& each : sphere) {
    result.centre.push_back(each.centre);
    result.radius.push_back(each.radius);
  }
  return result;
}

/// Pressure on each sphere (force sum over squared radius) relative to the mean.
std::vector<double> relative_pressure(const SoftSpheres& spheres, const Compression& pressed)
{
  double force = 0, area = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    force += pressed.force_sum[i];
    area += spheres.radius[i] * spheres.radius[i];
  }
  std::vector<double> result(spheres.size(), 1.0);
  if (force > 0)
    for (std::size_t i = 0; i < spheres.size(); ++i)
      result[i] = pressed.force_sum[i] / (spheres.radius[i] * spheres.radius[i]) * area / force;
  return result;
}

/// Hands the sizes out anew: the order of the spheres by size, after each has moved in it by its
/// pressure (`step` is the change of log radius per relative pressure), takes the sizes in order.
SoftSpheres exchange_sizes(SoftSpheres spheres, NearSpheres& near, double step)
{
  const std::vector<double> pressure = relative_pressure(spheres, compression(spheres, near));
  std::vector<double> wish(spheres.size());
  for (std::size_t i = 0; i < spheres.size(); ++i)
    wish[i] = std::log(spheres.radius[i]) - std::clamp(step * (pressure[i] - 1), -0.1, 0.1);
  std::vector<std::size_t> order(spheres.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return wish[i]; });
  std::vector<double> sizes = spheres.radius;
  std::ranges::sort(sizes);
  for (std::size_t k = 0; k < order.size(); ++k)
    spheres.radius[order[k]] = sizes[k];
  return spheres;
}

double solid_volume(const SoftSpheres& spheres)
{
  double sum = 0;
  for (const double r : spheres.radius)
    sum += sphere_volume(r);
  return sum;
}

/// Floaters grow half-way to contact with the neighbour they miss, by `largest_growth` at most; the
/// other spheres give way to pressure. The solid volume stays.
SoftSpheres breathe(SoftSpheres spheres, NearSpheres& near, const std::vector<double>& missing_gap,
                    double contact_gap, double largest_growth)
{
  const double before = solid_volume(spheres);
  const Compression pressed = compression(spheres, near);
  const std::vector<double> pressure = relative_pressure(spheres, pressed);
  const double give = 0.3 * pressed.mean_overlap;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double missing = missing_gap[i] / spheres.radius[i];
    spheres.radius[i] *=
        1 + (missing > 0.2 * contact_gap ? std::min(0.5 * missing, largest_growth)
                                         : std::clamp(give * (1 - pressure[i]), -3 * give, give));
  }
  const double scale = std::cbrt(before / solid_volume(spheres));
  for (double& r : spheres.radius)
    r *= scale;
  return spheres;
}

SoftSpheres grown(const SoftSpheres& full, NearSpheres& near)
{
  SoftSpheres spheres = full;
  for (const double scale : {0.6, 0.8, 0.9, 0.96, 1.0}) {
    for (std::size_t i = 0; i < spheres.size(); ++i)
      spheres.radius[i] = scale * full.radius[i];
    spheres = relax(std::move(spheres), near, 200, 0);
  }
  return spheres;
}

/// Mean relative overlap at which the exchange of sizes may stop: pressed enough to keep contact.
constexpr double light_compression = 6e-3;

SoftSpheres annealed(SoftSpheres spheres, NearSpheres& near)
{
  constexpr int n_sweeps = 200;
  for (int sweep = 0; sweep < n_sweeps; ++sweep) {
    if (compression(spheres, near).mean_overlap < light_compression)
      break;
    const double step = 0.02 * std::pow(0.15, double(sweep) / n_sweeps);
    spheres = relax(exchange_sizes(std::move(spheres), near, step), near, 50, 0);
  }
  return spheres;
}

double residual_stress(const SoftSpheres& spheres, NearSpheres& near, double stiffness)
{
  return stiffness * compression(spheres, near).virial / (3 * volume(spheres.container));
}

/// One round: relax, and let sizes follow contacts and pressure.
SoftSpheres breathed(SoftSpheres spheres, NearSpheres& near, const Aims& request,
                     double largest_growth)
{
  const std::vector<double> missing_gap = gaps_to_neighbour(spheres, near, request.min_contacts);
  spheres = breathe(std::move(spheres), near, missing_gap, request.contact_gap, largest_growth);
  const double tolerance = 0.1 * request.contact_gap * std::ranges::min(spheres.radius);
  return relax(std::move(spheres), near, 100, tolerance);
}

long count_floaters(const SoftSpheres& spheres, NearSpheres& near, const Aims& request)
{
  const std::vector<double> missing_gap = gaps_to_neighbour(spheres, near, request.min_contacts);
  long n = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    n += missing_gap[i] > request.contact_gap * spheres.radius[i];
  return n;
}

/// Breathes until at most one sphere in two hundred lacks contacts and the stress is low.
SoftSpheres with_contacts(SoftSpheres spheres, NearSpheres& near, const Aims& request)
{
  constexpr int n_rounds = 300;
  for (int round = 0; round < n_rounds; ++round) {
    const double growth = std::max(request.contact_gap, 1e-2 * std::pow(0.1, round / 100.0));
    spheres = breathed(std::move(spheres), near, request, growth);
    if (count_floaters(spheres, near, request) * 200 <= std::ssize(spheres.radius) &&
        residual_stress(spheres, near, request.preparation_stiffness) <
            0.2 * request.residual_stress_bound)
      break;
  }
  return spheres;
}

/// Fits the last floaters; where one is squeezed, the packing is shaken a little and it tries
/// again.
SoftSpheres without_floaters(SoftSpheres spheres, NearSpheres& near, const Aims& request)
{
  constexpr int n_attempts = 100;
  for (int attempt = 0; attempt < n_attempts; ++attempt) {
    for (int sweep = 0; sweep < 2; ++sweep)
      spheres = fit_floaters(std::move(spheres), near, request.min_contacts, request.contact_gap);
    if (count_floaters(spheres, near, request) == 0)
      break;
    if (attempt + 1 < n_attempts)
      spheres = breathed(std::move(spheres), near, request, request.contact_gap);
  }
  return spheres;
}

Particles packed(const Aims& wanted, std::uint64_t seed)
{
  validate(wanted);
  SoftSpheres spheres = scattered(wanted, seed);
  NearSpheres near = make_near_spheres(spheres);
  spheres = grown(spheres, near);
  spheres = annealed(std::move(spheres), near);
  spheres = with_contacts(std::move(spheres), near, wanted);
  spheres = without_floaters(std::move(spheres), near, wanted);
  Particles particles;
  particles.centre = spheres.centre;
  particles.radius = spheres.radius;
  particles.material_class.assign(spheres.size(), 0);
  particles.density = wanted.density;
  return particles;
}

} // namespace

double size_scale(const PackingRequest& request)
{
  return size_scale(aims(request));
}

Particles grow_packing(const PackingRequest& request, std::uint64_t seed)
{
  return packed(aims(request), seed);
}

PeriodicPackingRequest cube_request(const Grading& grading, std::size_t n_particles,
                                    double solid_fraction)
{
  const double solid = mean_particle_volume(grading) * double(n_particles);
  return {box_cell(Vec3::Constant(std::cbrt(solid / solid_fraction))), grading, n_particles,
          solid_fraction};
}

Particles grow_periodic_packing(const PeriodicPackingRequest& request, std::uint64_t seed)
{
  Particles particles = packed(aims(request), seed);
  for (Vec3& centre : particles.centre)
    centre += request.container.translation(shift_into_cell(request.container, centre));
  return particles;
}

} // namespace dem
