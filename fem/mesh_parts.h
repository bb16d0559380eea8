#pragma once
#include "fem/mesh.h"

#include <deal.II/grid/tria.h>

namespace fem {

/// Shares a mesh, the same on all ranks, out over them and refines it as often as wanted.
template <int dim>
Mesh<dim> distributed(MPI_Comm ranks, dealii::Triangulation<dim>& whole, const Fineness& fineness,
                      std::map<std::string, dealii::types::boundary_id> boundaries);

} // namespace fem
