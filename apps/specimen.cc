#include "apps/specimen.h"

#include "apps/csv_table.h"
#include "dem/connectivity.h"
#include "dem/lateral_pressure.h"
#include "dem/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

namespace apps {

namespace {

/// Widest gap of a listed bond, over the smaller radius [-].
constexpr double widest_gap = 5;

dem::TemperatureShift temperature_shift(const Scene::Temperature& v)
{
  if (v.shift == ShiftKind::wlf)
    return dem::WlfShift{v.wlf_c1, v.wlf_c2, v.reference};
  if (v.shift == ShiftKind::arrhenius)
    return dem::ArrheniusShift{v.activation_energy, v.reference};
  return std::monostate{};
}

dem::BondLaw bond_law(const BondLawInput& input, double shift)
{
  std::vector<dem::KelvinBranch> branches;
  for (std::size_t k = 0; k < input.kelvin_stiffness.size(); ++k)
    branches.push_back({input.kelvin_stiffness[k], input.kelvin_viscosity[k]});
  const dem::CreepLaw law =
      dem::make_creep_law(input.maxwell_stiffness, input.maxwell_viscosity, branches);
  return {dem::with_viscosities_scaled(law, shift), input.normal_to_shear, input.radius_multiplier};
}

std::vector<double> listed_strengths(const CsvTable& table, const std::string& column)
{
  const std::vector<double> strengths = table.numbers(column, "N");
  for (std::size_t row = 0; row < strengths.size(); ++row)
    if (strengths[row] < 0)
      throw std::invalid_argument(
          fmt::format("{}: column '{}': a strength must be >= 0, found {:g} "
                      "N",
                      table.place(row), column, strengths[row]));
  return strengths;
}

/// A bond over a wide gap comes from a wrong number of a particle, most often.
void refuse_wide_gaps(const dem::Assembly& assembly, const CsvTable& table)
{
  const auto& [centre, radius, material_class, density] = assembly.particles;
  for (std::size_t b = 0; b < assembly.bonds.size(); ++b) {
    const auto [i, j] = assembly.bonds.ends[b];
    const double gap = (centre[i] - centre[j]).norm() - radius[i] - radius[j];
    if (gap > widest_gap * std::min(radius[i], radius[j]))
      throw std::invalid_argument(
          fmt::format("{}: the spheres {} and {} are {:.3g} mm apart, more than {:g} times the "
                      "smaller radius; if that is meant, set Accept unusual values = true",
                      table.place(b), i, j, 1e3 * gap, widest_gap));
  }
}

/// Bonds, and strengths if there are any, from the bond file.
void read_bonds(dem::Assembly& assembly, const CsvTable& table, const std::string& file,
                bool accept_unusual)
{
  table.allow_only({"a", "b", "normal_strength", "shear_strength"});
  const std::vector<long> a = table.integers("a"), b = table.integers("b");
  std::vector<std::array<dem::Index, 2>> pairs;
  for (std::size_t row = 0; row < a.size(); ++row)
    pairs.push_back({dem::Index(a[row]), dem::Index(b[row])});
  try {
    assembly.bonds = dem::make_bonds(assembly.particles, pairs, assembly.laws, assembly.pair_laws);
  } catch (const std::invalid_argument& problem) {
    throw std::invalid_argument(fmt::format("{}: {}", file, problem.what()));
  }
  if (!accept_unusual)
    refuse_wide_gaps(assembly, table);
  const bool normal = table.find("normal_strength").has_value();
  const bool shear = table.find("shear_strength").has_value();
  if (shear && !normal)
    throw std::invalid_argument(file + ": column 'shear_strength' needs a column "
                                       "'normal_strength' (with its unit, such as "
                                       "normal_strength_N)");
  if (normal)
    assembly.strengths =
        dem::Strengths{listed_strengths(table, "normal_strength"),
                       listed_strengths(table, shear ? "shear_strength" : "normal_strength"), 0};
}

void bond_contacts(Specimen& specimen, const Scene::Specimen& v)
{
  dem::Assembly& assembly = specimen.assembly;
  const dem::ContactPairs pairs = v.bond_rule == BondRule::gap
                                      ? dem::contacts_within(assembly.particles, v.bond_gap)
                                      : dem::nearest_contacts(assembly.particles, v.mean_contacts);
  assembly.bonds =
      dem::make_bonds(assembly.particles, pairs.pairs, assembly.laws, assembly.pair_laws);
  specimen.bond_gap = pairs.gap;
}

} // namespace

dem::Strengths drawn_strengths(const Scene& scene, std::span<const std::int64_t> bond_id,
                               std::uint64_t seed)
{
  const Scene::Strength& v = scene.strength;
  dem::StrengthLaw law{dem::WeibullStrength{v.modulus, v.scale}, v.rule, v.shear_ratio};
  if (v.kind == StrengthKind::normal)
    law.distribution = dem::NormalStrength{v.mean, v.standard_deviation};
  return dem::draw_strengths(law, bond_id, seed);
}

namespace {

/// That of the packing if it knows it, else that of the scene [m].
double specimen_diameter(const LoadedScene& loaded, const Packing& packing)
{
  const double asked = loaded.scene->specimen.diameter;
  if (!packing.diameter || *packing.diameter <= 0)
    return asked;
  if (!loaded.schema->is_default("Specimen/Diameter") &&
      std::abs(asked / *packing.diameter - 1) > 1e-9)
    throw std::invalid_argument(
        fmt::format("Specimen/Diameter is {:g} mm, but the packing was made "
                    "with {:g} mm; leave the key out",
                    1e3 * asked, 1e3 * *packing.diameter));
  return *packing.diameter;
}

/// Constant pressure on the lateral surface between the platens [Pa].
std::vector<dem::ParticleLoad> confining_loads(const Packing& packing, double radius,
                                               double pressure)
{
  const auto [low, high] = packing.platens;
  std::vector<dem::ParticleLoad> loads =
      dem::lateral_pressure(packing.particles, {radius, high - low}, dem::Vec3(0, 0, low));
  for (dem::ParticleLoad& load : loads) {
    load.force *= pressure;
    load.moment *= pressure;
  }
  return loads;
}

/// Refuses what cannot carry the load, before a solver finds out in its own words.
/// \return the particles that nothing holds
std::vector<dem::Index> loose_particles(const dem::Assembly& assembly)
{
  const dem::ElasticNetwork network = dem::make_network(assembly);
  const std::vector<dem::BondStatus> intact(network.bonds.size(), dem::BondStatus::intact);
  const dem::Pieces pieces = dem::find_pieces(network, intact);
  const std::string obstacle = dem::equilibrium_obstacle(network, pieces);
  std::vector<dem::Index> loose;
  for (std::size_t i = 0; i < pieces.piece.size(); ++i)
    if (pieces.of(dem::Index(i)) == dem::PieceHold::loose)
      loose.push_back(dem::Index(i));
  if (obstacle.empty())
    return loose;
  const auto glued = [&](dem::Support support) {
    return std::ranges::count(assembly.support, support);
  };
  throw std::invalid_argument(fmt::format(
      "the specimen cannot carry the load: {} ({} particles, {} bonds, {} particles glued to the "
      "lower platen, {} to the upper one)",
      obstacle, assembly.particles.size(), assembly.bonds.size(), glued(dem::Support::bottom),
      glued(dem::Support::top)));
}

} // namespace

bool has_temperature_history(const Scene& scene)
{
  return !scene.temperature.history.empty();
}

std::optional<dem::ReducedTime> make_reduced_time(const Scene& scene)
{
  if (!has_temperature_history(scene))
    return std::nullopt;
  std::vector<dem::TemperaturePoint> points;
  for (const auto& [time, temperature] : scene.temperature.history)
    points.push_back({time, temperature});
  return dem::make_reduced_time(points, temperature_shift(scene.temperature));
}

double viscosity_shift(const Scene& scene)
{
  if (has_temperature_history(scene))
    return 1;
  return dem::shift_factor(temperature_shift(scene.temperature), scene.temperature.temperature);
}

std::vector<dem::BondLaw> bond_laws(const Scene& scene, double shift)
{
  std::vector<dem::BondLaw> laws{bond_law(scene.bonds, shift)};
  for (const auto& [name, input] : scene.more_bonds)
    laws.push_back(bond_law(*input, shift));
  return laws;
}

std::vector<dem::PairLaw> pair_laws(const Scene& scene, const dem::Particles& particles)
{
  const std::set<int> classes(particles.material_class.begin(), particles.material_class.end());
  std::vector<dem::PairLaw> pairs;
  int law = 0;
  for (const auto& [name, input] : scene.more_bonds) {
    ++law;
    for (const auto& [a, b] : input->class_pairs) {
      for (const double each : {a, b})
        if (!classes.contains(int(each)))
          throw std::invalid_argument(
              fmt::format("Bond law {}/Classes: no particle has class {:g}", name, each));
      pairs.push_back({int(a), int(b), law});
    }
  }
  for (const int a : classes)
    for (const int b : classes)
      pairs.push_back({a, b, 0}); // found after those above
  return pairs;
}

dem::PackingRequest packing_request(const Scene& scene)
{
  const Scene::Specimen& v = scene.specimen;
  dem::PackingRequest request;
  request.container = {v.diameter / 2, v.height};
  if (v.grading == "table") {
    std::vector<dem::Sieve> sieves;
    for (const auto& [opening, share] : v.grading_table)
      sieves.push_back({opening, share});
    request.grading = dem::make_grading(sieves);
  } else
    request.grading = dem::named_grading(v.grading);
  request.n_particles = std::size_t(v.n_particles);
  request.solid_fraction = v.solid_fraction;
  request.density = v.density;
  request.min_contacts = int(v.min_contacts);
  request.contact_gap = v.contact_gap;
  request.residual_stress_bound = v.residual_stress_bound;
  request.preparation_stiffness = v.preparation_stiffness;
  return request;
}

std::string packing_recipe(const Scene& scene)
{
  const Scene::Specimen& v = scene.specimen;
  std::string recipe =
      fmt::format("diameter {} m, height {} m, {} particles, solid fraction {}, grading {}",
                  v.diameter, v.height, v.n_particles, v.solid_fraction, v.grading);
  for (const auto& [opening, share] : v.grading_table)
    recipe += fmt::format(" {}:{}", opening, share);
  return recipe + fmt::format(", min contacts {}, contact gap {}, stress bound {} Pa, preparation "
                              "stiffness {} N/m, density {} kg/m3, seed {}",
                              v.min_contacts, v.contact_gap, v.residual_stress_bound,
                              v.preparation_stiffness, v.density, v.seed);
}

Specimen make_specimen(const LoadedScene& loaded, const Packing& packing)
{
  const Scene& scene = *loaded.scene;
  const Scene::Specimen& v = scene.specimen;
  Specimen specimen{};
  dem::Assembly& assembly = specimen.assembly;
  assembly.particles = packing.particles;
  assembly.support = packing.support.value_or(
      dem::platen_supports(packing.particles, packing.platens, v.platen_gap));
  specimen.viscosity_shift = viscosity_shift(scene);
  assembly.laws = bond_laws(scene, specimen.viscosity_shift);
  assembly.pair_laws = pair_laws(scene, assembly.particles);
  if (v.bond_file.empty())
    bond_contacts(specimen, v);
  else {
    const std::filesystem::path file = loaded.folder / v.bond_file;
    read_bonds(assembly, CsvTable(file, *loaded.units), file.string(), scene.accept_unusual);
  }
  if (scene.strength.kind == StrengthKind::none)
    assembly.strengths.reset();
  else if (!assembly.strengths)
    assembly.strengths =
        drawn_strengths(scene, assembly.bonds.id, std::uint64_t(scene.strength.seed));
  if (scene.load.test == TestKind::particle_loads) {
    if (packing.loads.empty())
      throw std::invalid_argument(fmt::format("{}: Test = particle loads, but no particle "
                                              "is loaded (columns fx_N to mz_N_m)",
                                              packing.origin));
    if (!packing.support)
      throw std::invalid_argument(fmt::format("{}: particle loads need a column 'held' that says "
                                              "what holds each particle: bottom or free",
                                              packing.origin));
    assembly.loads = packing.loads;
  }
  const double diameter = specimen_diameter(loaded, packing);
  assembly.area = std::numbers::pi * diameter * diameter / 4;
  if (scene.load.confining_stress > 0)
    assembly.confinement = confining_loads(packing, diameter / 2, scene.load.confining_stress);
  assembly.gauge_length = v.gauge_length.value_or(packing.platens.high - packing.platens.low);
  dem::validate(assembly);
  specimen.loose = loose_particles(assembly);
  return specimen;
}

} // namespace apps
