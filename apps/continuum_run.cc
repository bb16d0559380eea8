#include "apps/continuum_run.h"

#include "apps/checkpoint.h"
#include "apps/continuum_balance.h"
#include "apps/continuum_march.h"
#include "apps/continuum_steps.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/load_case.h"
#include "apps/plot.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/run_checks.h"
#include "fem/agreement.h"
#include "fem/frequency.h"
#include "fem/processor_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace apps {

namespace {

/// Times at which something happens, and what.
struct Stops {
  std::vector<double> history, fields, refinements, all;

  static bool holds(const std::vector<double>& times, double t)
  {
    return std::ranges::find(times, t) != times.end();
  }
};

Stops stops_of(const Scene& scene, const dem::Loading& loading)
{
  Stops stops{history_times(scene, loading), snapshot_times(scene, loading), {}, {}};
  for (const double t : scene.continuum.refinement_times)
    if (t > loading.points.front().time && t < dem::end_time(loading))
      stops.refinements.push_back(t);
  for (const auto* times : {&stops.history, &stops.fields, &stops.refinements})
    stops.all.insert(stops.all.end(), times->begin(), times->end());
  for (const dem::LoadPoint& point : loading.points)
    stops.all.push_back(point.time);
  std::ranges::sort(stops.all);
  stops.all.erase(std::unique(stops.all.begin(), stops.all.end()), stops.all.end());
  return stops;
}

/// Runs to the end of the load history; false if it was interrupted.
template <int dim>
bool drive(ContinuumInProgress<dim>& run, const std::filesystem::path& folder,
           const RunOptions& options)
{
  const Stops stops = stops_of(*run.scene.scene, run.loading);
  Progress progress(run.scene.name + " (continuum)", options.quiet || !run.ranks.first(),
                    options.for_parent && run.ranks.first());
  const double before = run.wall_time;
  Watch watch{progress, folder};
  for (std::size_t k = run.n_recorded; k < stops.all.size(); ++k) {
    const double stop = stops.all[k];
    const bool arrived = advance(run, stop, watch, double(k) / double(stops.all.size()));
    run.wall_time = before + progress.seconds();
    if (!arrived) {
      progress.finish();
      return false;
    }
    const bool over = has_ended(run);
    if (over && run.loading.control == dem::Loading::Control::force)
      record_state_before(run);
    if (over || Stops::holds(stops.history, stop))
      record_history(run);
    if (over || Stops::holds(stops.fields, stop))
      record_fields(run, folder);
    if (over)
      break;
    if (Stops::holds(stops.refinements, stop))
      refine_now(run);
    run.n_recorded = k + 1;
  }
  progress.finish();
  return true;
}

/// E* over frequency from complex solutions, at the temperature of the test.
template <int dim>
std::vector<Column> modulus(const ContinuumInProgress<dim>& run)
{
  const Scene& scene = *run.scene.scene;
  const std::vector<double>& frequencies = scene.output.frequencies;
  const fem::ComplianceLaw& first = run.laws.laws.front();
  const bool is_elastic = run.volumes && first.terms.empty() && first.fluidity.isZero(0);
  if (!has_platens(scene) || has_temperature_history(scene) || frequencies.empty() || is_elastic)
    return {};
  std::vector<double> omegas;
  const double shift = 1 / run.history.reduced_time(1);
  modulus_columns(frequencies, [&](double omega) {
    omegas.push_back(omega * shift);
    return std::complex<double>();
  });
  const auto stiffness = fem::drive_stiffness(*run.specimen, run.laws.laws, run.law_of_point,
                                              omegas, scene.continuum.solver_tolerance);
  std::size_t k = 0;
  return modulus_columns(
      frequencies, [&](double) { return stiffness[k++].value * run.face.length / run.face.area; });
}

std::string name_of(fem::TimeScheme scheme)
{
  return scheme == fem::TimeScheme::stress_linear ? "stress linear" : "strain linear";
}

/// How a run has ended, and where.
struct End {
  dem::RunEnd kind;
  std::string reason;
};

template <int dim>
End end_of(const ContinuumInProgress<dim>& run)
{
  if (!has_ended(run))
    return {dem::RunEnd::finished, ""};
  if (!run.march.has_lost && run.march.is_settled)
    return {dem::RunEnd::strain_limit, fmt::format("strain limit at t = {:.6g} s", run.march.time)};
  const fem::Vec3 place = most_strained_place(run);
  const bool by_volume = run.ranks.any(run.points->has_lost());
  return {dem::RunEnd::lost_equilibrium,
          fmt::format("no equilibrium at t = {:.6g} s: {} ({:.3g}, {:.3g}, {:.3g}) mm",
                      run.march.time,
                      by_volume ? "that of a volume is lost, at"
                                : "bonds went on breaking; most strained at",
                      1e3 * place[0], 1e3 * place[1], 1e3 * place[2])};
}

/// What a run has come to, of all ranks.
struct Outcome {
  End end;
  std::vector<Column> over_frequency;
  std::optional<BodyDamage> damage;
  long n_cells, n_unknowns;
  std::string balance; ///< a line for users
};

/// All ranks take part.
template <int dim>
Outcome outcome_of(ContinuumInProgress<dim>& run)
{
  Outcome outcome{end_of(run),
                  modulus(run),
                  {},
                  long(run.mesh.cells->n_global_active_cells()),
                  long(run.specimen->elements().dofs().n_dofs()),
                  balance_summary(run)};
  if (run.volumes)
    outcome.damage = body_damage(run.specimen->elements(), *run.volumes);
  return outcome;
}

/// Tells what a run took and what there is to know about its end. First rank only.
template <int dim>
void tell(const ContinuumInProgress<dim>& run, const Outcome& outcome)
{
  say(run.ranks, "  " + statistics(run.march));
  if (!run.record.volumes.empty()) {
    const VolumeReading& last = run.record.volumes.back();
    say(run.ranks, fmt::format("  {:.0f} of {:.0f} bonds broken, {:.0f} of {:.0f} points live",
                               last.n_broken, last.n_bonds, last.n_live, last.n_points));
  }
  if (!outcome.balance.empty())
    say(run.ranks, "  " + outcome.balance);
  if (outcome.end.kind != dem::RunEnd::finished)
    say(run.ranks, fmt::format("  ended early: {}", outcome.end.reason));
  say(run.ranks, fmt::format("  solved in {}", duration_text(run.wall_time)));
  if (const double strain = std::abs(run.record.history.back().strain);
      run.face.platen && strain > 0.02)
    say(run.ranks, fmt::format("  note: strains are taken as small; at {:.2g} % the change of "
                               "geometry that this leaves out is of that order",
                               100 * strain));
}

/// Results, figures and checks of a run. First rank only.
/// \return the exit code
template <int dim>
int leave_results(const ContinuumInProgress<dim>& run, Outcome outcome,
                  const std::filesystem::path& folder, const RunOptions& options)
{
  const Scene& scene = *run.scene.scene;
  std::vector<std::string> laws;
  for (const fem::LawRecord& record : run.laws.records)
    laws.push_back(fem::law_text(record));
  const ContinuumSize size{outcome.n_cells, outcome.n_unknowns, scene.continuum.order,
                           run.ranks.number(), name_of(run.scheme)};
  tell(run, outcome);
  write_continuum_results(
      {run.scene, run.face, run.record, run.march, size, run.places, outcome.over_frequency, laws,
       run.loading.control == dem::Loading::Control::displacement, run.wall_time,
       apps::name_of(outcome.end.kind), outcome.end.reason, std::move(outcome.damage)},
      folder);
  remove_checkpoints(folder);
  say(run.ranks, fmt::format("  results in {}", folder.string()));
  if (scene.output.plots)
    for (const std::string& figure : make_figures({folder}, folder))
      say(run.ranks, "  figure " + figure);
  const int code =
      outcome.end.kind == dem::RunEnd::lost_equilibrium ? exit_lost_equilibrium : exit_ok;
  if (options.unchecked || !expects_anything(scene.expect))
    return code;
  const std::vector<Check> checks =
      check_history(scene.expect, history_columns(run.face, run.record.history));
  return report_checks(checks, folder) ? exit_ok : exit_not_met;
}

/// Runs to the end and writes the results.
/// \return the exit code, on all ranks
template <int dim>
int finish(ContinuumInProgress<dim>& run, const std::filesystem::path& folder,
           const RunOptions& options)
{
  bool ended = false;
  try {
    ended = drive(run, folder, options);
  } catch (const fem::RankFailure&) {
    throw; // the states of the ranks may not belong together
  } catch (const std::runtime_error&) {
    if (run.march.n_steps > 0 && !run.march.has_lost && run.ranks.all_here())
      write_continuum_checkpoint(run, folder); // the last good state
    throw;
  }
  if (!ended) {
    say(run.ranks,
        fmt::format("{}: interrupted at t = {:.6g} s{}", run.scene.name, run.march.time,
                    options.for_parent ? ""
                                       : "; to go on: mastic run --resume " + folder.string()));
    return exit_interrupted;
  }
  Outcome outcome = outcome_of(run);
  int code = exit_ok;
  fem::together(run.ranks.all(), [&] {
    if (run.ranks.first())
      code = leave_results(run, std::move(outcome), folder, options);
  });
  MPI_Bcast(&code, 1, MPI_INT, 0, run.ranks.all());
  return code;
}

/// Makes the body of a run before anything has happened.
/// \param stored  names the cells of the mesh, if they are not those of the scene
template <int dim>
void begin(ContinuumInProgress<dim>& run, const StoredContinuum* stored)
{
  const Scene& scene = *run.scene.scene;
  run.mesh = make_mesh<dim>(run.scene, run.ranks.all());
  run.loading = make_loading(scene, 1, 1); // until the face is known
  run.places = probe_places(scene.continuum.probes);
  run.scheme = scheme_of(scene, run.loading);
  run.march.time = run.loading.points.front().time;
  if (stored)
    fem::refine_to(run.mesh, stored->cells.names);
  make_body(run);
  const auto [low, high] = fem::extent(run.mesh);
  run.face.platen = has_platens(scene);
  run.face.length = scene.specimen.gauge_length.value_or(high[dim - 1] - low[dim - 1]);
  run.face.area =
      run.face.platen
          ? run.specimen->elements().boundary_area(fem::boundary_id(run.mesh, std::string("top")))
          : 1;
  run.loading = make_loading(scene, run.face.area, run.face.length);
  run.history = history_of(scene, run.loading, run.laws);
  require_range(scene, run.laws, run.history.reduced_time(dem::end_time(run.loading)));
}

template <int dim>
int run_body(const LoadedScene& loaded, const Ranks& ranks, const std::filesystem::path& folder,
             const RunOptions& options, const StoredContinuum* stored)
{
  const Scene& scene = *loaded.scene;
  ContinuumInProgress<dim> run{.scene = loaded,
                               .ranks = ranks,
                               .packings = folder / "packings",
                               .n_threads = options.n_threads};
  const double start = fem::processor_time();
  begin(run, stored);
  if (stored) {
    fem::restore_cell_states(*run.specimen, *run.points, fem::own_states(run.mesh, stored->cells),
                             stored->drive_displacement);
    run.specimen->set_drive_force(stored->drive_force);
    run.points->set_last_step(stored->last_step);
    run.march = stored->march;
    run.record = stored->record;
    run.n_recorded = stored->n_recorded;
    run.n_jumped = stored->n_jumped;
    run.elastic_compliance = stored->elastic_compliance;
    run.last_time = stored->last_time;
    run.last_motion = stored->last_motion;
    run.wall_time = stored->wall_time;
  } else
    refine_at_start(run);
  run.costs.begin(fem::processor_time() - start, ranks);
  say(ranks, fmt::format("  {} cells of order {}, {} unknowns, {} rank{}; {} in a step{}",
                         run.mesh.cells->n_global_active_cells(), scene.continuum.order,
                         run.specimen->elements().dofs().n_dofs(), ranks.number(),
                         ranks.number() > 1 ? "s" : "", name_of(run.scheme),
                         run.specimen->supports().n_pins > 0
                             ? fmt::format("; {} rigid motion(s) held at single nodes",
                                           run.specimen->supports().n_pins)
                             : ""));
  if (!run.volume_sizes.empty()) {
    say(ranks, "  points are volumes of " + run.volume_sizes);
    if (const std::string estimates = estimated_keys(loaded); !estimates.empty())
      say(ranks, "  preset 'estimate': estimates, not the paper's tables, stand for " + estimates);
  }
  fem::together(ranks.all(), [&] {
    if (ranks.first())
      make_folder(folder);
  });
  return finish(run, folder, options);
}

int run_any(const LoadedScene& scene, const Ranks& ranks, const std::filesystem::path& folder,
            const RunOptions& options, const StoredContinuum* stored)
{
  if (scene.scene->continuum.body.section == BodySection::meridian)
    return run_body<2>(scene, ranks, folder, options, stored);
  return run_body<3>(scene, ranks, folder, options, stored);
}

} // namespace

int run_continuum(LoadedScene scene, const RunOptions& options)
{
  const Ranks ranks;
  const std::filesystem::path folder = result_folder(scene);
  require_writable(folder);
  if (options.packing)
    throw std::invalid_argument("--packing: a continuum has no particles");
  say(ranks, scene.name + (scene.scene->title.empty() ? "" : ": " + scene.scene->title));
  return run_any(scene, ranks, folder, options, nullptr);
}

int resume_continuum(const std::filesystem::path& checkpoint, const RunOptions& options)
{
  const Ranks ranks;
  refuse_other_options(options);
  const dem::Hdf5File file = open_checkpoint(checkpoint);
  LoadedScene scene =
      load_scene_text(file.read_text("scene/resolved"), file.text_attribute("scene", "name"),
                      file.text_attribute("scene", "folder"), options.overrides);
  scene.name = file.text_attribute("scene", "name");
  scene.text = file.read_text("scene/as_typed");
  if (ranks.first())
    print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    throw std::invalid_argument(checkpoint.string() + ": its scene has errors");
  const StoredContinuum stored = read_continuum_checkpoint(file);
  if (stored.files != continuum_fingerprint(scene))
    throw std::invalid_argument(checkpoint.string() +
                                ": the law or mesh files have changed since the run began");
  say(ranks, fmt::format("{}: resumed from {}", scene.name, checkpoint.string()));
  return run_any(scene, ranks, file.text_attribute("scene", "result_folder"), options, &stored);
}

void check_continuum_files(const LoadedScene& scene)
{
  const Ranks ranks;
  const auto check = [&]<int dim>(std::integral_constant<int, dim>) {
    ContinuumInProgress<dim> run{.scene = scene, .ranks = ranks, .trial = true};
    begin(run, nullptr);
  };
  if (scene.scene->continuum.body.section == BodySection::meridian)
    check(std::integral_constant<int, 2>());
  else
    check(std::integral_constant<int, 3>());
}

bool is_continuum_checkpoint(const std::filesystem::path& checkpoint)
{
  return open_checkpoint(checkpoint).text_attribute("scene", "solver") == "continuum";
}

} // namespace apps
