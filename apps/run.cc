#include "apps/run.h"

#include "apps/audit.h"
#include "apps/checkpoint.h"
#include "apps/continuum_run.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/load_case.h"
#include "apps/plot.h"
#include "apps/progress.h"
#include "apps/ranks.h"
#include "apps/repeat.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <span>
#include <stdexcept>

namespace apps {

namespace {

void say(RunInProgress& r, const std::string& line)
{
  fmt::print("{}\n", line);
  std::fflush(stdout);
  r.log.push_back(line);
}

/// How far the specimen has moved: strain, compression positive, or the displacement of the loads.
std::string motion_text(const RunInProgress& r, const dem::Response& response)
{
  const double along = 0.0 + response.strain; // 0 without a sign
  if (dem::loaded_by_platen(r.specimen.assembly))
    return fmt::format("strain {:.4g} %", 0.0 - 100 * along);
  return fmt::format("mean displacement {:.4g} mm", 1e3 * r.specimen.assembly.gauge_length * along);
}

/// One line about the present state.
std::string state_text(const RunInProgress& r, double time)
{
  const dem::Response now = r.record.history.empty() ? dem::Response{} : r.record.history.back();
  return fmt::format("t = {:.4g} s, {}, {} broken", time, motion_text(r, now),
                     r.run->breakages().size());
}

enum class DriveEnd { done, interrupted };

/// Records history and snapshots until the end; stops with a checkpoint if asked to.
DriveEnd drive(RunInProgress& r, const std::filesystem::path& folder, const RunOptions& options)
{
  const std::vector<double> times = history_times(*r.scene.scene, r.loading);
  const std::vector<double> stored = snapshot_times(*r.scene.scene, r.loading);
  std::vector<double> stops = times;
  stops.insert(stops.end(), stored.begin(), stored.end());
  std::ranges::sort(stops);
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  Progress progress(fmt::format("{} ({})", r.scene.name, name_of(r.decision.solver)), options.quiet,
                    options.for_parent);
  double last_checkpoint = 0;
  const double end = dem::end_time(r.loading);
  const auto record = [&](double time) {
    if (std::ranges::binary_search(times, time) || r.run->ended())
      r.record.history.push_back(r.run->response(time));
    if (std::ranges::binary_search(stored, time) || r.run->ended())
      r.record.snapshots.push_back(r.run->snapshot(time));
  };
  for (std::size_t k = r.n_recorded; k < stops.size(); ++k) {
    while (!r.run->ended() && !r.run->reached(stops[k])) {
      r.run->work_towards(stops[k]);
      const double fraction = r.run->work_is_even_in_time() && end > 0
                                  ? r.run->time() / end
                                  : double(k) / double(stops.size());
      progress.update(fraction, state_text(r, r.run->time()));
      const bool due =
          progress.seconds() - last_checkpoint > r.scene.scene->output.checkpoint_interval;
      if (due || interrupted()) {
        write_checkpoint(r, folder, r.wall_time_before + progress.seconds());
        last_checkpoint = progress.seconds();
      }
      if (interrupted()) {
        progress.finish();
        return DriveEnd::interrupted;
      }
    }
    if (r.run->ended() && r.run->time() < stops[k])
      break;
    record(stops[k]);
    r.n_recorded = k + 1;
  }
  const double last = r.record.history.empty() ? -1 : r.record.history.back().time;
  if (r.run->ended() && r.run->time() > last)
    record(r.run->time());
  progress.finish();
  r.wall_time_before += progress.seconds();
  return DriveEnd::done;
}

/// The exit code of a run once its expectations are looked at.
int judged(const RunInProgress& r, const std::filesystem::path& folder, const RunOptions& options,
           int code)
{
  const bool repeated = r.scene.scene->repeat.wanted();
  if (!expects_anything(r.scene.scene->expect) && !repeated)
    return code;
  std::vector<Check> checks = check_run(r);
  if (repeated)
    for (Check& each : check_repetition(r, folder, options))
      checks.push_back(std::move(each));
  return report_checks(checks, folder) ? code : int(exit_not_met);
}

/// How near the simulation comes to what was measured.
void tell_agreement(RunInProgress& r)
{
  if (r.measured.time.empty())
    return;
  const Agreement found =
      agreement(r.measured, history_columns(face_of(r.specimen.assembly), r.record.history));
  say(r, found.n_points > 0
             ? fmt::format("  measured: rms difference {:.3g} % of the largest strain, {} points",
                           100 * found.difference, found.n_points)
             : "  measured: no point lies within the simulated times");
}

int finish(RunInProgress& r, const std::filesystem::path& folder, const RunOptions& options)
{
  make_folder(folder); // now, not after hours
  if (drive(r, folder, options) == DriveEnd::interrupted) {
    say(r, fmt::format("{}: interrupted at t = {:.6g} s{}", r.scene.name, r.run->time(),
                       options.for_parent ? ""
                                          : "; to go on: mastic run --resume " + folder.string()));
    return exit_interrupted;
  }
  const dem::Response& last = r.record.history.back();
  std::string ending = name_of(r.run->end());
  if (!r.run->end_reason().empty())
    ending += ": " + r.run->end_reason();
  say(r, fmt::format("  ended at t = {:.6g} s: {}; {}, {} of {} bonds broken", last.time, ending,
                     motion_text(r, last), r.run->breakages().size(),
                     r.specimen.assembly.bonds.size()));
  say(r, "  " + r.run->statistics());
  say(r, fmt::format("  solved in {}", duration_text(r.wall_time_before)));
  const bool small = r.decision.solver == SolverChoice::linear ||
                     (r.decision.solver == SolverChoice::events &&
                      r.scene.scene->solver != SolverChoice::automatic);
  if (small && std::abs(last.strain) > 0.02)
    say(r, fmt::format("  note: this solver takes displacements as small; at {:.2g} % of the gauge "
                       "length the change of geometry that it leaves out is of that order",
                       std::abs(100 * last.strain)));
  write_results(r, folder, r.wall_time_before);
  tell_agreement(r);
  if (r.decision.solver == SolverChoice::dynamic && r.scene.scene->audit)
    print_scaling_audit(r, folder);
  remove_checkpoints(folder);
  say(r, fmt::format("  results in {}", folder.string()));
  if (r.scene.scene->output.plots)
    for (const std::string& figure : make_figures({folder}, folder))
      say(r, "  figure " + figure);
  const int code = r.run->end() == dem::RunEnd::lost_equilibrium ? exit_lost_equilibrium : exit_ok;
  return options.unchecked ? code : judged(r, folder, options, code);
}

/// Particles that hang on nothing are most often not meant.
void tell_loose_particles(RunInProgress& r)
{
  constexpr std::size_t most_named = 10;
  const std::vector<dem::Index>& loose = r.specimen.loose;
  if (loose.empty())
    return;
  const auto named = std::span(loose).first(std::min(loose.size(), most_named));
  say(r, fmt::format("  note: {} of the particles hang on nothing: {}{}", loose.size(),
                     fmt::join(named, ", "), loose.size() > most_named ? ", ..." : ""));
}

/// Threads meet after each step, which takes as long as some hundred bonds.
int useful_threads(const dem::Assembly& assembly, int n_threads)
{
  constexpr std::size_t bonds_per_thread = 100;
  const std::size_t most = std::max<std::size_t>(1, assembly.bonds.size() / bonds_per_thread);
  return int(std::min(most, std::size_t(n_threads)));
}

/// Where estimated numbers are in use, the user is told.
void tell_estimates(RunInProgress& r)
{
  const std::string list = estimated_keys(r.scene);
  if (!list.empty())
    say(r, "  preset 'estimate': estimates, not the paper's tables, stand for " + list);
}

/// Runs a scene without errors.
int run_accepted(LoadedScene scene, const RunOptions& options)
{
  if (scene.scene->solver == SolverChoice::continuum)
    return run_continuum(std::move(scene), options);
  if (started_by_mpirun())
    throw std::invalid_argument("mpirun is for Solver = continuum; the solvers of particles run in "
                                "one process, with --threads");
  const std::filesystem::path folder = result_folder(scene);
  require_writable(folder);
  const bool generated = scene.scene->specimen.source == SpecimenSource::generate;
  if (options.packing && !generated)
    throw std::invalid_argument("--packing: the scene reads its particles from a file already "
                                "(Source = file)");
  RunInProgress r;
  r.measured = measured_curve(scene);
  say(r, scene.name + (scene.scene->title.empty() ? "" : ": " + scene.scene->title));
  r.packing = options.packing ? read_packing(*options.packing, packing_recipe(*scene.scene))
                              : make_packing(scene);
  r.scene = std::move(scene);
  start_run(r, options);
  return finish(r, folder, options);
}

/// How a run failed; `any` if it did not.
struct Failure {
  ExpectedEnd end;
  std::string message;
  int exit_code;
};

Failure failure_of(LoadedScene scene, const RunOptions& options)
{
  std::string wrong;
  for (const Diagnostic& each : scene.diagnostics)
    if (each.kind == Diagnostic::Kind::error)
      wrong += each.message + '\n';
  if (!wrong.empty())
    return {ExpectedEnd::refused, wrong, exit_input};
  try {
    return {ExpectedEnd::any, "", run_accepted(std::move(scene), options)};
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return {ExpectedEnd::refused, error.what(), exit_input};
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return {ExpectedEnd::failed, error.what(), exit_failure};
  }
}

} // namespace

std::string name_of(dem::RunEnd end)
{
  switch (end) {
  case dem::RunEnd::finished:
    return "end of the load history";
  case dem::RunEnd::strain_limit:
    return "strain limit";
  case dem::RunEnd::lost_equilibrium:
    return "lost equilibrium";
  default:
    return "running";
  }
}

std::filesystem::path result_folder(const LoadedScene& scene)
{
  const std::string& folder = scene.scene->output.folder;
  return folder.empty() ? std::filesystem::path("results") / scene.name
                        : std::filesystem::path(folder);
}

void print_diagnostics(const std::vector<Diagnostic>& diagnostics)
{
  for (const Diagnostic& d : diagnostics) {
    const char* kind = d.kind == Diagnostic::Kind::error     ? "error"
                       : d.kind == Diagnostic::Kind::warning ? "warning"
                                                             : "note";
    fmt::print(stderr, "{}: {}: {}\n", d.place, kind, d.message);
  }
}

void start_run(RunInProgress& r, const RunOptions& options)
{
  const Scene& scene = *r.scene.scene;
  r.files_fingerprint = files_fingerprint(r.scene);
  r.specimen = make_specimen(r.scene, r.packing);
  r.loading = make_loading(scene, r.specimen.assembly.area, r.specimen.assembly.gauge_length);
  if (r.decision.reason.empty())
    r.decision = choose_solver(scene, r.specimen.assembly, r.loading);
  if (has_temperature_history(scene) && r.decision.solver != SolverChoice::quasistatic)
    throw std::invalid_argument(fmt::format("Solver = {} takes no Temperature history; use "
                                            "quasistatic",
                                            name_of(r.decision.solver)));
  r.n_threads = useful_threads(r.specimen.assembly, options.n_threads);
  const auto start = std::chrono::steady_clock::now(); // the first factorisation is work, too
  r.run = make_run(r.decision.solver, scene, r.specimen.assembly, r.loading, r.n_threads);
  r.wall_time_before =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say(r,
      fmt::format("  {} particles, {} bonds; solver {}: {}", r.packing.particles.size(),
                  r.specimen.assembly.bonds.size(), name_of(r.decision.solver), r.decision.reason));
  if (r.specimen.assembly.strengths && r.specimen.assembly.strengths->n_nonpositive > 0)
    say(r,
        fmt::format("  {} of the strengths were drawn at or below 0; 'Nonpositive draws' says what "
                    "they become",
                    r.specimen.assembly.strengths->n_nonpositive));
  tell_loose_particles(r);
  tell_estimates(r);
}

int run_scene(LoadedScene scene, const RunOptions& options)
{
  print_diagnostics(scene.diagnostics);
  const Expectations expect = scene.scene->expect;
  const bool failure_expected =
      expect.end == ExpectedEnd::refused || expect.end == ExpectedEnd::failed;
  if (options.unchecked || !failure_expected)
    return scene.has_errors() ? int(exit_input) : run_accepted(std::move(scene), options);
  const std::filesystem::path folder = result_folder(scene);
  const Failure failure = failure_of(std::move(scene), options);
  if (failure.end == ExpectedEnd::any)
    return failure.exit_code;
  const bool met = report_checks(check_failure(expect, failure.end, failure.message), folder);
  return met ? failure.exit_code : int(exit_not_met);
}

int resume_run(const std::filesystem::path& file, const RunOptions& options)
{
  if (is_continuum_checkpoint(file))
    return resume_continuum(file, options);
  Resumed resumed = read_checkpoint(file, options);
  return finish(resumed.run, resumed.folder, options);
}

} // namespace apps
