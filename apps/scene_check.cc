#include "apps/scene.h"

#include "apps/continuum_check.h"
#include "apps/cycles.h"
#include "apps/findings.h"
#include "apps/specimen.h"
#include "apps/study_factors.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace apps {

namespace {

void check_specimen(const Scene& scene, Findings& findings)
{
  const Scene::Specimen& v = scene.specimen;
  if (v.source == SpecimenSource::file && v.file.empty())
    findings.error("Specimen/File", "Source = file needs a File");
  if (v.source == SpecimenSource::file && v.file.ends_with(".csv") &&
      scene.load.test != TestKind::particle_loads && !findings.is_set("Specimen/Diameter"))
    findings.tell(
        Diagnostic::Kind::warning, "Specimen/Diameter",
        fmt::format("a CSV file does not say the area on which the stress acts; the default "
                    "of {:g} mm is taken",
                    1e3 * v.diameter));
  if (v.source == SpecimenSource::generate && !v.bond_file.empty())
    findings.error("Specimen/Bond file", "a list of bonds needs Source = file");
  if (v.source == SpecimenSource::generate) {
    const auto names = dem::grading_names();
    if (v.grading == "table") {
      try {
        std::vector<dem::Sieve> sieves;
        for (const auto& [opening, share] : v.grading_table)
          sieves.push_back({opening, share});
        dem::make_grading(sieves);
      } catch (const std::invalid_argument& problem) {
        findings.error("Specimen/Grading table", problem.what());
      }
    } else if (std::find(names.begin(), names.end(), v.grading) == names.end()) {
      try {
        dem::named_grading(v.grading);
      } catch (const std::invalid_argument& problem) {
        findings.error("Specimen/Grading", std::string(problem.what()) + ", table");
      }
    }
    if (!v.grading_table.empty() && v.grading != "table")
      findings.error("Specimen/Grading table", "is used with Grading = table only");
  }
}

void check_law(const std::string& section, const BondLawInput& law, bool accept_unusual,
               Findings& findings)
{
  if (law.kelvin_stiffness.size() != law.kelvin_viscosity.size())
    findings.error(section + "/Kelvin viscosity",
                   fmt::format("there are {} Kelvin stiffnesses and {} viscosities; give one of "
                               "each per branch",
                               law.kelvin_stiffness.size(), law.kelvin_viscosity.size()));
  if (law.radius_multiplier > 1)
    findings.tell(Diagnostic::Kind::warning, section + "/Radius multiplier",
                  "a multiplier above 1 makes the bond wider than the smaller sphere");
  // spheres of some millimetres: stiffness over diameter is a modulus
  const double modulus = law.maxwell_stiffness / 5e-3;
  if (!accept_unusual && (modulus < 1e5 || modulus > 1e12))
    findings.error(section + "/Maxwell stiffness",
                   fmt::format("{:g} N/m makes a modulus of about {:.2g} Pa, outside 1e5 to 1e12 "
                               "Pa; if that is meant, set Accept unusual values = true",
                               law.maxwell_stiffness, modulus));
}

/// Classes are whole numbers, and each pair of them has one law.
void check_classes(const Scene& scene, Findings& findings)
{
  std::map<std::pair<double, double>, std::string> seen;
  for (const auto& [name, law] : scene.more_bonds) {
    const std::string key = "Bond law " + name + "/Classes";
    if (law->class_pairs.empty())
      findings.error(key, "say for which pairs of classes the law is, such as '0: 1'");
    for (const auto& [a, b] : law->class_pairs) {
      if (a != std::floor(a) || b != std::floor(b) || std::abs(a) > 1e9 || std::abs(b) > 1e9)
        findings.error(key, fmt::format("'{:g}: {:g}' are not whole numbers", a, b));
      const auto [first, is_new] = seen.insert({std::minmax(a, b), name});
      if (!is_new)
        findings.error(key, fmt::format("the pair {:g}: {:g} has a law already, 'Bond law {}'", a,
                                        b, first->second));
    }
  }
}

/// What the laws together say, and whether the solver can take them.
void check_laws(const Scene& scene, Findings& findings)
{
  if (findings.has_errors())
    return; // laws may not be possible
  double shift = 1;
  try {
    shift = viscosity_shift(scene);
  } catch (const std::invalid_argument& problem) {
    findings.error("Temperature/Temperature", problem.what());
  }
  try {
    make_reduced_time(scene);
  } catch (const std::invalid_argument& problem) {
    findings.error("Temperature/Temperature history", problem.what());
  }
  try {
    const std::vector<dem::BondLaw> laws = bond_laws(scene, shift);
    if ((scene.solver == SolverChoice::linear || scene.solver == SolverChoice::events) &&
        !dem::proportional_laws(laws))
      findings.error("Solver", "the bonds follow several laws that are not proportional, so that "
                               "their forces depend on history; use dynamic or auto");
  } catch (const std::invalid_argument& problem) {
    findings.error("Bonds/Maxwell stiffness", problem.what());
  }
}

void check_preset(const Scene& scene, Findings& findings)
{
  if (scene.preset != BondPreset::none)
    return;
  std::vector<std::string> needed{"Bonds/Maxwell stiffness", "Bonds/Maxwell viscosity",
                                  "Bonds/Kelvin stiffness", "Bonds/Kelvin viscosity",
                                  "Strength/Distribution"};
  if (scene.strength.kind == StrengthKind::normal)
    needed.insert(needed.end(),
                  {"Strength/Mean", "Strength/Standard deviation", "Strength/Nonpositive draws"});
  if (scene.strength.kind == StrengthKind::weibull)
    needed.insert(needed.end(), {"Strength/Modulus", "Strength/Scale"});
  for (const std::string& key : needed)
    if (!findings.is_set(key))
      findings.error(key, fmt::format("Preset = none: '{}' must be set", key));
}

void check_history(const std::vector<std::pair<double, double>>& history, const std::string& key,
                   Findings& findings)
{
  dem::Loading loading;
  for (const auto& [time, value] : history)
    loading.points.push_back({time, value});
  try {
    dem::validate(loading);
  } catch (const std::invalid_argument& problem) {
    findings.error(key, problem.what());
  }
}

void check_cycles(const Scene::Load& v, const dem::CyclicLoad& load, Findings& findings)
{
  const bool is_sine = v.test == TestKind::sine, is_block = v.test == TestKind::block_pulses;
  if (load.amplitude == 0)
    findings.error(is_sine ? "Loading/Stress amplitude" : "Loading/Peak stress",
                   "pulses of 0 lead nowhere");
  if (is_block && load.rest_time == 0)
    findings.error("Loading/Rest time", "block pulses without a rest are one pulse");
  if (!is_block && load.n_intervals % 4 != 0)
    findings.error("Loading/Points per pulse", "must be a multiple of 4");
  constexpr double most_points = 1e7;
  if (const double n = double(load.n_cycles) * double(load.n_intervals); n > most_points)
    findings.error("Loading/Cycles",
                   fmt::format("{} cycles of {} points make {:.2g} points in time, more than {:g}",
                               load.n_cycles, load.n_intervals, n, most_points));
}

/// The resilient strain of a cycle cancels out of its mean rate over whole cycles only.
void check_rate_window(const Scene& scene, const dem::CyclicLoad& load, Findings& findings)
{
  const dem::RateLaw& law = scene.strength.rate_law;
  if (scene.strength.kind == StrengthKind::none || law.exponent == 0)
    return;
  const double cycle = dem::period(load), n_cycles = law.window / cycle;
  const double longest = law.window_fraction * dem::cycle_end(load, load.n_cycles);
  if (n_cycles < 0.5 || std::abs(n_cycles - std::round(n_cycles)) > 1e-9 || longest > law.window)
    findings.tell(Diagnostic::Kind::warning, "Strength/Rate window",
                  fmt::format("the strain rate that counts for the strengths is averaged over a "
                              "time that is not a whole number of cycles, so that resilient "
                              "strain counts, too; Rate window = {:g} s with Rate window fraction "
                              "= 0 leaves the permanent one",
                              cycle));
}

void check_loading(const Scene& scene, Findings& findings)
{
  const Scene::Load& v = scene.load;
  if (v.test == TestKind::stress_history)
    check_history(v.stress_history, "Loading/Stress history", findings);
  if (v.test == TestKind::strain_history)
    check_history(v.strain_history, "Loading/Strain history", findings);
  if (v.test == TestKind::constant_rate && v.strain_rate == 0)
    findings.error("Loading/Strain rate", "a constant rate of 0 leads nowhere");
  if (v.test == TestKind::constant_rate && !v.end_strain)
    findings.error("Loading/End strain", "constant rate needs an End strain");
  if (v.release_time && *v.release_time >= v.end_time)
    findings.error("Loading/Release time", "must come before the End time");
  if (v.test == TestKind::boundary_loads)
    check_history(v.factor_history.empty() ? std::vector<std::pair<double, double>>{{0, 1}, {1, 1}}
                                           : v.factor_history,
                  "Loading/Load factor history", findings);
  if (v.test == TestKind::boundary_loads && scene.solver != SolverChoice::continuum)
    findings.error("Loading/Test", "boundary loads need Solver = continuum");
  if (v.test == TestKind::particle_loads && scene.specimen.source != SpecimenSource::file)
    findings.error("Loading/Test", "particle loads come from a particle file: Source = file");
  if (v.true_stress && (v.test == TestKind::constant_rate || v.test == TestKind::strain_history ||
                        v.test == TestKind::particle_loads))
    findings.error("Loading/True stress", "goes with tests at prescribed stress only");
  if (v.confining_stress > 0 && v.test == TestKind::particle_loads)
    findings.error("Loading/Confining stress", "needs a specimen between platens");
  if (const auto cyclic = cyclic_load(scene, 1)) {
    check_cycles(v, *cyclic, findings);
    check_rate_window(scene, *cyclic, findings);
  }
}

void check_strength(const Scene& scene, Findings& findings)
{
  const Scene::Strength& v = scene.strength;
  if (v.kind != StrengthKind::none && v.rate_law.exponent > 0 && v.rate_law.floor == 0 &&
      v.rate_law.window == 0 && v.rate_law.window_fraction == 0)
    findings.tell(Diagnostic::Kind::warning, "Strength/Rate floor",
                  "without window and floor the strength falls to 0 as the strain rate does");
}

void check_temperature(const Scene& scene, Findings& findings)
{
  if (!has_temperature_history(scene))
    return;
  if (scene.temperature.shift == ShiftKind::none && scene.solver != SolverChoice::continuum)
    findings.error("Temperature/Temperature history",
                   "without a Shift law the temperature has no effect");
  if (findings.is_set("Temperature/Temperature"))
    findings.error("Temperature/Temperature", "give either Temperature or Temperature history");
}

void check_element(const Scene& scene, Findings& findings)
{
  const VolumeElementInput& v = scene.element;
  const std::string section = "Volume element/";
  if (v.last_time <= v.first_time)
    findings.error(section + "Last time", "must be later than First time");
  if (v.source != ElementSource::grow && !v.sizes.empty())
    findings.error(section + "Sizes", "is for Source = grow only");
  if (!v.edges.empty() && v.sizes.size() > 1)
    findings.error(section + "Edges", "fixes the cell: leave Sizes out, or Edges");
  if (!v.edges.empty() || v.source != ElementSource::grow)
    try {
      cell_of(v.edges);
    } catch (const std::invalid_argument& problem) {
      findings.error(section + "Edges", problem.what());
    }
  if (v.source == ElementSource::file && scene.specimen.source != SpecimenSource::file)
    findings.error(section + "Source", "file needs Specimen/Source = file with its File");
  if (v.source == ElementSource::cut && v.condition == dem::BoundaryCondition::periodic)
    findings.error(section + "Boundary condition",
                   "a cut element has no periodic one; use kinematic or uniform traction");
  if (v.temperatures.size() > 1 && scene.temperature.shift == ShiftKind::none)
    findings.tell(Diagnostic::Kind::warning, section + "Modulus temperatures",
                  "without a Shift law all temperatures give the same");
}

void check_solver(const Scene& scene, Findings& findings)
{
  const bool others = scene.solver == SolverChoice::linear ||
                      scene.solver == SolverChoice::events || scene.solver == SolverChoice::dynamic;
  if (others && has_temperature_history(scene))
    findings.error("Solver", "takes no Temperature history; use quasistatic");
  if (others && scene.load.confining_stress > 0)
    findings.error("Solver", "takes no Confining stress; use quasistatic");
  if (scene.solver == SolverChoice::linear && scene.load.true_stress)
    findings.error("Solver", "linear takes nominal stress only; use events");
  if (scene.solver == SolverChoice::events && scene.after_breakage == dem::AfterBreakage::friction)
    findings.error("Bonds/After breakage", "friction needs the solver dynamic");
}

/// End of the load history [s].
double end_time(const Scene& scene)
{
  const Scene::Load& v = scene.load;
  if (const auto cyclic = cyclic_load(scene, 1))
    return dem::cycle_end(*cyclic, cyclic->n_cycles);
  if (v.test == TestKind::constant_rate)
    return v.end_strain.value_or(0) / std::abs(v.strain_rate);
  if (v.test == TestKind::stress_history)
    return v.stress_history.empty() ? 0 : v.stress_history.back().first;
  if (v.test == TestKind::strain_history)
    return v.strain_history.empty() ? 0 : v.strain_history.back().first;
  return v.end_time;
}

void check_output(const Scene& scene, Findings& findings)
{
  const double end = end_time(scene);
  for (const double time : scene.output.snapshot_times)
    if (time > end)
      findings.tell(Diagnostic::Kind::warning, "Output/Snapshot times",
                    fmt::format("{:g} s comes after the end of the test at {:g} s", time, end));
}

void check_measured(const Scene& scene, Findings& findings)
{
  if (!scene.output.measured.empty() && scene.load.test != TestKind::creep)
    findings.error("Output/Measured", "only a creep test can be compared (Loading/Test = creep)");
}

void check_study(const Scene& scene, Findings& findings)
{
  for (const std::string& problem : factor_problems(scene.study.vary, scene.study.values)) {
    const std::size_t colon = problem.find(": ");
    findings.error("Study/" + problem.substr(0, colon), problem.substr(colon + 2));
  }
  if (!scene.study.scenes.empty() && !scene.study.vary.empty())
    findings.error("Study/Scene files",
                   "each scene varies keys of its own; leave out Vary and Values");
}

} // namespace

std::vector<Diagnostic> check_consistency(const Scene& scene, const Schema& schema)
{
  Findings findings(schema);
  check_specimen(scene, findings);
  check_law("Bonds", scene.bonds, scene.accept_unusual, findings);
  for (const auto& [name, law] : scene.more_bonds)
    check_law("Bond law " + name, *law, scene.accept_unusual, findings);
  check_classes(scene, findings);
  check_laws(scene, findings);
  if (!scene.accept_unusual && (scene.specimen.density < 500 || scene.specimen.density > 10000))
    findings.error("Specimen/Density",
                   fmt::format("{:g} kg/m^3 is outside 500 to 10000; if that is meant, set Accept "
                               "unusual values = true",
                               scene.specimen.density));
  check_preset(scene, findings);
  check_strength(scene, findings);
  check_temperature(scene, findings);
  check_element(scene, findings);
  check_loading(scene, findings);
  check_solver(scene, findings);
  check_continuum(scene, findings);
  check_output(scene, findings);
  check_measured(scene, findings);
  check_study(scene, findings);
  return findings.list;
}

} // namespace apps
