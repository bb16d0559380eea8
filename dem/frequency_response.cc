#include "dem/frequency_response.h"

#include "dem/one_thread.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace dem {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

/// Laws that are one function of time up to a factor.
struct LawGroup {
  CreepLaw creep;
  std::vector<double> law_stiffness; ///< of all laws, zero outside the group [N/m]
};

std::vector<LawGroup> law_groups(std::span<const BondLaw> laws)
{
  std::vector<LawGroup> groups;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    const CreepLaw& creep = laws[l].creep;
    auto group = std::ranges::find_if(groups, [&](const LawGroup& each) {
      return proportionality(each.creep, creep).has_value();
    });
    if (group == groups.end())
      group = groups.insert(groups.end(), {creep, std::vector<double>(laws.size(), 0.0)});
    group->law_stiffness[l] = creep.maxwell_stiffness;
  }
  return groups;
}

/// Complex stiffness over the elastic one.
Complex relative_stiffness(const CreepLaw& creep, double omega)
{
  return 1.0 / (complex_compliance(creep, omega) * creep.maxwell_stiffness);
}

/// A group in the full network and in the basis V.
struct GroupNetwork {
  MatrixXd loads;                     ///< P: n x 6
  Mat6 affine;                        ///< Q
  Eigen::SparseMatrix<double> matrix; ///< K, lower triangle
  MatrixXd image;                     ///< K V: n x m
  MatrixXd reduced;                   ///< V^T K V
  MatrixXd reduced_loads;             ///< V^T P
};

/// What is new in the columns, orthonormal, beside an orthonormal basis.
MatrixXd orthonormal_part(const MatrixXd& basis, MatrixXd columns)
{
  for (Eigen::Index c = 0; c < columns.cols(); ++c)
    if (const double size = columns.col(c).norm(); size > 0)
      columns.col(c) /= size;
  for (int pass = 0; pass < 2; ++pass)
    if (basis.cols() > 0)
      columns -= basis * (basis.transpose() * columns);
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  qr.setThreshold(1e-10);
  return qr.householderQ() * MatrixXd::Identity(columns.rows(), qr.rank());
}

/// All frequencies in one basis.
class ReducedNetwork {
public:
  ReducedNetwork(const MacroNetwork& macro, std::span<const LawGroup> groups)
      : basis_(macro.n_dofs(), 0)
  {
    for (const LawGroup& group : groups) {
      group_.push_back({strain_loads(macro, group.law_stiffness),
                        affine_energy(macro, group.law_stiffness),
                        stiffness_matrix(macro, group.law_stiffness),
                        MatrixXd(macro.n_dofs(), 0),
                        {},
                        MatrixXd(0, 6)});
    }
  }

  struct Answer {
    ComplexMat6 stiffness; ///< times the volume
    MatrixXcd residual;    ///< nodal forces out of balance
  };
  Answer answer(std::span<const Complex> kappa) const
  {
    const Eigen::Index m = basis_.cols();
    MatrixXcd matrix = MatrixXcd::Zero(m, m), loads = MatrixXcd::Zero(m, 6);
    for (std::size_t g = 0; g < group_.size() && m > 0; ++g) {
      matrix += kappa[g] * group_[g].reduced;
      loads += kappa[g] * group_[g].reduced_loads;
    }
    const MatrixXcd share = m > 0 ? MatrixXcd(-matrix.partialPivLu().solve(loads)) : loads;
    Answer result{loads.transpose() * share, MatrixXcd::Zero(basis_.rows(), 6)};
    for (std::size_t g = 0; g < group_.size(); ++g) {
      result.stiffness += kappa[g] * group_[g].affine;
      result.residual += kappa[g] * group_[g].loads;
      const MatrixXcd weighted = kappa[g] * share;
      result.residual.real() += group_[g].image * weighted.real();
      result.residual.imag() += group_[g].image * weighted.imag();
    }
    return result;
  }

  /// Takes in more motions. \return how many were new
  Eigen::Index grow(const MatrixXd& columns)
  {
    const MatrixXd fresh = orthonormal_part(basis_, columns);
    const Eigen::Index m = basis_.cols(), k = fresh.cols();
    basis_.conservativeResize(Eigen::NoChange, m + k);
    basis_.rightCols(k) = fresh;
    for (GroupNetwork& group : group_) {
      group.image.conservativeResize(Eigen::NoChange, m + k);
      group.image.rightCols(k) = group.matrix.selfadjointView<Eigen::Lower>() * fresh;
      group.reduced.conservativeResize(m + k, m + k);
      group.reduced.rightCols(k) = basis_.transpose() * group.image.rightCols(k);
      group.reduced.bottomLeftCorner(k, m) = group.reduced.topRightCorner(m, k).transpose();
      group.reduced_loads.conservativeResize(m + k, 6);
      group.reduced_loads.bottomRows(k) = fresh.transpose() * group.loads;
    }
    return k;
  }

  int size() const { return int(basis_.cols()); }

private:
  MatrixXd basis_; ///< V: n x m, orthonormal
  std::vector<GroupNetwork> group_;
};

/// Positions from the outside inwards: the ends first, then halves, quarters...
std::vector<std::size_t> outside_in(std::size_t n)
{
  std::vector<std::size_t> order;
  std::vector<bool> taken(n, false);
  for (std::size_t parts = 1; order.size() < n; parts *= 2)
    for (std::size_t k = 0; k <= parts; ++k)
      if (const std::size_t i = k * (n - 1) / parts; !taken[i]) {
        taken[i] = true;
        order.push_back(i);
      }
  return order;
}

void validate(const VolumeElement& element, std::span<const double> omega, double tolerance)
{
  if (!element.is_periodic)
    throw std::invalid_argument("frequency response: the volume element must be periodic");
  if (!(tolerance > 0))
    throw std::invalid_argument(
        fmt::format("frequency response: the tolerance must be > 0, found {:g}", tolerance));
  for (const double each : omega)
    if (!(each > 0) || !std::isfinite(each))
      throw std::invalid_argument(
          fmt::format("frequency response: frequencies must be > 0, found {:g} rad/s", each));
}

/// Stiffness of each law for an elastic network like that of a frequency.
std::vector<double> elastic_stiffness(std::span<const LawGroup> groups,
                                      std::span<const Complex> kappa)
{
  std::vector<double> result(groups.front().law_stiffness.size(), 0.0);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t l = 0; l < result.size(); ++l)
      result[l] += std::abs(kappa[g]) * groups[g].law_stiffness[l];
  return result;
}

/// R^H Z relative to the stiffness, given Z as real and imaginary parts. Without a basis: 1.
double relative_error(const ReducedNetwork::Answer& answer, const MatrixXd& moves)
{
  const MatrixXcd z = moves.leftCols<6>() + Complex(0, 1) * moves.rightCols<6>();
  const ComplexMat6 energy = answer.residual.adjoint() * z;
  const double size = answer.stiffness.norm();
  if (!(energy.norm() > 1e-15 * size))
    return 0;
  return Eigen::FullPivLU<ComplexMat6>(answer.stiffness).solve(energy).norm();
}

} // namespace

FrequencyResponse frequency_response(const VolumeElement& element, std::span<const double> omega,
                                     double tolerance)
{
  constexpr int most_growths = 100; // at one frequency; the theory says about 20
  validate(element, omega, tolerance);
  const OneThread one_thread; // the products are too short for more
  FrequencyResponse result{{omega.begin(), omega.end()},
                           std::vector<ComplexMat6>(omega.size(), ComplexMat6::Zero()),
                           std::vector<double>(omega.size(), 0.0)};
  if (element.bonds.size() == 0)
    return result;
  const MacroNetwork macro = make_macro_network(element);
  const auto pins = rigid_motion_pins(find_clusters(element, macro.status), macro.network);
  const std::vector<LawGroup> groups = law_groups(element.laws);
  ReducedNetwork network(macro, groups);
  std::vector<std::size_t> by_size(omega.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  std::ranges::sort(by_size, {}, [&](std::size_t i) { return omega[i]; });
  for (const std::size_t place : outside_in(omega.size())) {
    const std::size_t i = by_size[place];
    std::vector<Complex> kappa;
    for (const LawGroup& group : groups)
      kappa.push_back(relative_stiffness(group.creep, omega[i]));
    const MacroSolver solver(macro, pins, elastic_stiffness(groups, kappa));
    for (int growth = 0; growth <= most_growths; ++growth) {
      const ReducedNetwork::Answer now = network.answer(kappa);
      MatrixXd columns(macro.n_dofs(), 12);
      columns << now.residual.real(), now.residual.imag();
      const MatrixXd moves = solver.solve_once(columns);
      result.stiffness[i] = now.stiffness / macro.volume;
      result.error[i] = relative_error(now, moves);
      if (result.error[i] <= tolerance || network.grow(moves) == 0)
        break;
    }
  }
  result.basis_size = network.size();
  return result;
}

ComplexMat6 complex_compliance(const ComplexMat6& stiffness)
{
  return stiffness.fullPivLu().inverse();
}

} // namespace dem
