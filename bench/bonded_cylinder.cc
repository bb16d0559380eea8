#include "bench/bonded_cylinder.h"

#include "bench/measurement.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace bench {

namespace {

std::ifstream opened(const std::filesystem::path& file)
{
  std::ifstream stream(file);
  if (!stream)
    throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  return stream;
}

/// Rows of numbers under a line of names.
std::vector<std::vector<double>> rows_of(const std::filesystem::path& file)
{
  std::ifstream stream = opened(file);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    std::vector<double>& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');)
      row.push_back(std::stod(field));
  }
  return rows;
}

dem::Particles read_particles(const std::filesystem::path& file, double density)
{
  dem::Particles particles;
  particles.density = density;
  for (const std::vector<double>& row : rows_of(file)) {
    particles.centre.emplace_back(row[0], row[1], row[2]);
    particles.radius.push_back(row[3]);
  }
  particles.material_class.assign(particles.size(), 0);
  return particles;
}

/// Spheres whose centre lies within a depth of the ends of the packing are held.
std::vector<dem::Support> supports(const dem::Particles& particles, double depth)
{
  const dem::PlatenHeights ends = dem::packing_extent(particles);
  std::vector<dem::Support> support;
  for (const dem::Vec3& centre : particles.centre)
    support.push_back(centre.z() > ends.high - depth ? dem::Support::top
                      : centre.z() < depth           ? dem::Support::bottom
                                                     : dem::Support::free);
  return support;
}

dem::CreepLaw creep_law(const BondedCylinder& scene, Law law)
{
  const double k = scene.stiffness.normal, kelvin = scene.kelvin_stiffness * k;
  if (law == Law::elastic)
    return dem::make_creep_law(k, std::nullopt, {});
  return dem::burgers(k, k * scene.relaxation_time, kelvin, kelvin * scene.retardation_time);
}

dem::Assembly make_assembly(const BondedCylinder& scene, Law law)
{
  const dem::PlatenHeights ends = dem::packing_extent(scene.particles);
  dem::Assembly assembly;
  assembly.particles = scene.particles;
  assembly.support = supports(scene.particles, scene.platen_depth);
  assembly.laws = {{creep_law(scene, law), scene.stiffness.normal / scene.stiffness.shear, 1}};
  assembly.pair_laws = {{0, 0, 0}};
  assembly.bonds = dem::make_bonds(scene.particles, scene.pairs, assembly.laws, assembly.pair_laws);
  assembly.bonds.contact_offset.assign(scene.pairs.size(), 0.0);
  const std::vector<double> strength(scene.pairs.size(), scene.bond_strength);
  assembly.strengths = dem::Strengths{strength, strength};
  assembly.area = 1;
  assembly.gauge_length = ends.high - ends.low;
  return assembly;
}

dem::DynamicSettings undamped()
{
  dem::DynamicSettings settings;
  settings.damping = 0;
  settings.ramp_periods = 0;
  return settings;
}

} // namespace

std::string name_of(Law law)
{
  return law == Law::elastic ? "elastic" : "burgers";
}

Law law_named(const std::string& name)
{
  for (const Law law : {Law::elastic, Law::burgers})
    if (name == name_of(law))
      return law;
  throw std::invalid_argument(fmt::format("'{}' is not a law: elastic or burgers", name));
}

BondedCylinder read_bonded_cylinder(const std::filesystem::path& folder)
{
  const auto numbers = nlohmann::json::parse(opened(folder / "cylinder.json"));
  const auto number = [&](const char* key) { return numbers.at(key).get<double>(); };
  BondedCylinder scene;
  scene.particles = read_particles(folder / "cylinder.particles.csv", number("density_kg_m3"));
  for (const std::vector<double>& row : rows_of(folder / "cylinder.bonds.csv"))
    scene.pairs.push_back({dem::Index(row[0]), dem::Index(row[1])});
  scene.stiffness = {number("normal_stiffness_N_m"), number("shear_stiffness_N_m"),
                     number("torsion_stiffness_N_m"), number("bending_stiffness_N_m")};
  scene.kelvin_stiffness = number("kelvin_over_maxwell_stiffness");
  scene.retardation_time = number("retardation_time_s");
  scene.relaxation_time = number("relaxation_time_s");
  scene.bond_strength = number("bond_strength_N");
  scene.platen_depth = number("platen_depth_m");
  scene.platen_speed = number("platen_speed_m_s");
  scene.time_step = number("time_step_s");
  scene.n_steps = numbers.at("steps").get<long>();
  return scene;
}

double reference_force(const std::filesystem::path& folder, Law law)
{
  const auto numbers = nlohmann::json::parse(opened(folder / "cylinder.json"));
  return numbers.at("platen_force_N").at(name_of(law)).get<double>();
}

ExplicitRun start_run(const BondedCylinder& scene, Law law)
{
  const dem::Loading loading =
      dem::ramp(dem::Loading::Control::displacement, -scene.platen_speed, 1.0);
  const dem::RateLaw constant_strength{0, 1, 0, 0, 0};
  ExplicitRun run{dem::make_dynamic_model(make_assembly(scene, law), loading, constant_strength,
                                          undamped(), INFINITY, scene.time_step),
                  {}};
  // the platens hold spheres by their centres and touch no others
  run.model.platens.low -= scene.platen_depth;
  run.model.platens.high += scene.platen_depth;
  run.state = dem::start(run.model);
  for (std::size_t lane = 0; lane < run.state.bonds.bond.size(); ++lane)
    if (run.state.bonds.bond[lane] >= 0)
      dem::set_stiffness(run.state.bonds, dem::Index(lane), scene.stiffness);
  // Here both platens move at half the speed. Seen from the lower one, the upper one moves and the
  // spheres rest.
  for (std::size_t s = 0; s < run.model.support.size(); ++s)
    run.state.velocity[6 * s + 2] = 0.5 * scene.platen_speed;
  return run;
}

double timed_steps(ExplicitRun& run, long n_steps, int n_threads)
{
  const double work = double(n_steps) * double(run.model.assembly.bonds.size());
  const Stopwatch watch;
  run.state = dem::advance(run.model, std::move(run.state), n_steps, n_threads);
  return watch.seconds() / work;
}

} // namespace bench
