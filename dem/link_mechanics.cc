#include "dem/link_mechanics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem {

namespace {

/// Relative motion of the two bodies over the step, before it is split into modes.
struct Motion {
  Vec3 shear; ///< at the contact point; its normal part does not count [m]
  Vec3 turn;  ///< of the second body relative to the first [rad]
  double elongation;
};

/// Displacement of the second body relative to the first; to a platen that along its normal.
Vec3 approach(const LinkStep& step, const Link& link, const Configuration& now)
{
  const Vec3 change = now.moved[link.second] - now.moved[link.first];
  if (step.bodies->cell)
    return change + now.cell * step.bodies->cell->translation(link.image);
  return link.second >= step.bodies->n_particles() ? Vec3(0, 0, change.z()) : change;
}

/// Frame of a link at the start of the step; that of an open contact is not kept up.
BondFrame start_frame(const Link& link, const Vec3& branch)
{
  if (link.closed)
    return link.frame;
  const Vec3 normal = branch.normalized();
  int smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  return {normal, normal.cross(Vec3::Unit(smallest)).normalized()};
}

/// Small displacements: the geometry at the start holds.
Motion small_motion(const LinkStep& step, const Link& link, const Configuration& now,
                    LinkAnswer& result)
{
  Vec3 delta = approach(step, link, now);
  result.frame = link.frame;
  result.distance = link.distance + link.frame.normal.dot(delta);
  delta -= result.tangent.arm_first * now.turn[link.first].cross(link.frame.normal) +
           result.tangent.arm_second * now.turn[link.second].cross(link.frame.normal);
  return {delta, now.turn[link.second] - now.turn[link.first], link.frame.normal.dot(delta)};
}

Motion finite_motion(const LinkStep& step, const Link& link, const Configuration& now,
                     LinkAnswer& result)
{
  const bool platen = link.second >= step.bodies->n_particles();
  const Vec3 before = branch(link, *step.bodies, step.centre, step.stretch);
  const Vec3 change = approach(step, link, now), branch_now = before + change;
  result.distance = branch_now.norm();
  const Vec3 normal = branch_now / result.distance;
  const Vec3 turn_first = half_tangent(now.turn[link.first]);
  const Vec3 turn_second = half_tangent(now.turn[link.second]);
  result.frame = carried(start_frame(link, before), 0.5 * (turn_first + turn_second), normal);
  const double share =
      result.tangent.arm_first / (result.tangent.arm_first + result.tangent.arm_second);
  const Vec3 slip = platen ? Vec3(Vec3::Zero()) : change;
  const Vec3 shear =
      slip - (share * turn_first + (1 - share) * turn_second).cross(branch_now + before);
  const double elongation = // without the cancellation of two distances
      change.dot(before + branch_now) / (before.norm() + result.distance);
  return {shear, 2 * (turn_second - turn_first), elongation};
}

void split_into_modes(const Link& link, const Motion& motion, LinkAnswer& result)
{
  const BondFrame& from = link.closed ? link.frame : result.frame;
  const Vec3 along = 0.5 * (from.tangent + result.frame.tangent);
  const Vec3 across = 0.5 * (from.second_tangent() + result.frame.second_tangent());
  const Vec3 axis = 0.5 * (from.normal + result.frame.normal);
  const double elongation = link.closed ? motion.elongation : result.distance - link.touch;
  result.push = {elongation,
                 motion.shear.dot(along),
                 motion.shear.dot(across),
                 motion.turn.dot(axis),
                 motion.turn.dot(along),
                 motion.turn.dot(across)};
}

double trial_force(const LawStep& law, const double* memory, double push)
{
  double sum = law.gain[0] * push;
  for (Eigen::Index p = 0; p < law.gain.size(); ++p)
    sum += law.carry(0, p) * memory[p];
  return sum;
}

/// Trial forces of all modes, as if nothing opened or slid.
std::array<double, 6> trial_forces(const LinkStep& step, std::size_t k, const LawStep& law,
                                   const std::array<double, 6>& w, const LinkAnswer& at)
{
  const double* memory = step.start->memory_of(k);
  std::array<double, 6> force;
  for (int mode = 0; mode < 6; ++mode)
    force[mode] = w[mode] == 0 ? 0
                               : trial_force(law, memory + mode * step.start->n_parts,
                                             w[mode] * at.push[mode]);
  return force;
}

void pull_bond(const LinkStep& step, std::size_t k, const LawStep& law, LinkAnswer& result)
{
  const std::array<double, 6> w = mode_multipliers(step.start->link[k], *step.assembly);
  const std::array<double, 6> force = trial_forces(step, k, law, w, result);
  LinkTangent& tangent = result.tangent;
  tangent.k_n = law.stiffness();
  tangent.k_s = w[1] * law.stiffness();
  tangent.k_t = w[3] * law.stiffness();
  tangent.k_b = w[4] * law.stiffness();
  const BondFrame& frame = result.frame;
  const Vec3 second = frame.second_tangent();
  result.closed = true;
  result.normal_force = force[0];
  result.force = force[0] * frame.normal + force[1] * frame.tangent + force[2] * second;
  result.moment = force[3] * frame.normal + force[4] * frame.tangent + force[5] * second;
}

void press_contact(const LinkStep& step, std::size_t k, const LawStep& law, LinkAnswer& result)
{
  const Link& link = step.start->link[k];
  const std::array<double, 6> w = mode_multipliers(link, *step.assembly);
  const std::array<double, 6> force = trial_forces(step, k, law, w, result);
  LinkTangent& tangent = result.tangent;
  const BondFrame& frame = result.frame;
  const Vec3 second = frame.second_tangent();
  result.opening = result.distance - force[0] / law.stiffness();
  result.closed = force[0] < 0;
  if (result.closed) {
    tangent.k_n = law.stiffness();
    result.normal_force = force[0];
    result.force = force[0] * frame.normal;
  }
  if (!link.closed || link.second >= step.bodies->n_particles())
    return;
  const double limit = step.friction * std::max(0.0, -step.start->memory_of(k)[0]);
  Vec3 shear = force[1] * frame.tangent + force[2] * second;
  const double magnitude = shear.norm();
  tangent.k_s = w[1] * law.stiffness();
  if (magnitude > limit) {
    result.kept_shear = limit / magnitude;
    tangent.slip = shear / magnitude;
    tangent.k_s *= result.kept_shear;
    shear *= result.kept_shear;
  }
  const double rolling = tangent.arm_first * tangent.arm_second;
  tangent.k_v = step.regularisation * law.stiffness();
  tangent.k_t = tangent.k_b = tangent.k_v * rolling;
  result.force += shear + tangent.k_v * (result.push[1] * frame.tangent + result.push[2] * second);
  result.moment = tangent.k_b * (result.push[3] * frame.normal + result.push[4] * frame.tangent +
                                 result.push[5] * second);
}

} // namespace

LinkAnswer answer(const LinkStep& step, std::size_t k, const Configuration& now)
{
  const Link& link = step.start->link[k];
  LinkAnswer result;
  result.force = result.moment = result.tangent.slip = Vec3::Zero();
  if (step.geometry == Geometry::finite && !link.closed) { // most open contacts stay open
    result.distance =
        (branch(link, *step.bodies, step.centre, step.stretch) + approach(step, link, now)).norm();
    if (result.distance >= link.touch) {
      result.tangent.gap = result.distance - link.touch;
      result.frame = link.frame;
      result.tangent.normal = link.frame.normal;
      return result;
    }
  }
  const bool platen = link.second >= step.bodies->n_particles();
  const auto set_arms = [&](double length) {
    result.tangent.arm_first = platen ? length : 0.5 * length + link.offset;
    result.tangent.arm_second = length - result.tangent.arm_first;
  };
  const bool finite = step.geometry == Geometry::finite;
  set_arms(finite ? link.distance : link.span);
  const Motion motion =
      finite ? finite_motion(step, link, now, result) : small_motion(step, link, now, result);
  result.tangent.normal = result.frame.normal;
  if (finite)
    set_arms(result.distance);
  if (!link.closed && result.distance >= link.touch)
    return result;
  split_into_modes(link, motion, result);
  const LawStep& law = step.laws[link.law];
  if (link.kind == LinkKind::bond)
    pull_bond(step, k, law, result);
  else
    press_contact(step, k, law, result);
  return result;
}

LinkEnergies commit(const LinkStep& step, std::size_t k, const LinkAnswer& end, Links& links)
{
  LinkEnergies energies;
  const Link& before = step.start->link[k];
  Link& link = links.link[k];
  const int n_parts = links.n_parts;
  const CreepLaw& creep = step.assembly->laws[link.law].creep;
  const std::array<double, 6> w = mode_multipliers(before, *step.assembly);
  const double* from = step.start->memory_of(k);
  double* to = links.memory_of(k);
  const auto stored = [&](const double* memory) {
    double sum = 0;
    for (int mode = 0; mode < 6; ++mode)
      sum += stored_energy(creep, memory + mode * n_parts, w[mode]);
    return sum;
  };
  link.distance = end.distance;
  if (!end.closed) {
    if (before.closed) { // its elastic energy does work while it opens, the rest is lost
      energies.stored = -stored(from);
      energies.dashpots = -energies.stored + 0.5 * from[0] * (end.opening - before.distance);
      open_link(links, k, std::min(end.opening, end.distance));
    }
    return energies;
  }
  link.closed = true;
  link.frame = end.frame;
  const LawStep& law = step.laws[link.law];
  for (int mode = 0; mode < 6; ++mode) {
    if (w[mode] == 0)
      continue;
    const double* x = from + mode * n_parts;
    double* y = to + mode * n_parts;
    for (int p = 0; p < n_parts; ++p) {
      y[p] = law.gain[p] * w[mode] * end.push[mode];
      for (int q = 0; q < n_parts; ++q)
        y[p] += law.carry(p, q) * x[q];
    }
    if (mode > 0 && !before.closed) { // slid freely until now
      std::fill_n(y, n_parts, 0.0);
      continue;
    }
    energies.dashpots += dissipated_energy(creep, law, x, y, end.push[mode], w[mode]);
    const bool slides = (mode == 1 || mode == 2) && end.kept_shear < 1;
    if (slides) { // what is above the limit goes; the work was done by the mean of both ends
      energies.friction +=
          stored_energy(creep, y, w[mode]) - 0.5 * (1 - end.kept_shear) * y[0] * end.push[mode];
      for (int p = 0; p < n_parts; ++p)
        y[p] *= end.kept_shear;
      energies.friction -= stored_energy(creep, y, w[mode]);
    }
  }
  energies.stored = stored(to) - stored(from);
  const auto squared = [&](int mode) { return end.push[mode] * end.push[mode]; };
  if (before.kind == LinkKind::contact)
    energies.regularisation = end.tangent.k_v * (squared(1) + squared(2)) +
                              end.tangent.k_b * (squared(3) + squared(4) + squared(5));
  return energies;
}

void scheme_difference(const LinkStep& step, std::size_t k, const LinkAnswer& end,
                       std::span<const LawStep> other, double& difference, double& size)
{
  const Link& link = step.start->link[k];
  const std::array<double, 6> w = mode_multipliers(link, *step.assembly);
  const double* memory = step.start->memory_of(k);
  for (int mode = 0; mode < 6; ++mode) {
    if (w[mode] == 0)
      continue;
    const double* x = memory + mode * step.start->n_parts;
    const double push = w[mode] * end.push[mode];
    difference +=
        (trial_force(other[link.law], x, push) - trial_force(step.laws[link.law], x, push)) *
        end.push[mode];
    size += step.laws[link.law].stiffness() * push * end.push[mode];
  }
}

double stored_energy(const Links& links, std::size_t k, const Assembly& assembly)
{
  const Link& link = links.link[k];
  const std::array<double, 6> w = mode_multipliers(link, assembly);
  double sum = 0;
  for (int mode = 0; mode < 6; ++mode)
    sum += stored_energy(assembly.laws[link.law].creep, links.memory_of(k) + mode * links.n_parts,
                         w[mode]);
  return sum;
}

} // namespace dem
