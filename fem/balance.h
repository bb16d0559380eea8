#pragma once
#include "fem/mesh.h"

#include <span>
#include <vector>

namespace fem {

/// The largest of some costs over their mean [-]; 1 if nothing costs anything.
double imbalance(std::span<const double> costs);

/// Shares a row of cells out: neighbours in the row stay together, each rank gets at least one
/// cell, and the rank that has the most to do has as little as that allows. \return the rank of
/// each cell \throws std::invalid_argument for less cells than ranks
std::vector<int> ranks_of_row(std::span<const double> costs, int n_ranks);

/// Which rank is to have which cell.
struct Sharing {
  std::vector<int> rank_of_cell; ///< of each cell that this rank has now
  double imbalance;              ///< of the ranks' costs then [-]
};

/// A new sharing of the cells of a mesh: the parts of a curve through their middles that fills
/// space (Hilbert), with costs as equal as can be. The same on all ranks, which all take part.
/// \param costs  of each cell of this rank
/// \throws std::invalid_argument for less cells than ranks
template <int dim>
Sharing new_sharing(const Mesh<dim>& mesh, std::span<const double> costs);

/// Gives the cells of a mesh to other ranks. Its cells are another object then, with the same names
/// of cells and parts, which cannot be refined adaptively any more; bodies on the old ones must be
/// made anew.
/// \param states  of each cell of this rank
/// \return the states of the cells that this rank has now
template <int dim>
std::vector<std::vector<double>> move_cells(Mesh<dim>& mesh, const std::vector<int>& rank_of_cell,
                                            std::vector<std::vector<double>> states);

} // namespace fem
