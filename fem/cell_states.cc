#include "fem/cell_states.h"

#include <deal.II/grid/cell_id.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <unordered_map>

namespace fem {

namespace {

/// Numbers for the state of a point: as many as the rank needs whose points need most.
template <int dim>
std::size_t room_per_point(const Elements<dim>& elements, const MaterialPoints& points)
{
  const auto own = std::uint64_t(points.numbers_per_point());
  return std::size_t(dealii::Utilities::MPI::max(own, elements.ranks()));
}

} // namespace

template <int dim>
std::vector<std::vector<double>> cell_states(const Specimen<dim>& specimen,
                                             const MaterialPoints& points)
{
  const Elements<dim>& elements = specimen.elements();
  const std::size_t n_q = elements.points_per_cell(), n = room_per_point(elements, points);
  std::vector<std::vector<double>> states(elements.n_cells());
  for (std::size_t cell = 0; cell < elements.n_cells(); ++cell) {
    for (const auto dof : elements.cell_dofs(cell))
      states[cell].push_back(specimen.displacement()(dof));
    const std::size_t n_dofs = states[cell].size();
    states[cell].resize(n_dofs + n_q * n);
    for (std::size_t q = 0; q < n_q; ++q)
      points.store(cell * n_q + q, std::span(states[cell]).subspan(n_dofs + q * n, n));
  }
  return states;
}

template <int dim>
void restore_cell_states(Specimen<dim>& specimen, MaterialPoints& points,
                         const std::vector<std::vector<double>>& states, double drive_displacement)
{
  const Elements<dim>& elements = specimen.elements();
  const std::size_t n_q = elements.points_per_cell(), n = room_per_point(elements, points);
  Vector displacement = elements.zero();
  for (std::size_t cell = 0; cell < elements.n_cells(); ++cell) {
    const auto& dofs = elements.cell_dofs(cell);
    if (states[cell].size() != dofs.size() + n_q * n)
      throw std::invalid_argument("the stored states belong to other elements or laws");
    for (std::size_t i = 0; i < dofs.size(); ++i)
      if (displacement.in_local_range(dofs[i]))
        displacement(dofs[i]) = states[cell][i];
    for (std::size_t q = 0; q < n_q; ++q)
      points.restore(cell * n_q + q, std::span(states[cell]).subspan(dofs.size() + q * n, n));
  }
  specimen.set_displacement(displacement, drive_displacement);
}

template <int dim>
StoredCells gathered(const Mesh<dim>& mesh, std::vector<std::vector<double>> states)
{
  StoredCells own;
  own.states = std::move(states);
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned())
      own.names.push_back(cell->id().to_string());
  const MPI_Comm ranks = mesh.cells->get_communicator();
  const auto all_names = dealii::Utilities::MPI::gather(ranks, own.names);
  const auto all_states = dealii::Utilities::MPI::gather(ranks, own.states);
  StoredCells all;
  for (std::size_t rank = 0; rank < all_names.size(); ++rank) {
    all.names.insert(all.names.end(), all_names[rank].begin(), all_names[rank].end());
    all.states.insert(all.states.end(), all_states[rank].begin(), all_states[rank].end());
  }
  return all;
}

template <int dim>
void refine_to(const Mesh<dim>& mesh, const std::vector<std::string>& names)
{
  std::set<std::string> refined; // all ancestors of the stored cells
  for (const std::string& name : names) {
    const dealii::CellId id(name);
    const auto children = id.get_child_indices();
    for (std::size_t depth = 0; depth < children.size(); ++depth) {
      std::vector<std::uint8_t> above(children.begin(), children.begin() + long(depth));
      refined.insert(dealii::CellId(id.get_coarse_cell_id(), above).to_string());
    }
  }
  const MPI_Comm ranks = mesh.cells->get_communicator();
  while (true) {
    int n_flags = 0;
    for (const auto& cell : mesh.cells->active_cell_iterators())
      if (cell->is_locally_owned() && refined.contains(cell->id().to_string())) {
        cell->set_refine_flag();
        ++n_flags;
      }
    if (dealii::Utilities::MPI::sum(n_flags, ranks) == 0)
      break;
    mesh.cells->execute_coarsening_and_refinement();
  }
  if (mesh.cells->n_global_active_cells() != names.size())
    throw std::invalid_argument("the stored cells are not those of this mesh");
}

template <int dim>
std::vector<std::vector<double>> own_states(const Mesh<dim>& mesh, const StoredCells& cells)
{
  std::unordered_map<std::string, std::size_t> place;
  for (std::size_t k = 0; k < cells.names.size(); ++k)
    place[cells.names[k]] = k;
  std::vector<std::vector<double>> states;
  for (const auto& cell : mesh.cells->active_cell_iterators())
    if (cell->is_locally_owned()) {
      const auto found = place.find(cell->id().to_string());
      if (found == place.end())
        throw std::invalid_argument(
            fmt::format("there is no stored state of cell {}", cell->id().to_string()));
      states.push_back(cells.states[found->second]);
    }
  return states;
}

template std::vector<std::vector<double>> cell_states(const Specimen<2>&, const MaterialPoints&);
template std::vector<std::vector<double>> cell_states(const Specimen<3>&, const MaterialPoints&);
template void restore_cell_states(Specimen<2>&, MaterialPoints&,
                                  const std::vector<std::vector<double>>&, double);
template void restore_cell_states(Specimen<3>&, MaterialPoints&,
                                  const std::vector<std::vector<double>>&, double);
template StoredCells gathered(const Mesh<2>&, std::vector<std::vector<double>>);
template StoredCells gathered(const Mesh<3>&, std::vector<std::vector<double>>);
template void refine_to(const Mesh<2>&, const std::vector<std::string>&);
template void refine_to(const Mesh<3>&, const std::vector<std::string>&);
template std::vector<std::vector<double>> own_states(const Mesh<2>&, const StoredCells&);
template std::vector<std::vector<double>> own_states(const Mesh<3>&, const StoredCells&);

} // namespace fem
