#include "dem/stale_factor.h"

#include <algorithm>
#include <numeric>

namespace dem {

namespace {

/// Iterations that cost as much as a factorisation.
constexpr long iterations_per_factorisation = 10;
/// Iterations that a fresh factor needs as well, for the tolerance of a Newton step.
constexpr long free_iterations = 3;
constexpr long most_iterations = 120;
/// With a stale factor the residual need not be smaller than this share after so many iterations:
/// the next Newton step does better. More than the last share after a few means that the factor is
/// too far off.
constexpr long enough_iterations = 8, few_iterations = 4, most_stale_iterations = 12;
constexpr double enough_then = 0.03, enough_at_last = 0.1, hopeless = 0.6;
/// After so many failures in a row a stale factor is tried for every so manieth solution still.
constexpr long most_failures = 5;
/// Links that carry outside the pattern before it is analysed anew.
constexpr std::size_t most_outside = 4;
/// Gap over the mean radius up to which open links are in the pattern: they may carry next. More of
/// them make the factor larger, fewer make analyses more frequent.
constexpr double relative_reach = 0.025;

enum class Verdict { go_on, take, give_up };

/// What to make of a solution that is not precise enough yet.
///
/// \param left  residual over that at the beginning
Verdict verdict(long n_iterations, double left, bool stale)
{
  if (!stale)
    return n_iterations == most_iterations ? Verdict::give_up : Verdict::go_on;
  if (n_iterations >= most_stale_iterations)
    return left <= enough_at_last ? Verdict::take : Verdict::give_up;
  if (n_iterations >= enough_iterations && left <= enough_then)
    return Verdict::take;
  return n_iterations == few_iterations && left > hopeless ? Verdict::give_up : Verdict::go_on;
}

double mean_radius(const LinkDofs& dofs)
{
  return std::accumulate(dofs.radius.begin(), dofs.radius.end(), 0.0) / double(dofs.radius.size());
}

/// Pairs that carry or nearly touch.
std::vector<std::array<Index, 2>> pairs_in_reach(const LinkMatrix& matrix, double reach)
{
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t k = 0; k < matrix.tangent.size(); ++k)
    if (matrix.tangent[k].carries() || matrix.tangent[k].gap <= reach)
      pairs.push_back(matrix.ends[k]);
  return pairs;
}

} // namespace

void StaleFactor::analyse(std::vector<std::array<Index, 2>> ends, const LinkDofs& dofs)
{
  assembly_ = std::make_unique<LinkAssembly>(std::move(ends), dofs);
  factor_.emplace(assembly_->pattern(), FactorPrecision::single_to_precondition);
  ++statistics_.n_analyses;
}

void StaleFactor::factorise(const LinkMatrix& matrix, const LinkDofs& dofs, double stiffness)
{
  if (!assembly_ || assembly_->n_outside(matrix) > most_outside)
    analyse(pairs_in_reach(matrix, relative_reach * mean_radius(dofs)), dofs);
  auto next = std::make_shared<FactorisedMatrix>();
  next->ends = assembly_->pairs();
  next->values = assembly_->values(matrix);
  next->stiffness = stiffness;
  if (!factor_->factorise(next->values)) { // rounding: hold everything a little
    const SymmetricPattern& pattern = assembly_->pattern();
    for (int c = 0; c < pattern.size(); ++c)
      next->values[pattern.column_start[c]] *= 1 + 1e-9;
    factor_->factorise(next->values);
  }
  statistics_.n_factor_nonzeros = factor_->n_nonzeros();
  ++statistics_.n_factorisations;
  wear_.factorised = std::move(next);
  wear_.extra_iterations = 0;
}

void StaleFactor::restore(const Wear& wear, const LinkDofs& dofs)
{
  wear_ = wear;
  if (!wear.factorised)
    return;
  analyse(wear.factorised->ends, dofs);
  factor_->factorise(wear.factorised->values);
}

void StaleFactor::begin_anew()
{
  wear_.n_fresh = 1;
  wear_.n_failures = wear_.extra_iterations = 0;
}

std::optional<Eigen::VectorXd> StaleFactor::solve(const LinkMatrix& matrix,
                                                  const BodyLinks& body_links, const LinkDofs& dofs,
                                                  const Eigen::VectorXd& b, double tolerance,
                                                  double stiffness, int n_threads)
{
  const bool worn = wear_.n_fresh > 0 || wear_.extra_iterations > iterations_per_factorisation;
  wear_.n_fresh = std::max(0L, wear_.n_fresh - 1);
  if (wear_.factorised && !worn) {
    if (auto x = iterate(matrix, body_links, dofs, b, tolerance, stiffness, n_threads, true)) {
      wear_.n_failures = 0;
      return x;
    }
    wear_.n_failures = std::min(wear_.n_failures + 1, most_failures);
    wear_.n_fresh = wear_.n_failures;
  }
  factorise(matrix, dofs, stiffness);
  return iterate(matrix, body_links, dofs, b, tolerance, stiffness, n_threads, false);
}

std::optional<Eigen::VectorXd> StaleFactor::iterate(const LinkMatrix& matrix,
                                                    const BodyLinks& body_links,
                                                    const LinkDofs& dofs, const Eigen::VectorXd& b,
                                                    double tolerance, double stiffness,
                                                    int n_threads, bool stale)
{
  const double scale = wear_.factorised->stiffness / stiffness;
  const auto precondition = [&](const Eigen::VectorXd& r) {
    return Eigen::VectorXd(scale * factor_->back_solve(factor_->half_solve(r)));
  };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), r = b, z = precondition(r), p = z;
  double rz = r.dot(z);
  const double enough = tolerance * b.norm();
  ++statistics_.n_solves;
  long n = 0;
  for (; r.norm() > enough; ++n) {
    const Verdict now = verdict(n, r.norm() / b.norm(), stale);
    if (now == Verdict::give_up)
      return std::nullopt;
    if (now == Verdict::take)
      break;
    const Eigen::VectorXd product = dem::product(matrix, body_links, dofs, p, n_threads);
    const double curvature = p.dot(product);
    if (!(curvature > 0))
      return std::nullopt;
    const double alpha = rz / curvature;
    x += alpha * p;
    r -= alpha * product;
    if (r.norm() <= enough) {
      ++n;
      break;
    }
    z = precondition(r);
    const double next = r.dot(z);
    p = z + next / rz * p;
    rz = next;
  }
  statistics_.n_iterations += n;
  wear_.extra_iterations += std::max(0L, n - free_iterations);
  return x;
}

} // namespace dem
