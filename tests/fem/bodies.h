#pragma once
#include "fem/creep_compliance.h"
#include "fem/law_points.h"
#include "fem/specimen.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

/// What the tests of finite-element bodies share.
namespace bodies {

using fem::Vec3;

inline const MPI_Comm ranks = MPI_COMM_WORLD;

/// A law that is elastic to all purposes: isotropic, of E and nu.
inline fem::ComplianceLaw elastic(double young, double poisson)
{
  return fem::make_compliance_law(fem::isotropic_shape(poisson) / young, fem::Mat6::Zero(), {});
}

/// Shear Burgers with elastic bulk: the material of the continuum tables in reference/.
inline fem::ComplianceLaw burgers_in_shear()
{
  const double gm = 100e6, eta_m = 2e10, gk = 60e6, eta_k = 1.2e9, bulk = 400e6;
  fem::Mat6 volume = fem::Mat6::Zero();
  volume.topLeftCorner<3, 3>().setConstant(1. / 3);
  const fem::Mat6 shape = fem::Mat6::Identity() - volume;
  const fem::RetardationTerm kelvin{eta_k / gk, shape / (2 * gk)};
  return fem::make_compliance_law(shape / (2 * gm) + volume / (3 * bulk), shape / (2 * eta_m),
                                  std::span(&kelvin, 1));
}

/// The law of `burgers_in_shear` with a creep Poisson ratio of 0.3 at all times, E(0) = 200 MPa.
inline fem::ComplianceLaw proportional_burgers()
{
  fem::CreepCompliance uniaxial = fem::burgers_compliance(100e6, 2e10, 60e6, 1.2e9);
  uniaxial.instantaneous /= 2;
  uniaxial.fluidity /= 2;
  uniaxial.parts[0].compliance /= 2;
  return fem::isotropic_law(uniaxial, 0.3);
}

/// Number of the law of each point: the number of its region.
template <int dim>
std::vector<int> laws_by_region(const fem::Elements<dim>& elements)
{
  const auto regions = elements.regions();
  return {regions.begin(), regions.end()};
}

/// A displacement as a function of the place.
template <int dim>
using Field = std::function<dealii::Tensor<1, dim>(const dealii::Point<dim>&)>;

/// Root of the integral over the volume of the squared difference of a displacement from a field,
/// relative to that of the field. In space, rigid motions do not count.
template <int dim>
double l2_error(const fem::Elements<dim>& elements, const fem::Vector& displacement,
                const Field<dim>& exact)
{
  const auto& element = elements.dofs().get_fe();
  const unsigned n = unsigned(elements.discretisation().order) + 3;
  const bool simplices = element.reference_cell().is_simplex();
  const dealii::Quadrature<dim> quadrature =
      simplices ? dealii::Quadrature<dim>(dealii::QGaussSimplex<dim>(std::min(n, 4U)))
                : dealii::Quadrature<dim>(dealii::QGauss<dim>(n));
  dealii::FEValues<dim> values(elements.mapping(), element, quadrature,
                               dealii::update_values | dealii::update_JxW_values |
                                   dealii::update_quadrature_points);
  Eigen::Matrix<double, 8, 8> sums = Eigen::Matrix<double, 8, 8>::Zero();
  std::vector<dealii::Vector<double>> found(quadrature.size(), dealii::Vector<double>(dim));
  for (const auto& cell : elements.dofs().active_cell_iterators()) {
    if (!cell->is_locally_owned())
      continue;
    values.reinit(cell);
    values.get_function_values(displacement, found);
    for (unsigned q = 0; q < quadrature.size(); ++q) {
      const auto& p = values.quadrature_point(q);
      const auto wanted = exact(p);
      const double weight = values.JxW(q) * (dim == 2 ? p[0] : 1);
      for (int k = 0; k < dim; ++k) {
        Eigen::Matrix<double, 8, 1> row = Eigen::Matrix<double, 8, 1>::Zero();
        row[k] = 1;
        if (dim == 3) { // rotations
          row[3 + (k + 2) % 3] = -p[unsigned(k + 1) % 3];
          row[3 + (k + 1) % 3] = p[unsigned(k + 2) % dim];
        }
        row[6] = found[q][unsigned(k)] - wanted[unsigned(k)];
        row[7] = wanted[unsigned(k)];
        sums += weight * row * row.transpose();
      }
    }
  }
  std::vector<double> numbers(sums.data(), sums.data() + sums.size());
  dealii::Utilities::MPI::sum(numbers, ranks, numbers);
  sums = Eigen::Map<Eigen::Matrix<double, 8, 8>>(numbers.data());
  double square = sums(6, 6);
  if (dim == 3)
    square -= sums.block<1, 6>(6, 0).dot(
        sums.topLeftCorner<6, 6>().ldlt().solve(sums.block<6, 1>(0, 6)).transpose());
  return std::sqrt(std::max(0., square) / sums(7, 7));
}

/// Order of convergence of the last of errors on meshes of halved cells.
inline double last_order(const std::vector<double>& errors)
{
  return std::log2(errors.at(errors.size() - 2) / errors.back());
}

/// A body under a history: of one law, or of one per region.
template <int dim>
struct Body {
  fem::Specimen<dim> specimen;
  fem::LawPoints points;
  std::vector<fem::StepReport> reports;

  Body(const fem::Mesh<dim>& mesh, const fem::Discretisation& discretisation,
       const fem::BodyLoads& loads, const fem::ComplianceLaw& law,
       fem::TimeScheme scheme = fem::TimeScheme::stress_linear, double tolerance = 1e-12)
      : specimen(mesh, discretisation, loads, tolerance),
        points(std::span(&law, 1), std::vector<int>(specimen.elements().n_points(), 0), scheme)
  {
  }

  Body(const fem::Mesh<dim>& mesh, const fem::Discretisation& discretisation,
       const fem::BodyLoads& loads, const std::vector<fem::ComplianceLaw>& laws,
       fem::TimeScheme scheme = fem::TimeScheme::stress_linear, double tolerance = 1e-12)
      : specimen(mesh, discretisation, loads, tolerance),
        points(laws, laws_by_region(specimen.elements()), scheme)
  {
  }

  double l2_error(const Field<dim>& exact) const
  {
    return bodies::l2_error(specimen.elements(), specimen.displacement(), exact);
  }

  void step(const fem::LoadState& load, double h)
  {
    reports.push_back(
        specimen.solve_step(load, h, [this](std::span<const fem::Vec6> increment, double dt) {
          return points.evaluate(increment, dt);
        }));
    points.commit();
    specimen.commit();
  }

  /// Largest difference of the displacement from a function of the place [m].
  double displacement_error(const Field<dim>& exact) const
  {
    double worst = 0;
    const auto points_of_dofs = fem::support_points(specimen.elements());
    std::vector<dealii::types::global_dof_index> dofs;
    const auto& handler = specimen.elements().dofs();
    const auto& element = handler.get_fe();
    dofs.resize(element.n_dofs_per_cell());
    for (const auto& cell : handler.active_cell_iterators())
      if (cell->is_locally_owned()) {
        cell->get_dof_indices(dofs);
        for (unsigned i = 0; i < dofs.size(); ++i) {
          const auto k = element.system_to_component_index(i).first;
          worst = std::max(worst, std::abs(specimen.displacement()(dofs[i]) -
                                           exact(points_of_dofs.at(dofs[i]))[k]));
        }
      }
    return dealii::Utilities::MPI::max(worst, ranks);
  }
};

} // namespace bodies
