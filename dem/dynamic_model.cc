#include "dem/critical_step.h"
#include "dem/dynamics.h"
#include "dem/network_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace dem {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void validate(const DynamicSettings& settings)
{
  const auto require = [](bool condition, const char* what, double found) {
    if (!condition)
      throw std::invalid_argument(fmt::format("explicit solver: {}, found {:g}", what, found));
  };
  require(settings.viscosity_scaling > 0 && std::isfinite(settings.viscosity_scaling),
          "the viscosity scaling must be > 0", settings.viscosity_scaling);
  require(settings.step_safety > 0, "the step safety must be > 0", settings.step_safety);
  require(settings.damping >= 0 && settings.damping < 1, "the damping must lie in [0, 1)",
          settings.damping);
  require(settings.friction >= 0, "the friction must be >= 0", settings.friction);
  require(settings.ramp_periods >= 0, "the ramp must be >= 0", settings.ramp_periods);
  require(settings.servo_gain > 0 && settings.servo_gain <= 1, "the servo gain must lie in (0, 1]",
          settings.servo_gain);
}

/// Particles in layers of height, so that near ones have near slots.
std::vector<Index> slots_by_height(const Particles& particles)
{
  std::vector<Index> order(particles.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](Index i) { return particles.centre[i].z(); });
  return order;
}

/// Static stiffness of the specimen between its platens [N/m]; 0 if it has none.
double axial_stiffness(const ElasticNetwork& network)
{
  if (network.platen_dof < 0)
    return 0;
  const NetworkSolver solver(network, undamaged(network));
  return solver.response() ? 1 / (*solver.response())[network.platen_dof] : 0;
}

double total_mass(const Assembly& assembly)
{
  double volume = 0;
  for (const double r : assembly.particles.radius)
    volume += sphere_volume(r);
  return volume * assembly.particles.density;
}

/// Change of the mean platen force per displacement while the free particles stand still [N/m].
double stiffness_on_platens(const ElasticNetwork& network)
{
  double sum = 0;
  for (const ElasticNetwork::Bond& bond : network.bonds) {
    const bool a = network.support[bond.ends[0]] == Support::free;
    const bool b = network.support[bond.ends[1]] == Support::free;
    const double squared = bond.normal.z() * bond.normal.z();
    const double along = bond.stiffness.normal * squared + bond.stiffness.shear * (1 - squared);
    if (a != b)
      sum += 0.25 * along; // one platen moves by half the displacement and is half of the mean
    else if (!a && network.support[bond.ends[0]] != network.support[bond.ends[1]])
      sum += along;
  }
  return sum;
}
} // namespace

DynamicModel make_dynamic_model(const Assembly& assembly, const Loading& loading,
                                const RateLaw& rate_law, const DynamicSettings& settings,
                                double strain_limit, double time_step)
{
  validate(assembly);
  validate(loading);
  validate(settings);
  refuse_confinement(assembly, "dynamic");
  if (!loaded_by_platen(assembly) &&
      (loading.control == Loading::Control::displacement || loading.true_stress))
    throw std::invalid_argument("loads on particles have a history of their factor only, no "
                                "displacement or true stress");
  DynamicModel model;
  model.assembly = assembly;
  model.loading = loading;
  model.rate_law = rate_law;
  model.settings = settings;
  model.strain_limit = strain_limit;
  model.platens = packing_extent(assembly.particles);
  const ElasticNetwork network = make_network(assembly);
  // Where it brakes, local damping multiplies the force by 1 + damping: the step must feel that.
  model.time_step = time_step > 0 ? time_step
                                  : settings.step_safety / std::sqrt(1 + settings.damping) *
                                        critical_time_step(network, assembly.particles.density);
  if (!(model.time_step < infinity))
    throw std::invalid_argument("explicit solver: no bond limits the step; give one");
  const double stiffness = axial_stiffness(network);
  // clamped at one end, driven at the other: a quarter wave, with the mass spread evenly
  model.axial_period = stiffness > 0 ? 4 * std::sqrt(total_mass(assembly) / stiffness) : 0;
  model.ramp_time = settings.ramp_periods * model.axial_period;
  model.platen_stiffness = std::max(stiffness_on_platens(network), stiffness);

  model.particle = slots_by_height(assembly.particles);
  model.slot.resize(model.particle.size());
  for (std::size_t s = 0; s < model.particle.size(); ++s)
    model.slot[model.particle[s]] = Index(s);
  for (const BondLaw& law : assembly.laws)
    model.n_modes = std::max(model.n_modes, int(relaxation_spectrum(law.creep).size()));
  for (const BondLaw& law : assembly.laws)
    model.factors.push_back(
        step_factors(with_viscosities_scaled(law.creep, settings.viscosity_scaling),
                     model.time_step, model.n_modes));
  for (const Index i : model.particle) {
    const double r = assembly.particles.radius[i];
    const double mass = assembly.particles.density * sphere_volume(r);
    model.radius.push_back(r);
    model.inverse_mass.push_back(1 / mass);
    model.inverse_inertia.push_back(1 / (0.4 * mass * r * r));
    model.support.push_back(assembly.support[i]);
    model.material_class.push_back(assembly.particles.material_class[i]);
  }
  model.force.assign(model.particle.size(), Vec3::Zero());
  model.moment = model.force;
  for (const ParticleLoad& load : assembly.loads) {
    model.force[model.slot[load.particle]] += load.force;
    model.moment[model.slot[load.particle]] += load.moment;
  }
  for (std::size_t s = 0; s < model.force.size(); ++s)
    if (model.support[s] == Support::free &&
        !(model.force[s].isZero(0) && model.moment[s].isZero(0)))
      model.loaded.push_back(Index(s));
  return model;
}

} // namespace dem
