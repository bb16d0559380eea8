#include "coupling/breaking_points.h"

#include "dem/mandel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace coupling {

double least_overload(double largest, double tolerance)
{
  if (largest >= without_strength)
    return without_strength;
  const double near = (1 - tolerance) * largest;
  const double beyond = std::pow(largest, 1 - std::min(0.5, 10 * tolerance));
  return std::max(1 - tolerance, std::min(near, beyond));
}

double largest_principal(const fem::Vec6& strain)
{
  Eigen::SelfAdjointEigenSolver<dem::Mat3> solver;
  solver.computeDirect(dem::from_mandel(strain), Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

} // namespace coupling
