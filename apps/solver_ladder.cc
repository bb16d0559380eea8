#include "apps/solver_ladder.h"

#include "apps/quantity.h"
#include "apps/study_factors.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace apps {

namespace {

const std::vector<std::string> solver_names{"linear", "events", "quasistatic", "dynamic"};

/// As few digits as matter: 16 times 5e-4 is 0.008.
double rounded(double value)
{
  return std::stod(fmt::format("{:.12g}", value));
}

Rung quasistatic_rung(const std::string& knob, const Scene& scene, double factor, long batch)
{
  const dem::QuasistaticSettings& v = scene.quasistatic;
  const double step = rounded(std::min(0.1, factor * v.strain_per_step)),
               tolerance = rounded(std::min(1.0, factor * v.error_tolerance));
  return {"quasistatic",
          knob,
          knob == "breakage batch" ? double(batch) : step,
          {"Quasistatic/Strain per step = " + shortest(step),
           "Quasistatic/Error tolerance = " + shortest(tolerance),
           fmt::format("Quasistatic/Breakage batch = {}", batch)}};
}

/// The continuum on cells and at a step tolerance that are factors of those of the scene.
Rung continuum_rung(const std::string& knob, const Scene& scene, double cells, double steps)
{
  const ContinuumInput& v = scene.continuum;
  const double size = rounded(1e3 * cells * v.body.cell_size),
               tolerance = rounded(std::min(0.1, steps * v.step_tolerance));
  return {"continuum",
          knob,
          knob == "step tolerance" ? tolerance : size,
          {fmt::format("Body/Cell size = {} mm", shortest(size)),
           "Continuum/Step tolerance = " + shortest(tolerance)}};
}

/// Volumes of a kind at the points of a continuum, at a factor of the scene's breakage tolerance.
Rung volume_rung(const char* material, const Scene& scene, double factor)
{
  const double tolerance =
      rounded(std::min(0.5, factor * scene.continuum.volumes.breakage_tolerance));
  return {"continuum",
          fmt::format("breakage tolerance ({})", material),
          tolerance,
          {fmt::format("Body/Material = {}", material),
           "Volumes/Breakage tolerance = " + shortest(tolerance)}};
}

/// The law of the volumes, volumes that break over their tolerance, and every volume live.
std::vector<Ladder> volume_ladders(const Scene& scene)
{
  Ladder adaptive;
  for (const double factor : {10., 5., 2., 1., 0.5})
    adaptive.push_back(volume_rung("adaptive", scene, factor));
  return {{volume_rung("law only", scene, 1)}, adaptive, {volume_rung("all live", scene, 1)}};
}

/// Over the size of the cells, and over the tolerance of the time steps.
std::vector<Ladder> continuum_ladders(const Scene& scene)
{
  if (breaks(scene.continuum))
    return volume_ladders(scene);
  Ladder cells, steps;
  for (const double factor : {4., 2.8, 2., 1.4, 1., 0.7})
    cells.push_back(continuum_rung("cell size in mm", scene, factor, 1));
  for (const double factor : {1e4, 1e3, 1e2, 10., 1.})
    steps.push_back(continuum_rung("step tolerance", scene, 1, factor));
  return {cells, steps};
}

void check_solvers(const std::vector<std::string>& names)
{
  for (const std::string& name : names)
    if (std::ranges::find(solver_names, name) == solver_names.end()) {
      const std::string close = nearest(name, solver_names);
      throw std::invalid_argument(
          fmt::format("there is no solver '{}'; solvers: linear, events, quasistatic, dynamic{}",
                      name, close.empty() ? "" : fmt::format("; did you mean '{}'?", close)));
    }
}

} // namespace

std::string Rung::text() const
{
  return knob.empty() ? solver : fmt::format("{}, {} {}", solver, knob, shortest(value));
}

std::string Rung::folder() const
{
  std::string name = solver;
  for (const std::string& setting : settings)
    name += "-" + as_folder_name(trimmed(setting.substr(setting.find('=') + 1)));
  return name;
}

std::vector<Ladder> solver_ladders(const Scene& scene, const LadderOptions& options)
{
  check_solvers(options.solvers);
  if (scene.solver == SolverChoice::continuum)
    return continuum_ladders(scene);
  std::vector<Ladder> ladders;
  for (const std::string& solver : options.solvers) {
    if (solver == "linear" || solver == "events")
      ladders.push_back({plain_rung(solver)});
    if (solver == "quasistatic") {
      Ladder steps, batches;
      std::vector<double> factors = options.coarsening;
      std::ranges::sort(factors, std::greater());
      for (const double factor : factors)
        steps.push_back(
            quasistatic_rung("strain per step", scene, factor, scene.quasistatic.breakage_batch));
      std::vector<long> counts = options.batches;
      std::ranges::sort(counts, std::greater());
      for (const long batch : counts)
        batches.push_back(quasistatic_rung("breakage batch", scene, 1, batch));
      ladders.push_back(steps);
      if (scene.strength.kind != StrengthKind::none)
        ladders.push_back(batches);
    }
    if (solver == "dynamic") {
      Ladder ladder;
      std::vector<double> scalings = options.scalings;
      std::ranges::sort(scalings);
      for (const double x : scalings)
        ladder.push_back(
            {"dynamic", "viscosity scaling", x, {"Dynamic/Viscosity scaling = " + shortest(x)}});
      ladders.push_back(ladder);
    }
  }
  return ladders;
}

Rung plain_rung(const std::string& solver)
{
  return {solver, "", 0, {}};
}

Rung finest(const Scene& scene)
{
  if (scene.solver == SolverChoice::continuum && breaks(scene.continuum))
    return volume_rung("all live", scene, 0.1);
  if (scene.solver == SolverChoice::continuum)
    return continuum_rung("finest cell size in mm", scene, 0.5, 0.1);
  return quasistatic_rung("finest strain per step", scene, 0.1, 1);
}

} // namespace apps
