#include "dem/quasistatic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem {

namespace {

/// Gap up to which pairs of particles are watched, over the smallest radius.
constexpr double relative_skin = 0.1;

void validate(const QuasistaticSettings& settings)
{
  const auto require = [](bool condition, const char* what, double found) {
    if (!condition)
      throw std::invalid_argument(fmt::format("quasi-static solver: {}, found {:g}", what, found));
  };
  require(settings.strain_per_step > 0, "the strain per step must be > 0",
          settings.strain_per_step);
  require(settings.error_tolerance > 0, "the error tolerance must be > 0",
          settings.error_tolerance);
  require(settings.breakage_batch > 0, "the breakage batch must be >= 1",
          double(settings.breakage_batch));
  require(settings.residual_tolerance > 0 && settings.residual_tolerance < 1,
          "the residual tolerance must lie in (0, 1)", settings.residual_tolerance);
  require(settings.passage_limit > 0, "the strain of a passage must be > 0",
          settings.passage_limit);
  require(settings.regularisation > 0, "the regularisation must be > 0", settings.regularisation);
  require(settings.friction >= 0, "the friction must be >= 0", settings.friction);
}

/// Forces of loads on particles, on the dofs; what acts on held particles goes into the platens.
Eigen::VectorXd on_dofs(std::span<const ParticleLoad> loads, const LinkDofs& dofs)
{
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(dofs.n_dofs);
  for (const ParticleLoad& each : loads)
    if (const Index dof = dofs.first_dof[each.particle]; dof >= 0) {
      sum.segment<3>(dof) += each.force;
      sum.segment<3>(dof + 3) += each.moment / dofs.radius[each.particle];
    }
  return sum;
}

} // namespace

QuasistaticModel make_quasistatic_model(const Assembly& assembly, const Loading& loading,
                                        const RateLaw& rate_law,
                                        const QuasistaticSettings& settings, double strain_limit,
                                        std::optional<ReducedTime> clock)
{
  validate(assembly);
  validate(loading);
  validate(settings);
  const bool by_force = loading.control == Loading::Control::force;
  if (!loaded_by_platen(assembly) && (!by_force || loading.true_stress))
    throw std::invalid_argument("loads on particles have a history of their factor only, no "
                                "displacement or true stress");
  QuasistaticModel model;
  model.assembly = assembly;
  model.loading = loading;
  model.rate_law = rate_law;
  model.settings = settings;
  model.strain_limit = strain_limit;
  model.bodies = make_bodies(assembly);
  model.dofs = make_dofs(model.bodies, by_force && loaded_by_platen(assembly));
  model.unit_load = on_dofs(assembly.loads, model.dofs);
  if (model.dofs.platen_dof >= 0)
    model.unit_load[model.dofs.platen_dof] = 1;
  model.confinement = on_dofs(assembly.confinement, model.dofs);
  model.clock = std::move(clock);
  model.scheme = by_force ? StepScheme::force_linear : StepScheme::displacement_linear;
  for (const auto& [i, j] : assembly.bonds.ends)
    model.initial_distance.push_back(
        (assembly.particles.centre[i] - assembly.particles.centre[j]).norm());
  model.skin = assembly.particles.size() > 0
                   ? relative_skin * std::ranges::min(assembly.particles.radius)
                   : 0;
  return model;
}

Eigen::VectorXd carried_confinement(const QuasistaticModel& model, const Links& links)
{
  constexpr int enough = 3; // contacts; a bond counts as so many
  if (model.confinement.isZero(0))
    return model.confinement;
  std::vector<int> n_held(model.bodies.radius.size(), 0);
  for (const Link& link : links.link)
    if (link.closed)
      for (const Index body : {link.first, link.second})
        n_held[body] += link.kind == LinkKind::bond ? enough : 1;
  Eigen::VectorXd carried = model.confinement;
  for (std::size_t i = 0; i < n_held.size(); ++i)
    if (const Index dof = model.dofs.first_dof[i]; dof >= 0 && n_held[i] < enough)
      carried.segment<6>(dof).setZero();
  return carried;
}

QuasistaticState start(const QuasistaticModel& model)
{
  QuasistaticState state;
  const Assembly& assembly = model.assembly;
  state.centre = assembly.particles.centre;
  const PlatenHeights platens = packing_extent(assembly.particles);
  state.centre.push_back({0, 0, platens.low});
  state.centre.push_back({0, 0, platens.high});
  state.rotation.assign(state.centre.size(), Vec3::Zero());
  state.links = make_links(assembly, model.bodies, state.centre);
  if (model.settings.geometry == Geometry::finite && assembly.particles.size() > 0)
    state.links =
        find_contacts(std::move(state.links), assembly, model.bodies, state.centre, model.skin);
  state.velocity = Eigen::VectorXd::Zero(model.dofs.n_dofs);
  state.path.push_back({model.loading.points.front().time, 0, 0, 0, 0, 0, {}});
  return state;
}

BodyMotion motion(const QuasistaticModel& model, const QuasistaticState& state, Index particle)
{
  return {state.centre[particle] - model.assembly.particles.centre[particle],
          state.rotation[particle]};
}

BondLoad link_load(const Links& links, std::size_t k)
{
  const BondFrame& frame = links.link[k].frame;
  const double* memory = links.memory_of(k);
  const auto part = [&](int mode) { return memory[mode * links.n_parts]; };
  const Vec3 second = frame.second_tangent();
  return {part(0) * frame.normal + part(1) * frame.tangent + part(2) * second,
          part(3) * frame.normal + part(4) * frame.tangent + part(5) * second};
}

} // namespace dem
