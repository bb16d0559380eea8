#include "fem/elements.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_simplex_p.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_fe.h>
#include <deal.II/fe/mapping_q.h>
#include <deal.II/lac/full_matrix.h>

#include <Eigen/QR>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace fem {

namespace {

constexpr double root_half = std::numbers::sqrt2 / 2;

/// Directions of the components of a displacement among x, y, z: radius and height are x and z.
template <int dim>
constexpr std::array<int, dim> directions()
{
  if constexpr (dim == 3)
    return {0, 1, 2};
  else
    return {0, 2};
}

/// Mandel strain of a displacement gradient and, in a meridian section, of u_r / r.
template <int dim>
Vec6 mandel_strain(const Eigen::Matrix<double, dim, dim>& h, [[maybe_unused]] double hoop)
{
  if constexpr (dim == 3)
    return {h(0, 0),
            h(1, 1),
            h(2, 2),
            root_half * (h(1, 2) + h(2, 1)),
            root_half * (h(0, 2) + h(2, 0)),
            root_half * (h(0, 1) + h(1, 0))};
  else
    return {h(0, 0), hoop, h(1, 1), 0, root_half * (h(0, 1) + h(1, 0)), 0};
}

/// The tensor of a Mandel stress in the directions of a displacement's components.
template <int dim>
Eigen::Matrix<double, dim, dim> stress_tensor(const Vec6& s)
{
  Eigen::Matrix<double, dim, dim> t;
  if constexpr (dim == 3)
    t << s[0], root_half * s[5], root_half * s[4], //
        root_half * s[5], s[1], root_half * s[3],  //
        root_half * s[4], root_half * s[3], s[2];
  else
    t << s[0], root_half * s[4], root_half * s[4], s[2];
  return t;
}

/// Functions 1, x, y, ... up to a degree about the middle of a cell, at its points.
template <int dim>
Eigen::MatrixXd monomials(std::span<const dealii::Point<dim>> points, int degree)
{
  dealii::Point<dim> middle;
  for (const auto& p : points)
    middle += p / double(points.size());
  double size = 0;
  for (const auto& p : points)
    size = std::max(size, p.distance(middle));
  std::vector<Eigen::VectorXd> columns;
  const auto last = dim == 3 ? degree : 0;
  for (int c = 0; c <= last; ++c)
    for (int b = 0; b + c <= degree; ++b)
      for (int a = 0; a + b + c <= degree; ++a) {
        Eigen::VectorXd column(points.size());
        for (std::size_t q = 0; q < points.size(); ++q) {
          const dealii::Tensor<1, dim> x = (points[q] - middle) / size;
          column[Eigen::Index(q)] = std::pow(x[0], a) * std::pow(x[1], b);
          if constexpr (dim == 3)
            column[Eigen::Index(q)] *= std::pow(x[2], c);
        }
        columns.push_back(column);
      }
  Eigen::MatrixXd result(points.size(), columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k)
    result.col(Eigen::Index(k)) = columns[k];
  return result;
}

template <int dim>
double ring(const dealii::Point<dim>& p)
{
  return dim == 3 ? 1 : 2 * std::numbers::pi * p[0];
}

/// The part of a vector of the space that the components of a displacement have.
template <int dim>
dealii::Tensor<1, dim> components(const Vec3& v)
{
  dealii::Tensor<1, dim> result;
  for (int k = 0; k < dim; ++k)
    result[k] = v[directions<dim>()[k]];
  return result;
}

} // namespace

template <int dim>
Elements<dim>::Elements(const Mesh<dim>& mesh, const Discretisation& discretisation)
    : discretisation_(discretisation), cells_(mesh.cells), dofs_(*cells_)
{
  const unsigned order = unsigned(discretisation.order);
  if (order < 1 || order > (mesh.simplices ? 2 : 3))
    throw std::invalid_argument(fmt::format("element order {}: {} have the orders 1 to {}", order,
                                            mesh.simplices ? "simplices" : "hexahedra",
                                            mesh.simplices ? 2 : 3));
  if (mesh.simplices) {
    element_ = std::make_unique<dealii::FESystem<dim>>(dealii::FE_SimplexP<dim>(order), dim);
    mapping_ = std::make_unique<dealii::MappingFE<dim>>(dealii::FE_SimplexP<dim>(order));
    quadrature_ = dealii::QGaussSimplex<dim>(order + 1);
    face_quadrature_ = dealii::QGaussSimplex<dim - 1>(order + 1);
  } else {
    element_ = std::make_unique<dealii::FESystem<dim>>(dealii::FE_Q<dim>(order), dim);
    mapping_ = std::make_unique<dealii::MappingQ<dim>>(order);
    quadrature_ = dealii::QGauss<dim>(order + 1);
    face_quadrature_ = dealii::QGauss<dim - 1>(order + 1);
  }
  dofs_.distribute_dofs(*element_);
  dealii::IndexSet relevant;
  dealii::DoFTools::extract_locally_relevant_dofs(dofs_, relevant);
  layout_of_vectors_ = std::make_shared<const dealii::Utilities::MPI::Partitioner>(
      dofs_.locally_owned_dofs(), relevant, ranks());
  read_reference_shapes();
  read_geometry();
}

template <int dim>
void Elements<dim>::read_reference_shapes()
{
  const dealii::FiniteElement<dim>& scalar = element_->base_element(0);
  const unsigned n_shapes = scalar.n_dofs_per_cell();
  for (const auto& point : quadrature_.get_points()) {
    Shapes gradient(n_shapes, dim);
    Eigen::VectorXd value(n_shapes);
    for (unsigned a = 0; a < n_shapes; ++a) {
      value[a] = scalar.shape_value(a, point);
      const auto g = scalar.shape_grad(a, point);
      for (int k = 0; k < dim; ++k)
        gradient(a, k) = g[k];
    }
    reference_gradients_.push_back(gradient);
    shape_values_.push_back(value);
  }
  for (unsigned i = 0; i < element_->n_dofs_per_cell(); ++i) {
    const auto [component, shape] = element_->system_to_component_index(i);
    layout_.push_back({int(component), int(shape)});
  }
}

template <int dim>
void Elements<dim>::read_geometry()
{
  dealii::FEValues<dim> values(*mapping_, *element_, quadrature_,
                               dealii::update_inverse_jacobians | dealii::update_jacobians |
                                   dealii::update_JxW_values | dealii::update_quadrature_points);
  const auto& partitioner = *layout_of_vectors_;
  std::string inverted;
  for (const auto& cell : dofs_.active_cell_iterators()) {
    if (!cell->is_locally_owned())
      continue;
    values.reinit(cell);
    cell_dofs_.emplace_back(element_->n_dofs_per_cell());
    cell->get_dof_indices(cell_dofs_.back());
    for (const auto dof : cell_dofs_.back())
      local_dofs_.push_back(partitioner.global_to_local(dof));
    for (unsigned q = 0; q < quadrature_.size(); ++q) {
      Eigen::Matrix<double, dim, dim> inverse;
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          inverse(i, j) = values.inverse_jacobian(q)[i][j];
      if (!(values.jacobian(q).determinant() > 0) && inverted.empty())
        inverted =
            fmt::format("the cell at ({:.4g}) m is inverted or folded: its volume element "
                        "is not positive everywhere",
                        fmt::join(cell->center().begin_raw(), cell->center().end_raw(), ", "));
      const auto& point = values.quadrature_point(q);
      inverse_jacobians_.push_back(inverse);
      weights_.push_back(values.JxW(q) * ring(point));
      if (dim == 2)
        radii_.push_back(point[0]);
    }
    if (inverted.empty() && discretisation_.dilatation == Dilatation::projected)
      read_dilatation_basis(n_cells() - 1, values.get_quadrature_points());
  }
  const auto all = dealii::Utilities::MPI::all_gather(ranks(), inverted);
  for (const std::string& each : all)
    if (!each.empty())
      throw std::invalid_argument(each);
}

/// Orthonormal over the volume of the cell.
template <int dim>
void Elements<dim>::read_dilatation_basis(std::size_t cell,
                                          std::span<const dealii::Point<dim>> points)
{
  const bool simplex = element_->reference_cell().is_simplex();
  const auto n = Eigen::Index(points.size());
  const Eigen::MatrixXd functions = monomials(points, simplex ? 0 : discretisation_.order - 1);
  const Eigen::VectorXd root =
      Eigen::Map<const Eigen::VectorXd>(&weights_[cell * points.size()], n).cwiseSqrt();
  const Eigen::MatrixXd q =
      Eigen::HouseholderQR<Eigen::MatrixXd>(root.asDiagonal() * functions).householderQ() *
      Eigen::MatrixXd::Identity(n, functions.cols());
  const Eigen::MatrixXd basis = root.cwiseInverse().asDiagonal() * q;
  n_dilatation_ = std::size_t(basis.cols());
  dilatation_bases_.insert(dilatation_bases_.end(), basis.data(), basis.data() + basis.size());
}

template <int dim>
Vector Elements<dim>::zero() const
{
  return Vector(layout_of_vectors_);
}

template <int dim>
std::vector<dealii::types::material_id> Elements<dim>::regions() const
{
  std::vector<dealii::types::material_id> result;
  for (const auto& cell : dofs_.active_cell_iterators())
    if (cell->is_locally_owned())
      result.insert(result.end(), quadrature_.size(), cell->material_id());
  return result;
}

template <int dim>
typename Elements<dim>::Shapes Elements<dim>::gradients(std::size_t cell, std::size_t point) const
{
  return reference_gradients_[point] * inverse_jacobians_[cell * points_per_cell() + point];
}

template <int dim>
Eigen::Map<const Eigen::MatrixXd> Elements<dim>::dilatation_basis(std::size_t cell) const
{
  return {&dilatation_bases_[cell * points_per_cell() * n_dilatation_],
          Eigen::Index(points_per_cell()), Eigen::Index(n_dilatation_)};
}

/// Values at the points of a cell become those of their projection.
template <int dim>
void Elements<dim>::project_dilatation(std::size_t cell, Eigen::VectorXd& values) const
{
  const auto basis = dilatation_basis(cell);
  const Eigen::Map<const Eigen::VectorXd> w(&weights_[cell * points_per_cell()],
                                            Eigen::Index(points_per_cell()));
  values = basis * (basis.transpose() * w.cwiseProduct(values)).eval();
}

template <int dim>
void Elements<dim>::strains(const Vector& displacement, std::span<Vec6> strain) const
{
  const std::size_t n_dofs = layout_.size(), n_q = points_per_cell();
  Nodal u(dim, n_dofs / dim);
  Eigen::VectorXd dilatation(n_q), projected(n_q);
  for (std::size_t cell = 0; cell < n_cells(); ++cell) {
    for (std::size_t i = 0; i < n_dofs; ++i)
      u(layout_[i][0], layout_[i][1]) = displacement.local_element(local_dofs_[cell * n_dofs + i]);
    Vec6* const at = &strain[cell * n_q];
    for (std::size_t q = 0; q < n_q; ++q) {
      Eigen::Matrix<double, dim, dim> h;
      h.noalias() = u * reference_gradients_[q];
      h = (h * inverse_jacobians_[cell * n_q + q]).eval();
      const double hoop = dim == 2 ? u.row(0).dot(shape_values_[q]) / radii_[cell * n_q + q] : 0.;
      at[q] = mandel_strain<dim>(h, hoop);
      dilatation[Eigen::Index(q)] = at[q].template head<3>().sum();
    }
    if (n_dilatation_ == 0)
      continue;
    projected = dilatation;
    project_dilatation(cell, projected);
    for (std::size_t q = 0; q < n_q; ++q)
      at[q].template head<3>().array() +=
          (projected[Eigen::Index(q)] - dilatation[Eigen::Index(q)]) / 3;
  }
}

template <int dim>
Vector Elements<dim>::internal_force(std::span<const Vec6> stress) const
{
  Vector force = zero();
  const std::size_t n_dofs = layout_.size(), n_q = points_per_cell();
  Nodal f(dim, n_dofs / dim);
  Eigen::VectorXd mean(n_q), projected(n_q);
  for (std::size_t cell = 0; cell < n_cells(); ++cell) {
    const Vec6* const at = &stress[cell * n_q];
    for (std::size_t q = 0; q < n_q; ++q)
      mean[Eigen::Index(q)] = at[q].template head<3>().sum() / 3;
    projected = mean;
    if (n_dilatation_ > 0)
      project_dilatation(cell, projected);
    f.setZero();
    for (std::size_t q = 0; q < n_q; ++q) {
      Vec6 effective = at[q];
      effective.head<3>().array() += projected[Eigen::Index(q)] - mean[Eigen::Index(q)];
      const double w = weights_[cell * n_q + q];
      const Eigen::Matrix<double, dim, dim> flux =
          w * stress_tensor<dim>(effective) * inverse_jacobians_[cell * n_q + q].transpose();
      f.noalias() += flux * reference_gradients_[q].transpose();
      if constexpr (dim == 2)
        f.row(0) += w * effective[1] / radii_[cell * n_q + q] * shape_values_[q].transpose();
    }
    for (std::size_t i = 0; i < n_dofs; ++i)
      force.local_element(local_dofs_[cell * n_dofs + i]) += f(layout_[i][0], layout_[i][1]);
  }
  force.compress(dealii::VectorOperation::add);
  return force;
}

template <int dim>
void Elements<dim>::cell_stiffness(std::size_t cell, std::span<const Mat6> tangent,
                                   std::span<const int> which,
                                   dealii::FullMatrix<double>& stiffness) const
{
  const std::size_t n_dofs = layout_.size(), n_q = points_per_cell();
  Eigen::MatrixXd b(6 * n_q, n_dofs), cb(6 * n_q, n_dofs), divergence(n_q, n_dofs);
  for (std::size_t q = 0; q < n_q; ++q) {
    const Shapes g = gradients(cell, q);
    for (std::size_t i = 0; i < n_dofs; ++i) {
      const auto [component, shape] = layout_[i];
      Eigen::Matrix<double, dim, dim> h = Eigen::Matrix<double, dim, dim>::Zero();
      h.row(component) = g.row(shape);
      const double hoop =
          dim == 2 && component == 0 ? shape_values_[q][shape] / radii_[cell * n_q + q] : 0.;
      const Vec6 strain = mandel_strain<dim>(h, hoop);
      b.template block<6, 1>(6 * q, i) = strain;
      divergence(q, i) = strain.head<3>().sum();
    }
  }
  if (n_dilatation_ > 0) {
    const auto basis = dilatation_basis(cell);
    const Eigen::Map<const Eigen::VectorXd> w(&weights_[cell * n_q], Eigen::Index(n_q));
    const Eigen::MatrixXd change =
        basis * (basis.transpose() * w.asDiagonal() * divergence).eval() - divergence;
    for (std::size_t q = 0; q < n_q; ++q)
      for (int k = 0; k < 3; ++k)
        b.row(6 * q + k) += change.row(q) / 3;
  }
  for (std::size_t q = 0; q < n_q; ++q) {
    const std::size_t point = cell * n_q + q;
    const Mat6& c = tangent[which.empty() ? (tangent.size() > 1 ? point : 0) : which[point]];
    cb.middleRows(6 * q, 6).noalias() = (weights_[point] * c) * b.middleRows(6 * q, 6);
  }
  const Eigen::MatrixXd k = b.transpose() * cb;
  stiffness.reinit(unsigned(n_dofs), unsigned(n_dofs));
  for (std::size_t i = 0; i < n_dofs; ++i)
    for (std::size_t j = 0; j < n_dofs; ++j)
      stiffness(unsigned(i), unsigned(j)) = k(i, j);
}

template <int dim>
void Elements<dim>::add_surface_load(dealii::types::boundary_id boundary, const Vec3& traction,
                                     double pressure, Vector& force) const
{
  dealii::FEFaceValues<dim> values(*mapping_, *element_, face_quadrature_,
                                   dealii::update_values | dealii::update_JxW_values |
                                       dealii::update_normal_vectors |
                                       dealii::update_quadrature_points);
  std::vector<dealii::types::global_dof_index> dofs(element_->n_dofs_per_cell());
  for (const auto& cell : dofs_.active_cell_iterators())
    if (cell->is_locally_owned())
      for (const auto f : cell->face_indices())
        if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() == boundary) {
          values.reinit(cell, f);
          cell->get_dof_indices(dofs);
          for (unsigned q = 0; q < values.n_quadrature_points; ++q) {
            const dealii::Tensor<1, dim> load =
                components<dim>(traction) - pressure * values.normal_vector(q);
            const double area = values.JxW(q) * ring(values.quadrature_point(q));
            for (unsigned i = 0; i < dofs.size(); ++i)
              force(dofs[i]) += values.shape_value(i, q) * load[layout_[i][0]] * area;
          }
        }
  force.compress(dealii::VectorOperation::add);
}

template <int dim>
void Elements<dim>::add_body_force(const Vec3& force_density, Vector& force) const
{
  const dealii::Tensor<1, dim> load = components<dim>(force_density);
  const std::size_t n_dofs = layout_.size(), n_q = points_per_cell();
  for (std::size_t cell = 0; cell < n_cells(); ++cell)
    for (std::size_t i = 0; i < n_dofs; ++i) {
      double sum = 0;
      for (std::size_t q = 0; q < n_q; ++q)
        sum += weights_[cell * n_q + q] * shape_values_[q][layout_[i][1]];
      force.local_element(local_dofs_[cell * n_dofs + i]) += sum * load[layout_[i][0]];
    }
  force.compress(dealii::VectorOperation::add);
}

template <int dim>
double Elements<dim>::boundary_area(dealii::types::boundary_id boundary) const
{
  dealii::FEFaceValues<dim> values(*mapping_, *element_, face_quadrature_,
                                   dealii::update_JxW_values | dealii::update_quadrature_points);
  double area = 0;
  for (const auto& cell : dofs_.active_cell_iterators())
    if (cell->is_locally_owned())
      for (const auto f : cell->face_indices())
        if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() == boundary) {
          values.reinit(cell, f);
          for (unsigned q = 0; q < values.n_quadrature_points; ++q)
            area += values.JxW(q) * ring(values.quadrature_point(q));
        }
  return dealii::Utilities::MPI::sum(area, ranks());
}

template <int dim>
double Elements<dim>::volume() const
{
  double sum = 0;
  for (const double w : weights_)
    sum += w;
  return dealii::Utilities::MPI::sum(sum, ranks());
}

template <int dim>
std::map<dealii::types::global_dof_index, dealii::Point<dim>>
support_points(const Elements<dim>& elements)
{
  std::map<dealii::types::global_dof_index, dealii::Point<dim>> points;
  dealii::DoFTools::map_dofs_to_support_points(elements.mapping(), elements.dofs(), points);
  return points;
}

template class Elements<2>;
template class Elements<3>;
template std::map<dealii::types::global_dof_index, dealii::Point<2>>
support_points(const Elements<2>&);
template std::map<dealii::types::global_dof_index, dealii::Point<3>>
support_points(const Elements<3>&);

} // namespace fem
