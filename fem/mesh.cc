#include "fem/mesh.h"

#include "fem/mesh_parts.h"

#include <deal.II/distributed/fully_distributed_tria.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria_description.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <stdexcept>

namespace fem {

namespace {

/// Shares hexahedra out; adaptive refinement is possible.
template <int dim>
std::shared_ptr<dealii::parallel::TriangulationBase<dim>>
shared_out(MPI_Comm ranks, const dealii::Triangulation<dim>& whole, int n_refinements)
{
  auto cells = std::make_shared<dealii::parallel::distributed::Triangulation<dim>>(ranks);
  cells->copy_triangulation(whole);
  cells->refine_global(unsigned(n_refinements));
  return cells;
}

/// Shares simplices out, which p4est does not know.
template <int dim>
std::shared_ptr<dealii::parallel::TriangulationBase<dim>>
simplices_shared_out(MPI_Comm ranks, dealii::Triangulation<dim>& whole, int n_refinements)
{
  whole.refine_global(unsigned(n_refinements));
  const unsigned n_ranks = dealii::Utilities::MPI::n_mpi_processes(ranks);
  if (n_ranks > 1)
    dealii::GridTools::partition_triangulation_zorder(n_ranks, whole);
  const auto description =
      dealii::TriangulationDescription::Utilities::create_description_from_triangulation(whole,
                                                                                         ranks);
  auto cells = std::make_shared<dealii::parallel::fullydistributed::Triangulation<dim>>(ranks);
  for (const auto id : whole.get_manifold_ids())
    if (id != dealii::numbers::flat_manifold_id)
      cells->set_manifold(id, whole.get_manifold(id));
  cells->create_triangulation(description);
  return cells;
}

} // namespace

template <int dim>
Mesh<dim> distributed(MPI_Comm ranks, dealii::Triangulation<dim>& whole, const Fineness& fineness,
                      std::map<std::string, dealii::types::boundary_id> boundaries)
{
  Mesh<dim> mesh;
  mesh.boundaries = std::move(boundaries);
  mesh.simplices = whole.all_reference_cells_are_simplex();
  mesh.cells = mesh.simplices ? simplices_shared_out(ranks, whole, fineness.n_refinements)
                              : shared_out(ranks, whole, fineness.n_refinements);
  return mesh;
}

template <int dim>
dealii::types::boundary_id boundary_id(const Mesh<dim>& mesh, const std::string& name)
{
  if (const auto found = mesh.boundaries.find(name); found != mesh.boundaries.end())
    return found->second;
  std::vector<std::string> names;
  for (const auto& known : mesh.boundaries)
    names.push_back(known.first);
  throw std::invalid_argument(fmt::format("the body has no boundary '{}'; its boundaries are: {}",
                                          name, fmt::join(names, ", ")));
}

template <int dim>
std::pair<dealii::Point<dim>, dealii::Point<dim>> extent(const Mesh<dim>& mesh)
{
  dealii::Point<dim> low, high;
  for (int k = 0; k < dim; ++k) {
    low[k] = std::numeric_limits<double>::max();
    high[k] = std::numeric_limits<double>::lowest();
  }
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned())
      for (const auto v : cell->vertex_indices())
        for (int k = 0; k < dim; ++k) {
          low[k] = std::min(low[k], cell->vertex(v)[k]);
          high[k] = std::max(high[k], cell->vertex(v)[k]);
        }
  const MPI_Comm ranks = mesh.cells->get_communicator();
  for (int k = 0; k < dim; ++k) {
    low[k] = dealii::Utilities::MPI::min(low[k], ranks);
    high[k] = dealii::Utilities::MPI::max(high[k], ranks);
  }
  return {low, high};
}

template Mesh<2> distributed(MPI_Comm, dealii::Triangulation<2>&, const Fineness&,
                             std::map<std::string, dealii::types::boundary_id>);
template Mesh<3> distributed(MPI_Comm, dealii::Triangulation<3>&, const Fineness&,
                             std::map<std::string, dealii::types::boundary_id>);
template dealii::types::boundary_id boundary_id(const Mesh<2>&, const std::string&);
template dealii::types::boundary_id boundary_id(const Mesh<3>&, const std::string&);
template std::pair<dealii::Point<2>, dealii::Point<2>> extent(const Mesh<2>&);
template std::pair<dealii::Point<3>, dealii::Point<3>> extent(const Mesh<3>&);

} // namespace fem
