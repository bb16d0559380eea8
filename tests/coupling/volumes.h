#pragma once
#include "coupling/extraction.h"
#include "coupling/volume_points.h"
#include "dem/crystals.h"
#include "fem/law_points.h"
#include "fem/march.h"
#include "tests/dem/elements.h"
#include "tests/fem/bodies.h"

#include <limits>

/// What the tests of bodies made of volume elements share.
namespace volumes {

using namespace coupling;
using fem::Mat6;
using fem::Vec6;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline dem::Strengths weibull(const dem::VolumeElement& element, double scale, double shear_ratio,
                              std::uint64_t seed = 2)
{
  return dem::draw_strengths(
      {dem::WeibullStrength{3, scale}, dem::NonpositiveRule::error, shear_ratio}, element.bonds.id,
      seed);
}

inline VolumeFamily unbreakable(dem::VolumeElement element)
{
  const std::vector<double> endless(element.bonds.size(), infinity);
  return make_family(std::move(element), {endless, endless, 0}, dem::AfterBreakage::leave);
}

inline VolumeFamily random_family(std::size_t n_particles, double scale, dem::AfterBreakage rule,
                                  std::uint64_t seed = 1)
{
  dem::VolumeElement element = elements::random_cube(n_particles, seed);
  dem::Strengths strengths = weibull(element, scale, 0.5);
  return make_family(std::move(element), std::move(strengths), rule);
}

inline fem::ComplianceLaw law_of(const VolumeFamily& family)
{
  return proportional_law(dem::compliance(family.stiffness()), family.element->creep());
}

/// A body all of whose points are volumes.
struct Body {
  fem::Specimen<3> specimen;
  VolumePoints points;
  fem::MarchState state;

  Body(const fem::Mesh<3>& mesh, const fem::BodyLoads& loads, std::vector<VolumeFamily> families,
       const VolumeSettings& settings, int order = 1, double tolerance = 1e-12,
       double size_ratio = 1)
      : specimen(mesh, {order, fem::Dilatation::pointwise}, loads, tolerance),
        points(families, families_of_points(int(families.size())),
               std::vector<double>(specimen.elements().n_points(), size_ratio), settings, 0)
  {
  }

  std::vector<int> families_of_points(int n_families) const
  {
    std::vector<int> result;
    for (std::size_t q = 0; q < specimen.elements().n_points(); ++q)
      result.push_back(int(q) % n_families);
    return result;
  }

  void run_to(const fem::History& history, double end, double tolerance = 1e-5)
  {
    if (state.time == 0 && state.n_steps == 0)
      fem::apply_jump(specimen, points, state, history);
    while (state.time < end)
      fem::march_step(specimen, points, state, history, {tolerance, 1e-2, 3}, end);
  }

  double n_broken() const
  {
    return dealii::Utilities::MPI::sum(double(points.n_broken()), bodies::ranks);
  }
  double n_live() const
  {
    return dealii::Utilities::MPI::sum(double(points.n_live()), bodies::ranks);
  }
};

/// A box pulled or pressed along z without friction.
inline fem::BodyLoads uniaxial()
{
  const std::optional<double> free;
  return {{{"bottom", {free, free, 0.}}, {"top", {free, free, 1.}}}, {}, fem::Vec3::Zero()};
}

inline fem::History constant_force(double force)
{
  const auto load = [force](double) { return fem::LoadState{true, force, 1}; };
  return {load, load, [](double t) { return t; }};
}

inline fem::History constant_speed(double speed)
{
  const auto load = [speed](double t) { return fem::LoadState{false, speed * t, 1}; };
  return {load, load, [](double t) { return t; }};
}

} // namespace volumes
