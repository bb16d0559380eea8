#pragma once
#include "fem/elements.h"

#include <deal.II/lac/affine_constraints.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fem {

/// A boundary whose displacement is held: each component free, or what it is per unit of the drive
/// (0: held in place). A rigid platen moved along z is {0, 0, 1}, without friction {free, free, 1}.
struct Support {
  std::string boundary;
  std::array<std::optional<double>, 3> displacement;
};

/// Conditions on the unknowns.
template <int dim>
struct Supports {
  dealii::AffineConstraints<double> constraints; ///< hanging nodes, and zero where held
  Vector drive; ///< displacement per unit of the drive on the held boundaries; zero elsewhere
  bool driven = false;                               ///< whether any of it is not zero
  std::vector<dealii::types::global_dof_index> held; ///< unknowns of this rank that are held
  int n_pins = 0; ///< rigid motions that no support holds, each held at one unknown
};

/// The conditions of a body. Rigid motions that no support holds are held at as many single
/// unknowns; that leaves the strains as they are where the loads balance.
/// \throws std::invalid_argument for a boundary that is not there, or held twice in one component
template <int dim>
Supports<dim> make_supports(const Mesh<dim>& mesh, const Elements<dim>& elements,
                            const std::vector<Support>& supports);

/// Rigid motions of a body at its unknowns: rows are the unknowns of this rank in order, columns
/// the motions: three translations and three rotations about `middle`, scaled to the size of the
/// body; in a meridian section the translation along the axis.
template <int dim>
Eigen::MatrixXd rigid_motions(const Elements<dim>& elements);

} // namespace fem
