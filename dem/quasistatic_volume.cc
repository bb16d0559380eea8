#include "dem/quasistatic_volume.h"

#include "dem/link_strength.h"
#include "dem/macro_network.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

/// Gap up to which pairs are linked, over the smallest radius.
constexpr double relative_skin = 0.3;

std::vector<BondStatus> bond_status(const QuasistaticVolume& volume, const Links& links)
{
  std::vector<BondStatus> status(volume.assembly.bonds.size());
  for (std::size_t b = 0; b < status.size(); ++b)
    status[b] = links.link[b].kind == LinkKind::bond ? BondStatus::intact : BondStatus::gone;
  return status;
}

Assembly assembly_of(const VolumeElement& element, Strengths strengths)
{
  Assembly assembly;
  assembly.particles = element.particles;
  assembly.support.assign(element.particles.size(), Support::free);
  assembly.laws = element.laws;
  assembly.pair_laws = element.pair_laws;
  assembly.bonds = element.bonds;
  assembly.strengths = std::move(strengths);
  assembly.gauge_length = std::cbrt(element.cell.volume());
  assembly.area = assembly.gauge_length * assembly.gauge_length;
  return assembly;
}

std::optional<CreepLaw> shared_creep(const std::vector<BondLaw>& laws)
{
  for (const BondLaw& law : laws)
    if (!proportionality(laws.front().creep, law.creep))
      return std::nullopt;
  return laws.front().creep;
}

Eigen::MatrixXd localisation_of(const VolumeElement& element)
{
  const MacroNetwork macro = make_macro_network(element);
  const std::vector<Pin> pins =
      rigid_motion_pins(find_clusters(element, macro.status), macro.network);
  const MacroSolver solver(macro, pins, macro.law_stiffness);
  return -solver.solve(strain_loads(macro, macro.law_stiffness));
}

/// Motion of all bodies under a strain of the intact elastic volume.
Configuration motion_under(const QuasistaticVolume& volume, const Vec6& strain)
{
  const std::size_t n = volume.bodies.radius.size();
  Configuration at{std::vector<Vec3>(n, Vec3::Zero()), std::vector<Vec3>(n, Vec3::Zero()),
                   from_mandel(strain)};
  const Eigen::VectorXd dofs = volume.localisation * strain;
  for (Index i = 0; i < volume.bodies.n_particles(); ++i) {
    at.moved[i] = at.cell * volume.element.particles.centre[i] + dofs.segment<3>(6 * i);
    at.turn[i] = dofs.segment<3>(6 * i + 3) / volume.bodies.radius[i];
  }
  return at;
}

std::vector<LawStep> law_steps(const Assembly& assembly, StepScheme scheme, double duration,
                               int n_parts)
{
  std::vector<LawStep> steps;
  for (const BondLaw& law : assembly.laws)
    steps.push_back(law_step(law.creep, scheme, duration, n_parts));
  return steps;
}

/// Whether near pairs must be looked for again: bodies or images have come nearer by much.
bool is_outdated(const QuasistaticVolume& volume, const QuasistaticVolumeState& state)
{
  const Mat3 images = (state.strain - state.searched_at) * volume.element.cell.edges;
  double moved = 0;
  for (std::size_t i = 0; i < state.centre.size(); ++i)
    moved = std::max(moved, (state.centre[i] - state.links.reference[i]).norm());
  const double nearer = 2 * moved + images.colwise().norm().sum();
  return 2 * nearer > volume.skin; // half the skin is left for the next step
}

QuasistaticVolumeState with_contacts(const QuasistaticVolume& volume, QuasistaticVolumeState state)
{
  if (volume.settings.geometry == Geometry::small)
    return state;
  state.links = find_contacts(std::move(state.links), volume.assembly, volume.bodies, state.centre,
                              volume.skin, Mat3::Identity() + state.strain);
  state.searched_at = state.strain;
  return state;
}

} // namespace

QuasistaticVolume make_quasistatic_volume(VolumeElement element, Strengths strengths,
                                          const QuasistaticSettings& settings)
{
  if (!element.is_periodic)
    throw std::invalid_argument("a volume that is followed must be periodic");
  if (strengths.normal.size() != element.bonds.size() ||
      strengths.shear.size() != element.bonds.size())
    throw std::invalid_argument("each bond of a volume needs its strengths");
  for (const auto& [i, j] : element.bonds.ends)
    if (i == j)
      throw std::invalid_argument("the quasi-static solver cannot follow a sphere that is bonded "
                                  "to its own image: take a larger volume");
  QuasistaticVolume volume{std::move(element), settings, {}, {}, {}, 0, {}, {}};
  volume.assembly = assembly_of(volume.element, std::move(strengths));
  volume.bodies = make_bodies(volume.assembly);
  volume.bodies.platens_press = false;
  volume.bodies.cell = volume.element.cell;
  volume.dofs = make_dofs(volume.bodies, false);
  volume.skin = relative_skin * std::ranges::min(volume.element.particles.radius);
  volume.creep = shared_creep(volume.element.laws);
  if (volume.creep)
    volume.localisation = localisation_of(volume.element);
  return volume;
}

QuasistaticVolumeState at_rest(const QuasistaticVolume& volume)
{
  QuasistaticVolumeState state;
  state.centre = volume.element.particles.centre;
  state.centre.resize(volume.bodies.radius.size(), Vec3::Zero());
  state.rotation.assign(state.centre.size(), Vec3::Zero());
  state.links = make_links(volume.assembly, volume.bodies, state.centre, volume.element.shift);
  return with_contacts(volume, std::move(state));
}

QuasistaticVolumeState carried_over(const QuasistaticVolume& volume, const Vec6& elastic,
                                    std::span<const Vec6> kelvin, const Vec6& strain)
{
  if (!volume.creep)
    throw std::invalid_argument("the bonds of this volume share no law");
  const QuasistaticVolumeState rest = at_rest(volume);
  QuasistaticVolumeState state = rest;
  const int n_parts = rest.links.n_parts;
  const std::vector<LawStep> laws =
      law_steps(volume.assembly, StepScheme::force_linear, 0, n_parts);
  LinkStep step{&volume.assembly, &volume.bodies, &rest.links, rest.centre, laws, 0, 0,
                Geometry::small};
  std::vector<Configuration> parts{motion_under(volume, elastic)};
  for (const Vec6& each : kelvin)
    parts.push_back(motion_under(volume, each));
  const Configuration now = motion_under(volume, strain);
  for (std::size_t k = 0; k < volume.assembly.bonds.size(); ++k) {
    Link& link = state.links.link[k];
    const std::array<double, 6> w = mode_multipliers(link, volume.assembly);
    const double stiffness = volume.assembly.laws[link.law].creep.maxwell_stiffness;
    step.geometry = Geometry::small;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const LinkAnswer part = answer(step, k, parts[p]);
      for (int mode = 0; mode < 6; ++mode)
        state.links.memory_of(k)[mode * n_parts + int(p)] =
            (p == 0 ? stiffness : 1) * w[mode] * part.push[mode];
    }
    step.geometry = volume.settings.geometry;
    const LinkAnswer end = answer(step, k, now);
    link.distance = end.distance;
    link.frame = end.frame;
  }
  for (std::size_t i = 0; i < state.centre.size(); ++i) {
    state.centre[i] += now.moved[i];
    state.rotation[i] += now.turn[i];
  }
  state.strain = now.cell;
  return with_contacts(volume, std::move(state));
}

QuasistaticVolumeState with_broken(const QuasistaticVolume& volume, QuasistaticVolumeState state,
                                   std::span<const Index> bonds)
{
  const auto at_start = [&](Index b) { return branch(volume.element, std::size_t(b)).norm(); };
  for (const Index b : bonds)
    break_link(state.links, std::size_t(b),
               breaking_forces(state.links, std::size_t(b), volume.strengths()).mode,
               volume.settings.after_breakage, at_start(b));
  return state;
}

std::size_t n_broken(const QuasistaticVolume& volume, const QuasistaticVolumeState& state)
{
  const auto end = state.links.link.begin() + long(volume.assembly.bonds.size());
  return std::size_t(std::count_if(state.links.link.begin(), end,
                                   [](const Link& link) { return link.kind != LinkKind::bond; }));
}

std::vector<double> strength_ratios(const QuasistaticVolume& volume,
                                    const QuasistaticVolumeState& state)
{
  return strength_ratios(state.links, volume.strengths(), volume.settings.residual_tolerance);
}

namespace {

/// Hold of loose particles, over that of contacts against sliding and rolling.
constexpr double ground_share = 1e-4;
/// Forces that count, over those of contacts that take up all of the strain.
constexpr double least_force_share = 1e-2;
constexpr double first_hold = 1e-3, largest_hold = 1e3;
constexpr int most_passages = 100;
/// Out-of-balance force within a passage, over that of the settings.
constexpr double passage_looseness = 100;

/// Viscous hold of each body over a step [N/m]: of all of them, and of those that no endless
/// cluster of bonds carries.
std::vector<double> holds(const QuasistaticVolume& volume, const Links& links, double everything,
                          double stiffness)
{
  std::vector<double> hold(volume.bodies.radius.size(), everything * stiffness);
  const Clusters clusters = find_clusters(volume.element, bond_status(volume, links));
  for (const Cluster& cluster : clusters.cluster)
    if (cluster.direction.empty())
      for (const Index i : cluster.particles)
        hold[i] += ground_share * volume.settings.regularisation * stiffness;
  return hold;
}

/// Stress of forces that act through the faces of the cell: conjugate to its strain, whatever is
/// out of balance inside.
Vec6 stress_of(const QuasistaticVolume& volume, const Links& links, std::span<const Vec3> force)
{
  Mat3 sum = Mat3::Zero();
  for (std::size_t k = 0; k < links.link.size(); ++k)
    if (!links.link[k].image.isZero())
      sum += force[k] * volume.element.cell.translation(links.link[k].image).transpose();
  return to_mandel(sum) / volume.element.cell.volume();
}

} // namespace

VolumeFollower::VolumeFollower(const QuasistaticVolume& volume)
    : volume_(&volume), finder_(volume.dofs, 1)
{
}

std::optional<VolumeFollower::Found> VolumeFollower::attempt(const QuasistaticVolumeState& from,
                                                             const Mat3& increment, double duration,
                                                             double hold_everything)
{
  const QuasistaticVolume& v = *volume_;
  const double looseness = hold_everything > 0 ? passage_looseness : 1;
  const int n_parts = from.links.n_parts;
  const std::vector<LawStep> laws =
      law_steps(v.assembly, StepScheme::force_linear, duration, n_parts);
  const std::vector<LawStep> others =
      law_steps(v.assembly, StepScheme::displacement_linear, duration, n_parts);
  double stiffness = 0;
  for (const LawStep& law : laws)
    stiffness += law.stiffness() / double(laws.size());
  const BodyLinks links_of = body_links(from.links, from.centre.size());
  const bool slides = v.settings.after_breakage == AfterBreakage::friction;
  Eigen::VectorXd carried = Eigen::VectorXd::Zero(v.dofs.n_dofs);
  for (Index i = 0; i < v.bodies.n_particles(); ++i)
    carried.segment<3>(v.dofs.first_dof[i]) = increment * v.element.particles.centre[i];
  const EquilibriumProblem problem{
      {&v.assembly, &v.bodies, &from.links, from.centre, laws, slides ? v.settings.friction : 0,
       v.settings.regularisation, v.settings.geometry, Mat3::Identity() + from.strain},
      &links_of,
      holds(v, from.links, hold_everything, stiffness),
      Eigen::VectorXd::Zero(v.dofs.n_dofs),
      {},
      0,
      looseness * v.settings.residual_tolerance,
      stiffness,
      increment,
      carried,
      least_force_share * stiffness * (from.strain + increment).norm() *
          std::ranges::min(v.element.particles.radius)};
  finder_.factor().begin_anew();
  Found found{finder_.find(problem, carried), {from, Mat6::Zero(), 0, 0}};
  if (!found.equilibrium.found)
    return std::nullopt;
  QuasistaticVolumeState& state = found.step.state;
  const Configuration& at = found.equilibrium.at;
  std::vector<LinkTangent> tangent;
  std::vector<Vec3> force;
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < from.links.link.size(); ++k) {
    const LinkAnswer end = answer(problem.step, k, at);
    tangent.push_back(end.tangent);
    force.push_back(end.force);
    commit(problem.step, k, end, state.links);
    if (duration > 0 && end.closed && from.links.link[k].closed)
      scheme_difference(problem.step, k, end, others, difference, size);
  }
  found.step.error = size > 0 ? std::abs(difference) / size : 0;
  for (std::size_t i = 0; i < state.centre.size(); ++i) {
    state.centre[i] += at.moved[i];
    state.rotation[i] += at.turn[i];
  }
  state.strain += increment;
  state.stress = stress_of(v, from.links, force);
  found.step.tangent = condensed(tangent, from.links, problem.hold, stiffness);
  if (v.settings.geometry == Geometry::finite && is_outdated(v, state))
    state = with_contacts(v, std::move(state));
  return found;
}

Mat6 VolumeFollower::condensed(std::span<const LinkTangent> tangent, const Links& links,
                               std::span<const double> hold, double stiffness)
{
  const QuasistaticVolume& v = *volume_;
  LinkMatrix matrix{{}, {tangent.begin(), tangent.end()}, {hold.begin(), hold.end()}};
  for (const Link& link : links.link)
    matrix.ends.push_back({link.first, link.second});
  if (matrix.ends != analysed_) {
    analysed_ = matrix.ends;
    assembly_.emplace(analysed_, v.dofs);
    factor_.emplace(assembly_->pattern());
  }
  Mat6 energy = Mat6::Zero();
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(v.dofs.n_dofs, 6);
  for (std::size_t k = 0; k < links.link.size(); ++k) {
    const Link& link = links.link[k];
    if (link.image.isZero() || !tangent[k].carries())
      continue;
    const Vec3 across = v.element.cell.translation(link.image);
    Eigen::Matrix<double, 3, 6> moved; // of the image, per unit strain
    for (int c = 0; c < 6; ++c)
      moved.col(c) = from_mandel(Vec6::Unit(c)) * across;
    const LinkStiffness block =
        link_stiffness(tangent[k], v.bodies.radius[link.first], v.bodies.radius[link.second]);
    const Eigen::Matrix<double, 12, 6> force = block.middleCols<3>(6) * moved;
    energy += moved.transpose() * force.middleRows<3>(6);
    loads.middleRows<6>(v.dofs.first_dof[link.first]) += force.topRows<6>();
    loads.middleRows<6>(v.dofs.first_dof[link.second]) += force.bottomRows<6>();
  }
  std::vector<double> values = assembly_->values(matrix);
  const auto add = [&](Index dof, double spring) {
    values[std::size_t(assembly_->pattern().column_start[std::size_t(dof)])] += spring;
  };
  for (Index c = 0; c < 3; ++c) // the loads balance: one sphere can be held without force
    add(v.dofs.first_dof[0] + c, stiffness);
  constexpr double rounding = 1e-11; // what only friction that slides holds has no stiffness
  for (Index d = 0; d < v.dofs.n_dofs; ++d)
    add(d, rounding * stiffness);
  if (!factor_->factorise(values))
    return energy / v.element.cell.volume();
  for (Eigen::Index c = 0; c < 6; ++c) {
    const Eigen::VectorXd answer = factor_->back_solve(factor_->half_solve(loads.col(c)));
    energy.col(c) -= loads.transpose() * answer;
  }
  return 0.5 / v.element.cell.volume() * (energy + energy.transpose());
}

std::optional<QuasistaticVolumeStep> VolumeFollower::step(const QuasistaticVolumeState& from,
                                                          const Vec6& increment, double duration)
{
  const Mat3 change = from_mandel(increment);
  if (auto found = attempt(from, change, duration, 0))
    return std::move(found->step);
  QuasistaticVolumeState state = from;
  std::optional<QuasistaticVolumeStep> first; // in which the time of the step passes
  double hold = first_hold;
  for (int passage = 0; passage < most_passages && hold < largest_hold; ++passage) {
    const bool is_first = passage == 0;
    auto moved = attempt(state, is_first ? change : Mat3::Zero(), is_first ? duration : 0, hold);
    while (!moved && (hold *= 10) < largest_hold)
      moved = attempt(state, is_first ? change : Mat3::Zero(), is_first ? duration : 0, hold);
    if (!moved)
      return std::nullopt;
    state = moved->step.state;
    if (is_first)
      first = std::move(moved->step);
    hold = std::max(hold / 3, first_hold);
    if (auto found = attempt(state, Mat3::Zero(), 0, 0)) {
      found->step.n_passages = passage + 1;
      found->step.tangent = first->tangent;
      found->step.error = first->error;
      return std::move(found->step);
    }
  }
  return std::nullopt;
}

} // namespace dem
