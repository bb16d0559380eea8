#include "dem/local_relaxation.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

/// Share of the largest force out of balance from which on a body is looked at.
constexpr double noticed_share = 0.1;
/// A group is at rest enough at this share of what was out of balance: its surroundings move yet.
constexpr double enough_share = 0.1;
/// Local work pays for up to one body of so many, and in groups of about so many bodies, which have
/// a dense matrix.
constexpr std::size_t bodies_per_seed = 50, most_in_group = 40;
constexpr int most_iterations = 12, most_shortenings = 12;
/// On the diagonal, over the largest entry: bodies that nothing holds stay where they are.
constexpr double least_hold = 1e-9;

/// Forces and, if asked for, the tangent of a group.
struct GroupAnswer {
  Eigen::VectorXd residual;
  Eigen::MatrixXd matrix;
};

/// A group with its links, numbered by itself.
class Group {
public:
  Group(const LocalProblem& problem, std::span<const Index> bodies)
      : problem_(problem), bodies_(bodies.begin(), bodies.end())
  {
    std::ranges::sort(bodies_);
    const BodyLinks& of = *problem.body_links;
    for (const Index i : bodies_)
      links_.insert(links_.end(), of.link.begin() + of.start[i], of.link.begin() + of.start[i + 1]);
    std::ranges::sort(links_);
    links_.erase(std::unique(links_.begin(), links_.end()), links_.end());
  }

  Eigen::Index n_dofs() const { return 6 * std::ssize(bodies_); }

  Eigen::VectorXd gather(const Eigen::VectorXd& x) const
  {
    Eigen::VectorXd own(n_dofs());
    for (std::size_t g = 0; g < bodies_.size(); ++g)
      own.segment<6>(6 * Eigen::Index(g)) = x.segment<6>(problem_.dofs->first_dof[bodies_[g]]);
    return own;
  }

  void scatter(const Eigen::VectorXd& own, Configuration& at, Eigen::VectorXd& x) const
  {
    for (std::size_t g = 0; g < bodies_.size(); ++g) {
      const Index i = bodies_[g];
      x.segment<6>(problem_.dofs->first_dof[i]) = own.segment<6>(6 * Eigen::Index(g));
      at.moved[i] = own.segment<3>(6 * Eigen::Index(g));
      at.turn[i] = own.segment<3>(6 * Eigen::Index(g) + 3) / problem_.dofs->radius[i];
    }
  }

  GroupAnswer answer_at(const Configuration& at, const Eigen::VectorXd& own, bool with_matrix) const
  {
    GroupAnswer result{Eigen::VectorXd(n_dofs()), {}};
    if (with_matrix)
      result.matrix = Eigen::MatrixXd::Zero(n_dofs(), n_dofs());
    for (std::size_t g = 0; g < bodies_.size(); ++g) {
      const auto d = 6 * Eigen::Index(g);
      const double hold = problem_.hold[bodies_[g]];
      result.residual.segment<6>(d) =
          problem_.external->segment<6>(problem_.dofs->first_dof[bodies_[g]]) -
          hold * own.segment<6>(d);
      if (problem_.carried && problem_.carried->size() > 0)
        result.residual.segment<6>(d) +=
            hold * problem_.carried->segment<6>(problem_.dofs->first_dof[bodies_[g]]);
      if (with_matrix)
        result.matrix.diagonal().segment<6>(d).array() += hold;
    }
    for (const Index k : links_)
      add_link(k, at, result, with_matrix);
    if (with_matrix)
      result.matrix.diagonal().array() += least_hold * result.matrix.diagonal().maxCoeff();
    return result;
  }

private:
  Eigen::Index place(Index body) const
  {
    const auto found = std::ranges::lower_bound(bodies_, body);
    return found != bodies_.end() && *found == body ? 6 * (found - bodies_.begin()) : -1;
  }

  void add_link(Index k, const Configuration& at, GroupAnswer& result, bool with_matrix) const
  {
    const LinkAnswer link = answer(*problem_.step, std::size_t(k), at);
    const LinkTangent& t = link.tangent;
    if (!t.carries())
      return;
    const Link& ends = problem_.step->start->link[k];
    const Index body[2] = {ends.first, ends.second};
    const std::vector<double>& radius = problem_.dofs->radius;
    const Eigen::Index at_row[2] = {place(body[0]), place(body[1])};
    const double arm[2] = {t.arm_first, t.arm_second};
    for (int end = 0; end < 2; ++end) {
      if (at_row[end] < 0)
        continue;
      const double sign = end == 0 ? 1 : -1;
      result.residual.segment<3>(at_row[end]) += sign * link.force;
      result.residual.segment<3>(at_row[end] + 3) +=
          (sign * link.moment + arm[end] * t.normal.cross(link.force)) / radius[body[end]];
    }
    if (!with_matrix)
      return;
    const LinkStiffness block = link_stiffness(t, radius[body[0]], radius[body[1]]);
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 2; ++column)
        if (at_row[row] >= 0 && at_row[column] >= 0)
          result.matrix.block<6, 6>(at_row[row], at_row[column]) +=
              block.block<6, 6>(6 * row, 6 * column);
  }

  const LocalProblem& problem_;
  std::vector<Index> bodies_, links_;
};

/// Share of a step at which the force along it is nearly zero.
void search_along(const Group& group, const Eigen::VectorXd& step, double slope, Configuration& at,
                  Eigen::VectorXd& x, Eigen::VectorXd& own)
{
  const Eigen::VectorXd from = own;
  double share = 1, low = 0, low_slope = slope, high = 0, high_slope = 0;
  for (int shortening = 0;; ++shortening) {
    own = from + share * step;
    group.scatter(own, at, x);
    const double now = group.answer_at(at, own, false).residual.dot(step);
    if (shortening == most_shortenings || std::abs(now) <= 0.3 * slope ||
        (shortening == 0 && now > 0))
      return;
    (now > 0 ? low : high) = share;
    (now > 0 ? low_slope : high_slope) = now;
    const double secant = std::isfinite(high_slope) ? low_slope / (low_slope - high_slope) : 0.1;
    share = low + (high - low) * std::clamp(secant, 0.01, 0.9);
  }
}

} // namespace

void relax_group(const LocalProblem& problem, std::span<const Index> bodies, Configuration& at,
                 Eigen::VectorXd& x)
{
  const Group group(problem, bodies);
  Eigen::VectorXd own = group.gather(x);
  double enough = problem.tolerance;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const GroupAnswer now = group.answer_at(at, own, true);
    const double largest = now.residual.cwiseAbs().maxCoeff();
    if (iteration == 0)
      enough = std::max(enough, enough_share * largest);
    if (!(largest > enough))
      return;
    const Eigen::LLT<Eigen::MatrixXd> factor(now.matrix);
    if (factor.info() != Eigen::Success)
      return;
    const Eigen::VectorXd step = factor.solve(now.residual);
    search_along(group, step, now.residual.dot(step), at, x, own);
  }
}

namespace {

/// Bodies with much out of balance.
std::vector<Index> unbalanced_bodies(const LocalProblem& problem, const Eigen::VectorXd& residual)
{
  const std::vector<Index>& first_dof = problem.dofs->first_dof;
  std::vector<double> force(first_dof.size(), 0.0);
  for (std::size_t i = 0; i < force.size(); ++i)
    if (first_dof[i] >= 0)
      force[i] = residual.segment<6>(first_dof[i]).cwiseAbs().maxCoeff();
  const double noticed = std::max(noticed_share * std::ranges::max(force), problem.tolerance);
  std::vector<Index> result;
  for (std::size_t i = 0; i < force.size(); ++i)
    if (force[i] > noticed)
      result.push_back(Index(i));
  return result;
}

} // namespace

std::vector<std::vector<Index>> unbalanced_groups(const LocalProblem& problem,
                                                  std::span<const LinkTangent> tangent,
                                                  const Eigen::VectorXd& residual)
{
  const std::size_t n = problem.dofs->first_dof.size();
  const std::vector<Index> seeds = unbalanced_bodies(problem, residual);
  if (seeds.size() > std::max<std::size_t>(1, n / bodies_per_seed))
    return {};
  const std::span<const Link> links = problem.step->start->link;
  const BodyLinks& of = *problem.body_links;
  const auto for_neighbours = [&](Index i, auto&& use) {
    for (Index p = of.start[i]; p < of.start[i + 1]; ++p)
      if (const Index k = of.link[p]; tangent[k].carries()) {
        const Index other = links[k].first == i ? links[k].second : links[k].first;
        if (problem.dofs->first_dof[other] >= 0)
          use(other);
      }
  };
  std::vector<char> wanted(n, 0);
  for (const Index i : seeds) {
    wanted[i] = 1;
    for_neighbours(i, [&](Index other) { wanted[other] = 1; });
  }
  std::vector<std::vector<Index>> groups;
  for (const Index seed : seeds) {
    if (!wanted[seed])
      continue;
    std::vector<Index> group{seed};
    wanted[seed] = 0;
    for (std::size_t next = 0; next < group.size() && group.size() < most_in_group; ++next)
      for_neighbours(group[next], [&](Index other) {
        if (wanted[other]) {
          wanted[other] = 0;
          group.push_back(other);
        }
      });
    groups.push_back(std::move(group));
  }
  return groups;
}

} // namespace dem
