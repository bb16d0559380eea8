#include "dem/equilibrium.h"

#include "dem/local_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int most_iterations = 25;
/// What is left out of balance after so many may be taken into the next step, over the tolerance.
constexpr double loose = 100;
/// It may be so as soon as iterations do not help, if it is below this share of the largest force.
constexpr double lingering_share = 1e-2;
/// Iterations after which each step is searched along for the least potential.
constexpr int plain_iterations = 6;
constexpr int most_shortenings = 7;
/// Local searches in a row, as long as each leaves this share of what was out of balance.
constexpr int most_relaxations = 10;
constexpr double relaxation_pays = 0.6;
/// A step with local searches counts if it leaves this share of what was out of balance.
constexpr double acceptable_share = 0.95;
/// Hold of every body in the tangent, over the stiffness of links: one that hardly anything else
/// holds does not fly off. It changes the way to equilibrium, not the equilibrium.
constexpr double tangent_hold = 1e-4;
/// Below, waking a thread takes longer than the work.
constexpr Index links_worth_threads = 50'000;

/// Relative residual to which a Newton step is solved.
double linear_tolerance(double residual, double wanted)
{
  return std::clamp(0.3 * wanted / residual, 1e-3, 1e-2);
}

/// Whether a search near equilibrium has come no nearer for some iterations: what is left concerns
/// few bodies that are hardly held.
bool lingers(std::span<const double> residuals, double near)
{
  constexpr std::size_t patience = 3;
  const std::size_t n = residuals.size();
  return n > patience && residuals[n - 1] <= near &&
         residuals[n - 1] > 0.7 * residuals[n - 1 - patience];
}

/// Whether a search that is far from equilibrium has not come nearer for some iterations.
bool stalls(std::vector<double>& residuals, double residual, double wanted)
{
  constexpr std::size_t patience = 8;
  residuals.push_back(residual);
  if (residuals.size() <= 12 || residual < 1e3 * wanted)
    return false;
  return residual > 0.5 * residuals[residuals.size() - 1 - patience];
}

} // namespace

Configuration EquilibriumFinder::configuration(const EquilibriumProblem& problem,
                                               const Eigen::VectorXd& x) const
{
  const std::size_t n = dofs_.first_dof.size();
  Configuration at{std::vector<Vec3>(n, Vec3::Zero()), std::vector<Vec3>(n, Vec3::Zero()),
                   problem.cell_strain};
  const double platen = dofs_.platen_dof >= 0 ? x[dofs_.platen_dof] : problem.platen_moved;
  for (std::size_t i = 0; i < n; ++i) {
    if (const Index dof = dofs_.first_dof[i]; dof >= 0) {
      at.moved[i] = x.segment<3>(dof);
      at.turn[i] = x.segment<3>(dof + 3) / dofs_.radius[i];
    } else if (dofs_.support[i] == Support::top)
      at.moved[i].z() = platen;
  }
  return at;
}

void EquilibriumFinder::evaluate_link(const EquilibriumProblem& problem, Index k,
                                      const Configuration& at)
{
  const LinkAnswer link = answer(problem.step, std::size_t(k), at);
  matrix_.tangent[k] = link.tangent;
  force_[k] = link.force;
  moment_[k] = link.moment;
}

void EquilibriumFinder::evaluate_body(const EquilibriumProblem& problem, Index i,
                                      const Eigen::VectorXd& x, Eigen::VectorXd& residual)
{
  const Index dof = dofs_.first_dof[i];
  if (dof < 0 && dofs_.support[i] != Support::top)
    return;
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (Index p = problem.body_links->start[i]; p < problem.body_links->start[i + 1]; ++p) {
    const Index k = problem.body_links->link[p];
    const LinkTangent& t = matrix_.tangent[k];
    if (!t.carries())
      continue;
    const bool is_first = matrix_.ends[k][0] == i;
    const double sign = is_first ? 1 : -1, arm = is_first ? t.arm_first : t.arm_second;
    force += sign * force_[k];
    moment += sign * moment_[k] + arm * t.normal.cross(force_[k]);
  }
  if (dof >= 0) {
    Vec6 held = problem.hold[i] * x.segment<6>(dof);
    if (problem.carried.size() > 0)
      held -= problem.hold[i] * problem.carried.segment<6>(dof);
    residual.segment<3>(dof) = problem.external.segment<3>(dof) + force - held.head<3>();
    residual.segment<3>(dof + 3) =
        problem.external.segment<3>(dof + 3) + moment / dofs_.radius[i] - held.tail<3>();
  } else
    on_top_[i] = force.z();
}

/// What all links and bodies together give.
void EquilibriumFinder::sum_up(const EquilibriumProblem& problem, Equilibrium& result,
                               Residual& residual) const
{
  double upward = 0;
  for (const double each : on_top_)
    upward += each;
  if (dofs_.platen_dof >= 0) {
    result.platen_force = problem.platen_force(result.x[dofs_.platen_dof]);
    residual.force[dofs_.platen_dof] = upward + result.platen_force;
  } else
    result.platen_force = -upward;
  double largest = 0;
  for (const Vec3& each : force_)
    largest = std::max(largest, each.squaredNorm());
  result.largest_force = std::sqrt(largest);
  result.residual = 0;
  for (Index d = 0; d < residual.force.size(); ++d)
    if (!(std::abs(residual.force[d]) <= result.residual)) {
      result.residual = std::abs(residual.force[d]);
      result.worst_body = d;
    }
  residual.largest = result.residual;
}

EquilibriumFinder::Residual EquilibriumFinder::evaluate(const EquilibriumProblem& problem,
                                                        const Eigen::VectorXd& x,
                                                        Equilibrium& result)
{
  ++n_evaluations_;
  result.at = configuration(problem, x);
  const auto n_links = Index(matrix_.tangent.size());
#pragma omp parallel for num_threads(n_threads_) schedule(static) if (n_links > links_worth_threads)
  for (Index k = 0; k < n_links; ++k)
    evaluate_link(problem, k, result.at);
  const auto n = Index(dofs_.first_dof.size());
  Residual residual{problem.external, 0};
  on_top_.assign(n, 0.0);
#pragma omp parallel for num_threads(n_threads_) schedule(static) if (n_links > links_worth_threads)
  for (Index i = 0; i < n; ++i)
    evaluate_body(problem, i, x, residual.force);
  sum_up(problem, result, residual);
  return residual;
}

/// The same as `evaluate` where only these bodies have moved since.
void EquilibriumFinder::evaluate_near(const EquilibriumProblem& problem,
                                      std::span<const Index> moved, Equilibrium& result,
                                      Residual& residual)
{
  std::vector<Index> links, bodies;
  for (const Index i : moved)
    links.insert(links.end(), problem.body_links->link.begin() + problem.body_links->start[i],
                 problem.body_links->link.begin() + problem.body_links->start[i + 1]);
  const auto each_once = [](std::vector<Index>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  };
  each_once(links);
  for (const Index k : links) {
    evaluate_link(problem, k, result.at);
    bodies.insert(bodies.end(), matrix_.ends[k].begin(), matrix_.ends[k].end());
  }
  each_once(bodies);
  for (const Index i : bodies)
    evaluate_body(problem, i, result.x, residual.force);
  sum_up(problem, result, residual);
}

/// Brings bodies at which a step was wrong to rest with all others held.
void EquilibriumFinder::relax(const EquilibriumProblem& problem, double wanted, Equilibrium& result,
                              Residual& residual)
{
  const LocalProblem local{&problem.step,     problem.body_links, &dofs_,          problem.hold,
                           &problem.external, 0.3 * wanted,       &problem.carried};
  for (int round = 0; round < most_relaxations && residual.largest > wanted; ++round) {
    const auto groups = unbalanced_groups(local, matrix_.tangent, residual.force);
    if (groups.empty())
      return;
    const double before = residual.force.norm();
    const Eigen::VectorXd from = result.x;
    std::vector<Index> moved;
    for (const std::vector<Index>& group : groups) {
      relax_group(local, group, result.at, result.x);
      moved.insert(moved.end(), group.begin(), group.end());
    }
    evaluate_near(problem, moved, result, residual);
    const double now = residual.force.norm();
    if (!(now < before))
      residual = evaluate(problem, result.x = from, result);
    if (!(now < relaxation_pays * before))
      return;
  }
}

/// Goes along a Newton direction: all of it if what is left can be mended by few bodies, else to
/// where the force along it is nearly zero.
void EquilibriumFinder::advance(const EquilibriumProblem& problem, const Eigen::VectorXd& direction,
                                double wanted, Equilibrium& result, Residual& residual)
{
  const double slope = residual.force.dot(direction), before = residual.force.norm();
  const Eigen::VectorXd from = result.x, full = from + direction;
  const bool searching = result.n_iterations > plain_iterations; // two states take turns
  const double enough = (searching ? 0.2 : 0.8) * slope;
  residual = evaluate(problem, result.x = full, result);
  if (std::isfinite(residual.largest) && residual.largest > wanted) {
    relax(problem, wanted, result, residual);
    if (residual.force.norm() < acceptable_share * before)
      return;
    if (result.x != full)
      residual = evaluate(problem, result.x = full, result);
  }
  double share = 1, low = 0, low_slope = slope, high = 1, high_slope = slope;
  for (int shortening = 0;; ++shortening) {
    const double now = std::isfinite(residual.largest) ? residual.force.dot(direction) : -infinity;
    const bool undershoots_all = shortening == 0 && now > -enough;
    if (shortening == most_shortenings || undershoots_all || std::abs(now) <= enough ||
        (!searching && residual.force.norm() < before))
      return;
    (now < 0 ? high : low) = share;
    (now < 0 ? high_slope : low_slope) = now;
    const double secant = low_slope / (low_slope - high_slope);
    share = low + (high - low) * std::clamp(std::isfinite(high_slope) ? secant : 0.1, 0.1, 0.9);
    residual = evaluate(problem, result.x = from + share * direction, result);
  }
}

Equilibrium EquilibriumFinder::find(const EquilibriumProblem& problem, const Eigen::VectorXd& guess)
{
  const Links& start = *problem.step.start;
  const auto n_links = Index(start.link.size());
  matrix_.ends.resize(start.link.size());
  for (std::size_t k = 0; k < start.link.size(); ++k)
    matrix_.ends[k] = {start.link[k].first, start.link[k].second};
  matrix_.tangent.resize(start.link.size());
  matrix_.hold = problem.hold;
  for (double& each : matrix_.hold)
    each += tangent_hold * problem.stiffness;
  force_.resize(start.link.size());
  moment_.resize(start.link.size());
  Equilibrium result;
  result.x = guess;
  Residual residual = evaluate(problem, result.x, result);
  std::vector<double> residuals;
  for (;; ++result.n_iterations) {
    const double wanted = problem.tolerance * std::max({result.largest_force, problem.least_force,
                                                        1e-3 * problem.external.norm()});
    if (!std::isfinite(residual.largest))
      return result;
    if (residual.largest <= wanted) {
      result.found = true;
      return result;
    }
    if (stalls(residuals, residual.largest, wanted))
      return result;
    if (result.n_iterations == most_iterations || dofs_.n_dofs == 0 ||
        lingers(residuals, std::min(loose, lingering_share / problem.tolerance) * wanted)) {
      result.found = residual.largest <= loose * wanted;
      return result;
    }
    const std::optional<Eigen::VectorXd> direction =
        factor_.solve(matrix_, *problem.body_links, dofs_, residual.force,
                      linear_tolerance(residual.largest, wanted), problem.stiffness,
                      n_links > links_worth_threads ? n_threads_ : 1);
    if (!direction)
      return result;
    advance(problem, *direction, wanted, result, residual);
  }
}

} // namespace dem
