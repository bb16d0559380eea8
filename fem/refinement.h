#pragma once
#include "fem/specimen.h"

#include <vector>

namespace fem {

/// Refines the cells of largest error indicator and carries the states over.
///
/// The indicator of a cell is that of Kelly et al. (Int. J. Numer. Meth. Eng. 19, 1983): the jumps
/// of the displacement's normal derivative over its faces, from deal.II. States of the points of a
/// new cell are the polynomial through those of the points of the cell it came from; displacements
/// are the same function as before. The next step restores equilibrium, as it looks at total
/// forces. Cells are not made coarser.
///
/// \param share     of the cells that are refined, 0 to 1
/// \return the states of the cells of this rank on the refined mesh, for restore_cell_states. The
///         specimen must not be used any more: make a new one on the mesh.
/// \throws std::invalid_argument for a mesh of simplices
template <int dim>
std::vector<std::vector<double>> refine(const Mesh<dim>& mesh, const Specimen<dim>& specimen,
                                        const MaterialPoints& points, double share);

} // namespace fem
