#include "dem/climb.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem {

namespace {

/// Times at which the strain history is handed over, between each two changes.
constexpr int samples_per_segment = 8;

StrainPath path_of(const EventsModel& from, const EventsSolver& solver, const EventsState& state,
                   double until)
{
  StrainPath path;
  const std::vector<LoadSegment>& segments = state.history.segments;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const double begin = start(segments[s]);
    const double end = s + 1 < segments.size() ? start(segments[s + 1]) : until;
    const int n = end > begin ? samples_per_segment : 0;
    for (int k = 0; k <= n; ++k) {
      const double time = k == n ? end : begin + (end - begin) * std::pow(double(k) / n, 3);
      const double smooth = smooth_displacement(segments[s], from.creep, time);
      const auto broken = std::ranges::upper_bound(state.breakages, time, {}, &Breakage::time);
      path.push_back({time,
                      displacement(segments[s], from.creep, time),
                      smooth,
                      displacement_rate(segments[s], from.creep, time),
                      0,
                      std::distance(state.breakages.begin(), broken),
                      {}});
    }
  }
  path.back().force = solver.response(state, until).force;
  return path;
}

/// Memory of a bond in its frame, from what the springs and the Kelvin branches did.
void set_memory(Links& links, std::size_t b, const Assembly& assembly,
                const BondDeformation& elastic, const std::vector<BondDeformation>& kelvin)
{
  const Link& link = links.link[b];
  const std::array<double, 6> w = mode_multipliers(link, assembly);
  const double spring = assembly.laws[link.law].creep.maxwell_stiffness;
  const Vec3 axis[] = {link.frame.normal, link.frame.tangent, link.frame.second_tangent()};
  const auto part = [&](const BondDeformation& d, int mode) {
    return mode < 3 ? axis[mode].dot(d.delta) : axis[mode - 3].dot(d.phi);
  };
  double* memory = links.memory_of(b);
  for (int mode = 0; mode < 6; ++mode, memory += links.n_parts) {
    memory[0] = w[mode] * spring * part(elastic, mode);
    for (std::size_t k = 0; k < kelvin.size(); ++k)
      memory[1 + k] = w[mode] * part(kelvin[k], mode);
  }
}

/// Without the contacts of pairs that have no bond, which were found where the bodies were at the
/// start.
Links bonds_only(Links links, std::size_t n_bonds)
{
  links.link.resize(n_bonds);
  links.memory.resize(n_bonds * 6 * std::size_t(links.n_parts));
  return links;
}

} // namespace

QuasistaticState climb(const QuasistaticModel& model, const EventsModel& from,
                       const EventsSolver& solver, const EventsState& state, double time)
{
  QuasistaticState result = start(model);
  const Assembly& assembly = model.assembly;
  const Eigen::VectorXd moved = solver.displacements(state, time);
  const Eigen::VectorXd elastic = solver.elastic_displacements(state, time);
  const std::vector<Eigen::VectorXd> kelvin = solver.kelvin_displacements(state, time);
  const bool finite = model.settings.geometry == Geometry::finite;
  std::vector<Vec3> turn(result.centre.size(), Vec3::Zero());
  for (Index i = 0; i < model.bodies.n_particles(); ++i) {
    const ParticleMotion motion = dem::motion(from.network, moved, i);
    result.centre[i] += motion.displacement;
    result.rotation[i] = turn[i] = motion.rotation;
  }
  result.path = path_of(from, solver, state, time);
  const double platen = result.path.back().displacement;
  if (loaded_by_platen(assembly))
    for (Index i = 0; i <= model.bodies.upper_platen(); ++i)
      if (model.bodies.support[i] == Support::top)
        result.centre[i].z() =
            platen + (i < model.bodies.n_particles() ? assembly.particles.centre[i].z()
                                                     : packing_extent(assembly.particles).high);
  for (std::size_t b = 0; b < assembly.bonds.size(); ++b) {
    Link& link = result.links.link[b];
    const BondStatus status = state.damage.status[b];
    std::vector<BondDeformation> branches;
    for (const Eigen::VectorXd& field : kelvin)
      branches.push_back(deformation(from.network, from.network.bonds[b], field));
    set_memory(result.links, b, assembly, deformation(from.network, from.network.bonds[b], elastic),
               branches);
    if (finite) {
      const Vec3 r = branch(link, model.bodies, result.centre);
      link.distance = r.norm();
      const Vec3 mean = 0.5 * (half_tangent(turn[link.first]) + half_tangent(turn[link.second]));
      link.frame = carried(link.frame, mean, r / link.distance);
    }
    if (status == BondStatus::intact)
      continue;
    link.kind = LinkKind::contact;
    double* memory = result.links.memory_of(b);
    if (status == BondStatus::pressed && memory[0] < 0) {
      std::fill_n(memory + result.links.n_parts, 5 * result.links.n_parts, 0.0);
      link.touch = link.distance;
    } else
      open_link(result.links, b,
                model.settings.after_breakage == AfterBreakage::leave
                    ? -std::numeric_limits<double>::infinity()
                    : std::min(model.initial_distance[b], link.distance));
  }
  if (finite)
    result.links = find_contacts(bonds_only(std::move(result.links), assembly.bonds.size()),
                                 assembly, model.bodies, result.centre, model.skin);
  for (std::size_t k = 0; k < result.links.link.size(); ++k)
    result.path.back().energy.stored += stored_energy(result.links, k, assembly);
  result.path.back().energy.work = result.path.back().energy.stored;
  result.breakages = state.breakages;
  return result;
}

} // namespace dem
