#pragma once
#include "fem/specimen.h"

#include <functional>

namespace fem {

/// Everything that happened to the cells of a rank: for each cell its displacements, then the
/// states of its points, as numbers.
template <int dim>
std::vector<std::vector<double>> cell_states(const Specimen<dim>& specimen,
                                             const MaterialPoints& points);

/// The inverse, on the same cells of this or another number of ranks.
/// \param drive_displacement  of the specimen
template <int dim>
void restore_cell_states(Specimen<dim>& specimen, MaterialPoints& points,
                         const std::vector<std::vector<double>>& states, double drive_displacement);

/// The cells of a mesh with their states, independent of ranks: each cell is named by its place in
/// the tree of refinements.
struct StoredCells {
  std::vector<std::string> names;
  std::vector<std::vector<double>> states;
};

/// All cells on the first rank; nothing on the others.
template <int dim>
StoredCells gathered(const Mesh<dim>& mesh, std::vector<std::vector<double>> states);

/// Refines a mesh as it comes from its generator until it has the stored cells.
/// \throws std::invalid_argument if they are not cells of this mesh
template <int dim>
void refine_to(const Mesh<dim>& mesh, const std::vector<std::string>& names);

/// The states of the cells of this rank.
/// \throws std::invalid_argument if a cell is not among the stored ones
template <int dim>
std::vector<std::vector<double>> own_states(const Mesh<dim>& mesh, const StoredCells& cells);

} // namespace fem
