#include "dem/link_matrix.h"

#include "dem/network_matrix.h"

#include <algorithm>

namespace dem {

namespace {

Mat3 cross_matrix(const Vec3& v)
{
  Mat3 matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

struct Motion {
  Vec3 moved, turn;
};

Motion motion_of(const LinkDofs& dofs, const Eigen::VectorXd& x, Index body)
{
  if (const Index dof = dofs.first_dof[body]; dof >= 0)
    return {x.segment<3>(dof), x.segment<3>(dof + 3) / dofs.radius[body]};
  if (dofs.support[body] == Support::top && dofs.platen_dof >= 0)
    return {Vec3(0, 0, x[dofs.platen_dof]), Vec3::Zero()};
  return {Vec3::Zero(), Vec3::Zero()};
}

/// D v for the tangent of the force.
Vec3 force_change(const LinkTangent& t, const Vec3& v)
{
  const double along = t.normal.dot(v);
  const double sideways = t.k_s + t.k_v;
  return (t.k_n - sideways) * along * t.normal + sideways * v - t.k_s * t.slip.dot(v) * t.slip;
}

Vec3 moment_change(const LinkTangent& t, const Vec3& v)
{
  return (t.k_t - t.k_b) * t.normal.dot(v) * t.normal + t.k_b * v;
}

} // namespace

LinkStiffness link_stiffness(const LinkTangent& t, double radius_first, double radius_second)
{
  const Mat3 identity = Mat3::Identity();
  const Mat3 normal = t.normal * t.normal.transpose();
  const double sideways = t.k_s + t.k_v;
  const Mat3 force =
      (t.k_n - sideways) * normal + sideways * identity - t.k_s * Mat3(t.slip * t.slip.transpose());
  const Mat3 moment = (t.k_t - t.k_b) * normal + t.k_b * identity;
  Eigen::Matrix<double, 3, 12> shift = Eigen::Matrix<double, 3, 12>::Zero(), turn = shift;
  shift.block<3, 3>(0, 0) = -identity;
  shift.block<3, 3>(0, 6) = identity;
  if (radius_first > 0) {
    shift.block<3, 3>(0, 3) = cross_matrix(t.arm_first * t.normal) / radius_first;
    turn.block<3, 3>(0, 3) = -identity / radius_first;
  }
  if (radius_second > 0) {
    shift.block<3, 3>(0, 9) = cross_matrix(t.arm_second * t.normal) / radius_second;
    turn.block<3, 3>(0, 9) = identity / radius_second;
  }
  return shift.transpose() * force * shift + turn.transpose() * moment * turn;
}

LinkDofs make_dofs(const Bodies& bodies, bool platen_is_free)
{
  LinkDofs dofs;
  dofs.radius = bodies.radius;
  dofs.support = bodies.support;
  for (const Support support : bodies.support) {
    dofs.first_dof.push_back(support == Support::free ? dofs.n_dofs : -1);
    dofs.n_dofs += support == Support::free ? 6 : 0;
  }
  if (platen_is_free)
    dofs.platen_dof = dofs.n_dofs++;
  return dofs;
}

BodyLinks body_links(const Links& links, std::size_t n_bodies)
{
  BodyLinks result;
  result.start.assign(n_bodies + 1, 0);
  for (const Link& link : links.link) {
    ++result.start[link.first + 1];
    ++result.start[link.second + 1];
  }
  for (std::size_t i = 0; i < n_bodies; ++i)
    result.start[i + 1] += result.start[i];
  result.link.resize(2 * links.link.size());
  std::vector<Index> next(result.start.begin(), result.start.end() - 1);
  for (std::size_t k = 0; k < links.link.size(); ++k) {
    result.link[next[links.link[k].first]++] = Index(k);
    result.link[next[links.link[k].second]++] = Index(k);
  }
  return result;
}

Eigen::VectorXd product(const LinkMatrix& matrix, const BodyLinks& body_links, const LinkDofs& dofs,
                        const Eigen::VectorXd& x, int n_threads)
{
  const auto n = Index(dofs.first_dof.size());
  Eigen::VectorXd y = Eigen::VectorXd::Zero(dofs.n_dofs);
  std::vector<double> on_platen(dofs.platen_dof >= 0 ? n : 0, 0.0);
  std::vector<Motion> motions(n); // once: every link needs two
  for (Index i = 0; i < n; ++i)
    motions[i] = motion_of(dofs, x, i);
#pragma omp parallel for num_threads(n_threads) schedule(static) if (n_threads > 1)
  for (Index i = 0; i < n; ++i) {
    const Index dof = dofs.first_dof[i];
    const bool on_top = dofs.platen_dof >= 0 && dofs.support[i] == Support::top;
    if (dof < 0 && !on_top)
      continue;
    const Motion& own = motions[i];
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    for (Index p = body_links.start[i]; p < body_links.start[i + 1]; ++p) {
      const Index k = body_links.link[p];
      const LinkTangent& t = matrix.tangent[k];
      if (!t.carries())
        continue;
      const bool is_first = matrix.ends[k][0] == i;
      const Motion& other = motions[matrix.ends[k][is_first ? 1 : 0]];
      const double own_arm = is_first ? t.arm_first : t.arm_second;
      const double other_arm = is_first ? t.arm_second : t.arm_first;
      const Vec3 n_out = is_first ? t.normal : Vec3(-t.normal);
      const Vec3 shift =
          other.moved - own.moved - (own_arm * own.turn + other_arm * other.turn).cross(n_out);
      const Vec3 pull = force_change(t, shift);
      force -= pull;
      moment -= moment_change(t, other.turn - own.turn) + own_arm * n_out.cross(pull);
    }
    if (dof >= 0) {
      y.segment<3>(dof) = force + matrix.hold[i] * own.moved;
      y.segment<3>(dof + 3) = moment / dofs.radius[i] + matrix.hold[i] * dofs.radius[i] * own.turn;
    } else
      on_platen[i] = force.z();
  }
  for (const double each : on_platen)
    y[dofs.platen_dof] += each;
  return y;
}

SymmetricPattern link_pattern(std::span<const std::array<Index, 2>> ends, const LinkDofs& dofs)
{
  ElasticNetwork network;
  network.radius = dofs.radius;
  network.first_dof = dofs.first_dof;
  network.support = dofs.support;
  network.platen_dof = dofs.platen_dof;
  network.n_dofs = dofs.n_dofs;
  for (const auto& each : ends) {
    ElasticNetwork::Bond bond{};
    bond.ends = each;
    network.bonds.push_back(bond);
  }
  return stiffness_pattern(network);
}

std::vector<double> link_values(const LinkMatrix& matrix, const SymmetricPattern& pattern,
                                const LinkDofs& dofs)
{
  std::vector<double> values(pattern.row.size(), 0.0);
  const auto entry = [&](Index row, Index column) {
    const auto first = pattern.row.begin() + pattern.column_start[column];
    const auto last = pattern.row.begin() + pattern.column_start[column + 1];
    const auto found = std::lower_bound(first, last, row);
    return found != last && *found == row ? int(found - pattern.row.begin()) : -1;
  };
  const auto platen_of = [&](Index body) {
    return dofs.support[body] == Support::top ? dofs.platen_dof : -1;
  };
  for (std::size_t k = 0; k < matrix.tangent.size(); ++k) {
    const LinkTangent& t = matrix.tangent[k];
    const auto [a, b] = matrix.ends[k];
    const bool together = dofs.first_dof[a] < 0 && dofs.support[a] == dofs.support[b];
    if (!t.carries() || together)
      continue;
    const Index dof[2] = {dofs.first_dof[a], dofs.first_dof[b]};
    const Index platen[2] = {platen_of(a), platen_of(b)};
    if (dof[0] >= 0 && dof[1] >= 0 && entry(std::max(dof[0], dof[1]), std::min(dof[0], dof[1])) < 0)
      continue;
    const LinkStiffness block = link_stiffness(t, dofs.radius[a], dofs.radius[b]);
    for (int end = 0; end < 2; ++end) {
      const int other = 1 - end;
      // Columns of a body have the same rows below its own ones.
      const int below_at = dof[end] >= 0 && dof[other] > dof[end]
                               ? entry(dof[other], dof[end]) - pattern.column_start[dof[end]]
                               : -1;
      if (dof[end] >= 0)
        for (int c = 0; c < 6; ++c) {
          double* column = values.data() + pattern.column_start[dof[end] + c];
          for (int r = c; r < 6; ++r)
            column[r - c] += block(6 * end + r, 6 * end + c);
          if (below_at >= 0) {
            double* below = column + below_at - c;
            for (int r = 0; r < 6; ++r)
              below[r] += block(6 * other + r, 6 * end + c);
          }
          if (platen[other] >= 0)
            if (const int at = entry(platen[other], dof[end] + c); at >= 0)
              values[at] += block(6 * other + 2, 6 * end + c);
        }
      if (platen[end] >= 0)
        values[entry(platen[end], platen[end])] += block(6 * end + 2, 6 * end + 2);
    }
  }
  for (std::size_t i = 0; i < dofs.first_dof.size(); ++i)
    for (int c = 0; c < 6 && dofs.first_dof[i] >= 0; ++c)
      values[pattern.column_start[dofs.first_dof[i] + c]] += matrix.hold[i];
  return values;
}

} // namespace dem
