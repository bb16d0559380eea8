#pragma once
#include "fem/discretisation.h"
#include "fem/mesh.h"

#include <deal.II/base/quadrature.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <span>

namespace fem {

/// One number per unknown, shared out over the ranks, with those of the neighbours.
using Vector = dealii::LinearAlgebra::distributed::Vector<double>;

/// What the elements of a rank compute: strains of displacements, forces of stresses, stiffnesses
/// of tangents. Points are counted cell by cell. Small strains; in a meridian section (dim = 2) the
/// components are radius and height, volumes are those of the whole ring.
template <int dim>
class Elements {
public:
  /// \throws std::invalid_argument for an order that is not there, or a cell that is inverted or
  ///         so distorted that its volume element is not positive, with its place
  Elements(const Mesh<dim>& mesh, const Discretisation& discretisation);

  const dealii::DoFHandler<dim>& dofs() const { return dofs_; }
  const dealii::Mapping<dim>& mapping() const { return *mapping_; }
  const dealii::Quadrature<dim>& quadrature() const { return quadrature_; }
  const Discretisation& discretisation() const { return discretisation_; }
  MPI_Comm ranks() const { return dofs_.get_communicator(); }

  /// A vector of zeros with the unknowns of the neighbours.
  Vector zero() const;

  std::size_t n_cells() const { return cell_dofs_.size(); }
  std::size_t points_per_cell() const { return quadrature_.size(); }
  std::size_t n_points() const { return n_cells() * points_per_cell(); }

  /// Volume of each point [m^3].
  std::span<const double> weights() const { return weights_; }

  /// Region of each point.
  std::vector<dealii::types::material_id> regions() const;

  /// Strain at all points; the vector's neighbours must be up to date.
  void strains(const Vector& displacement, std::span<Vec6> strain) const;

  /// Forces on the unknowns that stresses at all points exert [N].
  Vector internal_force(std::span<const Vec6> stress) const;

  /// Stiffness of a cell, and its unknowns. `tangent` and `which` as in ConstitutiveAnswer.
  void cell_stiffness(std::size_t cell, std::span<const Mat6> tangent, std::span<const int> which,
                      dealii::FullMatrix<double>& stiffness) const;
  const std::vector<dealii::types::global_dof_index>& cell_dofs(std::size_t cell) const
  {
    return cell_dofs_[cell];
  }

  /// Force of a traction, and of a pressure, on a boundary [N].
  void add_surface_load(dealii::types::boundary_id boundary, const Vec3& traction, double pressure,
                        Vector& force) const;

  /// Force of a body force per volume [N/m^3].
  void add_body_force(const Vec3& force_density, Vector& force) const;

  /// Area of a boundary [m^2].
  double boundary_area(dealii::types::boundary_id boundary) const;

  /// Volume of the body [m^3].
  double volume() const;

private:
  static constexpr int most_shapes = dim == 3 ? 64 : 16; ///< of a cell of order 3
  using Shapes = Eigen::Matrix<double, Eigen::Dynamic, dim, 0, most_shapes, dim>;
  using Nodal = Eigen::Matrix<double, dim, Eigen::Dynamic, 0, dim, most_shapes>;

  void read_reference_shapes();
  void read_geometry();
  void read_dilatation_basis(std::size_t cell, std::span<const dealii::Point<dim>> points);
  Shapes gradients(std::size_t cell, std::size_t point) const;
  Eigen::Map<const Eigen::MatrixXd> dilatation_basis(std::size_t cell) const;
  void project_dilatation(std::size_t cell, Eigen::VectorXd& values) const;

  Discretisation discretisation_;
  std::shared_ptr<const dealii::Triangulation<dim>> cells_; ///< lives as long as its unknowns
  dealii::DoFHandler<dim> dofs_;
  std::unique_ptr<dealii::Mapping<dim>> mapping_;
  std::unique_ptr<dealii::FiniteElement<dim>> element_;
  dealii::Quadrature<dim> quadrature_;
  std::shared_ptr<const dealii::Utilities::MPI::Partitioner> layout_of_vectors_;
  dealii::Quadrature<dim - 1> face_quadrature_;

  std::vector<Shapes> reference_gradients_;   ///< per point: shape functions by directions
  std::vector<Eigen::VectorXd> shape_values_; ///< per point
  std::vector<std::array<int, 2>> layout_;    ///< component and shape function of a cell's unknown
  std::vector<std::vector<dealii::types::global_dof_index>> cell_dofs_;
  std::vector<unsigned> local_dofs_; ///< position in vectors of this rank, cell by cell
  std::vector<Eigen::Matrix<double, dim, dim>> inverse_jacobians_; ///< per point
  std::vector<double> weights_;                                    ///< per point [m^3]
  std::vector<double> radii_;                                      ///< per point, dim = 2 [m]
  std::vector<double> dilatation_bases_; ///< orthonormal functions at the points of each cell
  std::size_t n_dilatation_ = 0;         ///< their number
};

/// Position of all unknowns of a rank and its neighbours.
template <int dim>
std::map<dealii::types::global_dof_index, dealii::Point<dim>>
support_points(const Elements<dim>& elements);

} // namespace fem
