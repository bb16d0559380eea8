#pragma once
#include "fem/types.h"

#include <deal.II/distributed/tria_base.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fem {

/// A mesh over the ranks of a communicator, with the names of its parts. dim = 2 is the meridian
/// section (radius, height) of a body of revolution.
template <int dim>
struct Mesh {
  std::shared_ptr<dealii::parallel::TriangulationBase<dim>> cells;
  std::map<std::string, dealii::types::boundary_id> boundaries;
  std::map<std::string, dealii::types::material_id> regions; ///< empty: one without a name
  bool simplices = false;                                    ///< triangles or tetrahedra
};

/// How fine a generated mesh is.
struct Fineness {
  double cell_size;      ///< wanted, of the coarse mesh [m]; met from below where it can be
  int n_refinements = 0; ///< halvings of all cells of the coarse mesh
  bool simplices = false;
};

/// Box with one corner at the origin. Boundaries: left, right (x), front, back (y), bottom, top
/// (z).
Mesh<3> box(MPI_Comm ranks, const Vec3& edges, const Fineness& fineness);

/// Cylinder about the z axis from z = 0. Boundaries: bottom, top, side.
Mesh<3> cylinder(MPI_Comm ranks, double diameter, double height, const Fineness& fineness);

/// Hollow cylinder about the z axis from z = 0. Boundaries: bottom, top, side, inner.
Mesh<3> hollow_cylinder(MPI_Comm ranks, double outer_diameter, double inner_diameter, double height,
                        const Fineness& fineness);

/// Disc on its rim, about the y axis, with two loading strips of a width at its lowest and highest
/// place. Its lowest point is at z = 0. Boundaries: bottom and top (the strips), rim, front, back.
Mesh<3> strip_loaded_disc(MPI_Comm ranks, double diameter, double thickness, double strip_width,
                          const Fineness& fineness);

/// One eighth of a hollow sphere about the origin. Boundaries: inner, side, and the planes of
/// symmetry left (x), front (y), bottom (z).
Mesh<3> hollow_sphere(MPI_Comm ranks, double outer_diameter, double inner_diameter,
                      const Fineness& fineness);

/// Meridian section of a (hollow) cylinder; an inner diameter of 0 is a full one. Boundaries:
/// bottom, top, side, and axis or inner.
Mesh<2> meridian(MPI_Comm ranks, double outer_diameter, double inner_diameter, double height,
                 const Fineness& fineness);

/// A mesh of hexahedra or of tetrahedra (dim 2: quadrilaterals or triangles) from a Gmsh file
/// (.msh, format 4.1 or 2.2, text). Names of boundaries and regions are those of its
/// physical groups, or their numbers where they have no name.
/// \param scale  metres per unit of the file
/// \throws std::invalid_argument for a file that cannot be read, without cells, or with cells of
///         several kinds
template <int dim>
Mesh<dim> gmsh_mesh(MPI_Comm ranks, const std::filesystem::path& file, double scale,
                    int n_refinements);

/// The number of a boundary.
/// \throws std::invalid_argument naming those that there are
template <int dim>
dealii::types::boundary_id boundary_id(const Mesh<dim>& mesh, const std::string& name);

/// Lowest and highest coordinates of the mesh [m].
template <int dim>
std::pair<dealii::Point<dim>, dealii::Point<dim>> extent(const Mesh<dim>& mesh);

} // namespace fem
