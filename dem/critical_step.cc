#include "dem/critical_step.h"

#include "dem/random.h"

#include <cmath>
#include <limits>

namespace dem {

double largest_frequency(const ElasticNetwork& network, double density)
{
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Zero(network.n_dofs);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(network.n_dofs);
  for (std::size_t i = 0; i < network.radius.size(); ++i) {
    const Index dof = network.first_dof[i];
    if (dof < 0)
      continue;
    const double mass = density * sphere_volume(network.radius[i]);
    inverse_mass.segment<3>(dof).setConstant(1 / mass);
    inverse_mass.segment<3>(dof + 3).setConstant(1 / (0.4 * mass)); // of R theta
    for (int k = 0; k < 6; ++k)
      x[dof + k] = uniform(1, RandomStream::power_iteration, i, k) - 0.5;
  }
  const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
  double squared = 0;
  for (int round = 0; round < 300; ++round) {
    const double length = x.norm();
    if (length == 0)
      return 0;
    x /= length;
    // symmetric form M^-1/2 K M^-1/2, whose Rayleigh quotient converges twice as fast
    const Eigen::VectorXd root = inverse_mass.cwiseSqrt();
    const Eigen::VectorXd y =
        root.cwiseProduct(network_forces(network, intact, root.cwiseProduct(x)).nodal);
    squared = x.dot(y);
    x = y;
  }
  return std::sqrt(squared);
}

double critical_time_step(const ElasticNetwork& network, double density)
{
  const double frequency = largest_frequency(network, density);
  return frequency > 0 ? 0.98 * 2 / frequency : std::numeric_limits<double>::infinity();
}

} // namespace dem
