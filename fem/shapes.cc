#include "fem/mesh.h"
#include "fem/mesh_parts.h"

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace fem {

namespace {

using Flat = dealii::Triangulation<2>;
using Solid = dealii::Triangulation<3>;
using Names = std::map<std::string, dealii::types::boundary_id>;

constexpr double near = 1e-9; ///< over the size of the body

/// Numbers of cells that are not larger than wanted.
unsigned cells_along(double length, double cell_size)
{
  return unsigned(std::max(1., std::ceil(length / cell_size * (1 - near))));
}

/// Gives each boundary face the number that a function finds for its centre.
template <int dim>
void name_faces(dealii::Triangulation<dim>& mesh,
                const std::function<dealii::types::boundary_id(const dealii::Point<dim>&)>& id)
{
  for (const auto& face : mesh.active_face_iterators())
    if (face->at_boundary())
      face->set_all_boundary_ids(id(face->center()));
}

/// Splits hexahedra, or quadrilaterals, into simplices if that is wanted.
template <int dim>
Mesh<dim> finished(MPI_Comm ranks, dealii::Triangulation<dim>& whole, const Fineness& fineness,
                   const Names& names)
{
  if (!fineness.simplices)
    return distributed(ranks, whole, fineness, names);
  dealii::Triangulation<dim> split;
  dealii::GridGenerator::convert_hypercube_to_simplex_mesh(whole, split);
  for (const auto id : whole.get_manifold_ids())
    if (id != dealii::numbers::flat_manifold_id)
      split.set_manifold(id, whole.get_manifold(id));
  return distributed(ranks, split, fineness, names);
}

/// A disc about the origin; \return half the angle between neighbours on its rim [rad].
double make_disc(Flat& flat, double radius, double cell_size, int least_halvings)
{
  Flat coarse;
  dealii::GridGenerator::hyper_ball_balanced(coarse, {}, radius);
  const int wanted = int(std::ceil(std::log2(0.5 * radius / cell_size * (1 - near))));
  const int n = std::max(least_halvings, wanted);
  coarse.refine_global(unsigned(std::max(0, n)));
  dealii::GridGenerator::flatten_triangulation(coarse, flat);
  return std::numbers::pi / 8 / (1 << std::max(0, n));
}

/// Extrudes a flat mesh along z from 0.
void extrude(const Flat& flat, double height, double cell_size, Solid& solid)
{
  dealii::GridGenerator::extrude_triangulation(flat, cells_along(height, cell_size) + 1, height,
                                               solid);
}

/// The round faces of a cylinder about z are kept round by refinement.
void round_off(Solid& solid, const std::vector<dealii::types::boundary_id>& round)
{
  for (const auto& face : solid.active_face_iterators())
    if (face->at_boundary() && std::ranges::find(round, face->boundary_id()) != round.end())
      face->set_all_manifold_ids(0);
  solid.set_manifold(0, dealii::CylindricalManifold<3>(2));
}

double axis_distance(const dealii::Point<3>& p)
{
  return std::hypot(p[0], p[1]);
}

/// Moves the vertices near the lowest and highest place (on the y axis) so that two of them on the
/// rim are at an angle from it where vertices were at another.
void fit_strips(Flat& flat, double radius, double from, double to)
{
  dealii::GridTools::transform(
      [&](const dealii::Point<2>& p) {
        const double r = p.norm();
        if (r < near * radius)
          return p;
        const double right_angle = std::numbers::pi / 2;
        const double off = std::atan2(std::abs(p[0]), std::abs(p[1])); // from the y axis
        const double moved = off <= from
                                 ? off * to / from
                                 : to + (off - from) * (right_angle - to) / (right_angle - from);
        const double share = r * r / (radius * radius);
        const double angle = off + share * (moved - off);
        return dealii::Point<2>(std::copysign(r * std::sin(angle), p[0]),
                                std::copysign(r * std::cos(angle), p[1]));
      },
      flat);
}

} // namespace

Mesh<3> box(MPI_Comm ranks, const Vec3& edges, const Fineness& fineness)
{
  Solid solid;
  std::vector<unsigned> cells;
  for (int k = 0; k < 3; ++k)
    cells.push_back(cells_along(edges[k], fineness.cell_size));
  dealii::GridGenerator::subdivided_hyper_rectangle(
      solid, cells, {}, dealii::Point<3>(edges[0], edges[1], edges[2]), true);
  return finished(
      ranks, solid, fineness,
      {{"left", 0}, {"right", 1}, {"front", 2}, {"back", 3}, {"bottom", 4}, {"top", 5}});
}

Mesh<3> cylinder(MPI_Comm ranks, double diameter, double height, const Fineness& fineness)
{
  Flat flat;
  make_disc(flat, diameter / 2, fineness.cell_size, 0);
  Solid solid;
  extrude(flat, height, fineness.cell_size, solid);
  name_faces<3>(solid, [&](const dealii::Point<3>& p) {
    return p[2] < near * height ? 0u : p[2] > (1 - near) * height ? 1u : 2u;
  });
  round_off(solid, {2});
  return finished(ranks, solid, fineness, {{"bottom", 0}, {"top", 1}, {"side", 2}});
}

Mesh<3> hollow_cylinder(MPI_Comm ranks, double outer_diameter, double inner_diameter, double height,
                        const Fineness& fineness)
{
  const double inner = inner_diameter / 2, outer = outer_diameter / 2;
  Flat flat;
  const unsigned around =
      std::max(8u, cells_along(std::numbers::pi * (inner + outer), fineness.cell_size));
  dealii::GridGenerator::concentric_hyper_shells(
      flat, {}, inner, outer, cells_along(outer - inner, fineness.cell_size), 0, around);
  Solid solid;
  extrude(flat, height, fineness.cell_size, solid);
  solid.set_all_manifold_ids(0);
  solid.set_manifold(0, dealii::CylindricalManifold<3>(2));
  name_faces<3>(solid, [&](const dealii::Point<3>& p) {
    if (p[2] < near * height)
      return 0u;
    if (p[2] > (1 - near) * height)
      return 1u;
    return axis_distance(p) > (inner + outer) / 2 ? 2u : 3u;
  });
  return finished(ranks, solid, fineness, {{"bottom", 0}, {"top", 1}, {"side", 2}, {"inner", 3}});
}

Mesh<3> strip_loaded_disc(MPI_Comm ranks, double diameter, double thickness, double strip_width,
                          const Fineness& fineness)
{
  const double radius = diameter / 2;
  Flat flat;
  const double spacing = 2 * make_disc(flat, radius, fineness.cell_size, 2);
  const double half_strip = std::asin(strip_width / diameter);
  const double from = spacing * std::max(1., std::round(half_strip / spacing));
  fit_strips(flat, radius, from, half_strip);
  Solid solid;
  extrude(flat, thickness, fineness.cell_size, solid);
  name_faces<3>(solid, [&](const dealii::Point<3>& p) {
    if (p[2] < near * thickness)
      return 3u;
    if (p[2] > (1 - near) * thickness)
      return 4u;
    const bool strip = std::atan2(std::abs(p[0]), std::abs(p[1])) < half_strip;
    return strip ? (p[1] < 0 ? 0u : 1u) : 2u;
  });
  for (const auto& face : solid.active_face_iterators())
    if (face->at_boundary() && face->boundary_id() < 3)
      face->set_all_manifold_ids(0);
  // (x, y, z) of the extruded mesh becomes (x, -z, y): the axis lies along y, strips up and down
  dealii::GridTools::transform(
      [&](const dealii::Point<3>& p) { return dealii::Point<3>(p[0], -p[2], p[1] + radius); },
      solid);
  solid.set_manifold(0, dealii::CylindricalManifold<3>(dealii::Tensor<1, 3>({0, 1, 0}),
                                                       dealii::Point<3>(0, 0, radius)));
  return finished(ranks, solid, fineness,
                  {{"bottom", 0}, {"top", 1}, {"rim", 2}, {"back", 3}, {"front", 4}});
}

Mesh<3> hollow_sphere(MPI_Comm ranks, double outer_diameter, double inner_diameter,
                      const Fineness& fineness)
{
  const double inner = inner_diameter / 2, outer = outer_diameter / 2;
  Solid solid;
  dealii::GridGenerator::quarter_hyper_shell(solid, {}, inner, outer, 0, true);
  Fineness finer = fineness;
  finer.n_refinements +=
      std::max(0, int(std::ceil(std::log2((outer - inner) / fineness.cell_size * (1 - near)))));
  return finished(ranks, solid, finer,
                  {{"inner", 0}, {"side", 1}, {"left", 2}, {"front", 3}, {"bottom", 4}});
}

Mesh<2> meridian(MPI_Comm ranks, double outer_diameter, double inner_diameter, double height,
                 const Fineness& fineness)
{
  const double inner = inner_diameter / 2, outer = outer_diameter / 2;
  Flat flat;
  dealii::GridGenerator::subdivided_hyper_rectangle(
      flat,
      {cells_along(outer - inner, fineness.cell_size), cells_along(height, fineness.cell_size)},
      dealii::Point<2>(inner, 0), dealii::Point<2>(outer, height), true);
  return finished(ranks, flat, fineness,
                  {{inner > 0 ? "inner" : "axis", 0}, {"side", 1}, {"bottom", 2}, {"top", 3}});
}

} // namespace fem
