#include "dem/link_matrix.h"

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

/// Product of two small matrices, written out: a general product takes longer to begin.
Mat3 times(const Mat3& a, const Mat3& b)
{
  Mat3 result;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      result(i, j) = a(i, 2) * b(2, j) + (a(i, 1) * b(1, j) + a(i, 0) * b(0, j));
  return result;
}

/// Rounded before it is added to anything, not fused with the sum.
[[gnu::noinline]] Mat3 scaled(const Mat3& matrix, double first, double second)
{
  return second * Mat3(first * matrix);
}

/// What the scaled turn of a body moves at the contact point, and its turn; nothing at a platen.
struct End {
  Mat3 lever;
  double turn;
};

End end_of(const Vec3& arm, double radius)
{
  if (radius > 0)
    return {cross_matrix(arm) / radius, 1 / radius};
  return {Mat3::Zero(), 0};
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
  const double sign[2] = {-1, 1};
  const End end[2] = {end_of(t.arm_first * t.normal, radius_first),
                      end_of(t.arm_second * t.normal, radius_second)};
  LinkStiffness result;
  for (int i = 0; i < 2; ++i) {
    const Mat3 to_force = times(force, end[i].lever);
    const Mat3 to_moment = end[i].lever.transpose() * force;
    for (int j = 0; j < 2; ++j) {
      const double both = sign[i] * sign[j];
      result.block<3, 3>(6 * i, 6 * j) = both * force;
      result.block<3, 3>(6 * i + 3, 6 * j) = sign[j] * to_moment;
      result.block<3, 3>(6 * j, 6 * i + 3) = sign[j] * to_force;
      result.block<3, 3>(6 * i + 3, 6 * j + 3) =
          times(to_moment, end[j].lever) + scaled(moment, end[i].turn, both * end[j].turn);
    }
  }
  return result;
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

} // namespace dem
