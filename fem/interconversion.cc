#include "fem/interconversion.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace fem {

namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// B with B B^T = M, one column for each direction above the threshold.
MatrixXd factor(const MatrixXd& matrix, double threshold)
{
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  Index first = 0;
  while (first < matrix.rows() && solver.eigenvalues()[first] <= threshold)
    ++first;
  const Index rank = matrix.rows() - first;
  return solver.eigenvectors().rightCols(rank) *
         solver.eigenvalues().tail(rank).cwiseSqrt().asDiagonal();
}

MatrixXd factor(const MatrixXd& matrix)
{
  return factor(matrix, 1e-13 * matrix.norm());
}

/// Orthonormal basis of the directions that the columns of a factor do not reach.
MatrixXd complement(const MatrixXd& columns)
{
  const Index n = columns.rows(), rank = columns.cols();
  if (rank == 0)
    return MatrixXd::Identity(n, n);
  const MatrixXd q = Eigen::ColPivHouseholderQR<MatrixXd>(columns).householderQ();
  return q.rightCols(n - rank);
}

/// N (N^T M N)^-1 N^T: the inverse of M on the space of the columns of N.
MatrixXd inverse_on(const MatrixXd& basis, const MatrixXd& matrix)
{
  if (basis.cols() == 0)
    return MatrixXd::Zero(matrix.rows(), matrix.cols());
  const MatrixXd within = basis.transpose() * matrix * basis;
  const MatrixXd right = within.ldlt().solve(basis.transpose());
  const MatrixXd result = basis * right;
  return 0.5 * (result + result.transpose());
}

/// Modes in order of rates, those of equal rate as one.
std::vector<MatrixMode> gathered(std::vector<MatrixMode> modes)
{
  std::ranges::sort(modes, {}, &MatrixMode::rate);
  std::vector<MatrixMode> result;
  for (MatrixMode& mode : modes) {
    if (mode.weight.trace() == 0)
      continue;
    if (!result.empty() && mode.rate <= result.back().rate * (1 + 1e-9)) {
      const double before = result.back().weight.trace(), added = mode.weight.trace();
      result.back().rate += (mode.rate - result.back().rate) * added / (before + added);
      result.back().weight += mode.weight;
    } else
      result.push_back(std::move(mode));
  }
  return result;
}

} // namespace

RelaxationSpectrum relaxation_spectrum(const CreepSpectrum& creep)
{
  const Index n = creep.instantaneous.rows();
  const MatrixXd stiffness =
      creep.instantaneous.llt().solve(MatrixXd::Identity(n, n)); // C0 = L L^T
  const MatrixXd root = (0.5 * (stiffness + stiffness.transpose())).llt().matrixL();
  MatrixXd compliance = creep.instantaneous;
  const MatrixXd flow = factor(creep.fluidity);
  std::vector<MatrixXd> columns{root.transpose() * flow};
  std::vector<double> diagonal(std::size_t(flow.cols()), 0.0);
  for (const auto& [rate, weight] : creep.modes) {
    compliance += weight;
    columns.push_back(std::sqrt(rate) * (root.transpose() * factor(weight)));
    diagonal.insert(diagonal.end(), std::size_t(columns.back().cols()), std::sqrt(rate));
  }
  const Index size = Index(diagonal.size());
  RelaxationSpectrum result{inverse_on(complement(flow), compliance), {}};
  if (size == 0)
    return result;
  MatrixXd product = MatrixXd::Zero(n + size, size); // F, with A = F^T F
  Index at = 0;
  for (const MatrixXd& each : columns) {
    product.block(0, at, n, each.cols()) = each;
    at += each.cols();
  }
  for (Index i = 0; i < size; ++i)
    product(n + i, i) = diagonal[std::size_t(i)];
  const Eigen::JacobiSVD<MatrixXd> svd(product, Eigen::ComputeThinU | Eigen::ComputeThinV);
  for (Index i = 0; i < size; ++i) {
    const double value = svd.singularValues()[i];
    const VectorXd stress = root * svd.matrixU().col(i).head(n);
    if (value > 0)
      result.modes.push_back({value * value, stress * stress.transpose()});
  }
  result.modes = gathered(std::move(result.modes));
  return result;
}

CreepSpectrum creep_spectrum(const RelaxationSpectrum& relaxation)
{
  const Index n = relaxation.equilibrium.rows();
  std::vector<MatrixMode> modes = relaxation.modes;
  std::ranges::sort(modes, std::greater{}, &MatrixMode::rate); // large rows first: see below
  MatrixXd instantaneous = relaxation.equilibrium, viscosity = MatrixXd::Zero(n, n);
  for (const auto& [rate, weight] : modes) {
    instantaneous += weight;
    viscosity += weight / rate;
  }
  const MatrixXd held = factor(relaxation.equilibrium, 1e-12 * instantaneous.norm());
  const Eigen::LLT<MatrixXd> cholesky(instantaneous);
  const MatrixXd identity = MatrixXd::Identity(n, n);
  const MatrixXd compliance = cholesky.solve(identity);
  CreepSpectrum result{
      0.5 * (compliance + compliance.transpose()), inverse_on(complement(held), viscosity), {}};
  std::vector<MatrixXd> columns;
  std::vector<double> root_rates;
  for (const auto& [rate, weight] : modes) {
    columns.push_back(factor(weight));
    root_rates.insert(root_rates.end(), std::size_t(columns.back().cols()), std::sqrt(rate));
  }
  columns.push_back(held);
  const Index n_moving = Index(root_rates.size()), n_all = n_moving + held.cols();
  MatrixXd unit_rows(n, n_all); // L^-1 [G, sqrt(C_inf)]: orthonormal rows
  Index at = 0;
  for (const MatrixXd& each : columns) {
    unit_rows.middleCols(at, each.cols()) = each;
    at += each.cols();
  }
  unit_rows = cholesky.matrixL().solve(unit_rows).eval();
  if (n_all <= n)
    return result;
  const MatrixXd q = Eigen::HouseholderQR<MatrixXd>(unit_rows.transpose()).householderQ();
  const Eigen::Map<const VectorXd> scale(root_rates.data(), n_moving);
  // I - V^T V = Z Z^T; rows in falling order keep the digits of slow modes.
  const MatrixXd product = scale.asDiagonal() * q.block(0, n, n_moving, n_all - n);
  const Eigen::JacobiSVD<MatrixXd> svd(product, Eigen::ComputeThinU);
  const MatrixXd drive =
      cholesky.matrixU().solve(unit_rows.leftCols(n_moving)) * scale.asDiagonal();
  for (Index i = 0; i < svd.singularValues().size(); ++i) {
    const double value = svd.singularValues()[i];
    if (!(value > 0))
      continue;
    const VectorXd strain = drive * svd.matrixU().col(i) / value;
    result.modes.push_back({value * value, strain * strain.transpose()});
  }
  result.modes = gathered(std::move(result.modes));
  return result;
}

} // namespace fem
