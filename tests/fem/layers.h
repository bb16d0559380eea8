#pragma once
#include "bodies.h"
#include "fem/mesh_parts.h"

#include <deal.II/grid/grid_generator.h>

/// Bodies of two regions, numbered 0 and 1.
namespace bodies {

/// Box of edge 1 m with two fifths of its height in region 0, at the bottom.
inline fem::Mesh<3> layered_box(unsigned cells_along = 2, bool simplices = false)
{
  dealii::Triangulation<3> whole, split;
  dealii::GridGenerator::subdivided_hyper_rectangle(
      whole, {cells_along, cells_along, 5}, dealii::Point<3>(), dealii::Point<3>(1, 1, 1), true);
  for (const auto& cell : whole.active_cell_iterators())
    cell->set_material_id(cell->center()[2] < 0.4 ? 0 : 1);
  if (simplices)
    dealii::GridGenerator::convert_hypercube_to_simplex_mesh(whole, split);
  return fem::distributed<3>(
      ranks, simplices ? split : whole, {0, 0, simplices},
      {{"left", 0}, {"right", 1}, {"front", 2}, {"back", 3}, {"bottom", 4}, {"top", 5}});
}

/// The loads of shear in the plane of the layers, driven by the motion of the back.
inline fem::BodyLoads shear_along_layers()
{
  constexpr std::optional<double> loose;
  return {{{"front", {0, 0, loose}},
           {"back", {1, 0, loose}},
           {"left", {loose, 0, loose}},
           {"right", {loose, 0, loose}}},
          {}};
}

} // namespace bodies
