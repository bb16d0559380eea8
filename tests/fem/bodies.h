#pragma once
#include "fem/creep_compliance.h"
#include "fem/specimen.h"

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

/// A body of one law over a history.
template <int dim>
struct Body {
  fem::Specimen<dim> specimen;
  fem::MaterialPoints points;
  std::vector<fem::StepReport> reports;

  Body(const fem::Mesh<dim>& mesh, const fem::Discretisation& discretisation,
       const fem::BodyLoads& loads, const fem::ComplianceLaw& law,
       fem::TimeScheme scheme = fem::TimeScheme::stress_linear, double tolerance = 1e-12)
      : specimen(mesh, discretisation, loads, tolerance),
        points(std::span(&law, 1), std::vector<int>(specimen.elements().n_points(), 0), scheme)
  {
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
  double displacement_error(
      const std::function<dealii::Tensor<1, dim>(const dealii::Point<dim>&)>& exact) const
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
