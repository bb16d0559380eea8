#include "apps/run.h"

#include "apps/audit.h"
#include "apps/checkpoint.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/load_case.h"
#include "apps/plot.h"
#include "apps/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace apps {

namespace {

void say(const std::string& line)
{
  fmt::print("{}\n", line);
  std::fflush(stdout);
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

int finish(RunInProgress& r, const std::filesystem::path& folder, const RunOptions& options)
{
  make_folder(folder); // now, not after hours
  if (drive(r, folder, options) == DriveEnd::interrupted) {
    say(fmt::format("{}: interrupted at t = {:.6g} s{}", r.scene.name, r.run->time(),
                    options.for_parent ? ""
                                       : "; to go on: mastic run --resume " + folder.string()));
    return exit_interrupted;
  }
  const dem::Response& last = r.record.history.back();
  std::string ending = name_of(r.run->end());
  if (!r.run->end_reason().empty())
    ending += ": " + r.run->end_reason();
  say(fmt::format("  ended at t = {:.6g} s: {}; {}, {} of {} bonds broken", last.time, ending,
                  motion_text(r, last), r.run->breakages().size(),
                  r.specimen.assembly.bonds.size()));
  say("  " + r.run->statistics());
  say(fmt::format("  solved in {}", duration_text(r.wall_time_before)));
  const bool small = r.decision.solver == SolverChoice::linear ||
                     (r.decision.solver == SolverChoice::events &&
                      r.scene.scene->solver != SolverChoice::automatic);
  if (small && std::abs(last.strain) > 0.02)
    say(fmt::format("  note: this solver takes displacements as small; at {:.2g} % of the gauge "
                    "length the change of geometry that it leaves out is of that order",
                    std::abs(100 * last.strain)));
  write_results(r, folder, r.wall_time_before);
  if (r.decision.solver == SolverChoice::dynamic && r.scene.scene->audit)
    print_scaling_audit(r, folder);
  remove_checkpoints(folder);
  say(fmt::format("  results in {}", folder.string()));
  if (r.scene.scene->output.plots)
    for (const std::string& figure : make_figures({folder}, folder))
      say("  figure " + figure);
  return r.run->end() == dem::RunEnd::lost_equilibrium ? exit_lost_equilibrium : exit_ok;
}

/// Particles that hang on nothing are most often not meant.
void tell_lonely_particles(const dem::Assembly& assembly)
{
  std::vector<bool> bonded(assembly.particles.size());
  for (const auto& ends : assembly.bonds.ends)
    for (const dem::Index end : ends)
      bonded[end] = true;
  const auto first = std::ranges::find(bonded, false);
  if (first != bonded.end())
    say(fmt::format("  note: {} of the particles have no bond; the first is particle {}",
                    std::ranges::count(bonded, false), first - bonded.begin()));
}

/// Where estimated numbers are in use, the user is told.
void tell_estimates(const LoadedScene& scene)
{
  const std::string list = estimated_keys(scene);
  if (!list.empty())
    say("  preset 'estimate': estimates, not the paper's tables, stand for " + list);
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
  r.loading = make_loading(scene, r.specimen.assembly);
  if (r.decision.reason.empty())
    r.decision = choose_solver(scene, r.specimen.assembly, r.loading);
  if (has_temperature_history(scene) && r.decision.solver != SolverChoice::quasistatic)
    throw std::invalid_argument(fmt::format("Solver = {} takes no Temperature history; use "
                                            "quasistatic",
                                            name_of(r.decision.solver)));
  r.n_threads = options.n_threads;
  const auto start = std::chrono::steady_clock::now(); // the first factorisation is work, too
  r.run = make_run(r.decision.solver, scene, r.specimen.assembly, r.loading, options.n_threads);
  r.wall_time_before =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say(fmt::format("  {} particles, {} bonds; solver {}: {}", r.packing.particles.size(),
                  r.specimen.assembly.bonds.size(), name_of(r.decision.solver), r.decision.reason));
  if (r.specimen.assembly.strengths && r.specimen.assembly.strengths->n_nonpositive > 0)
    say(fmt::format("  {} of the strengths were drawn at or below 0; 'Nonpositive draws' says what "
                    "they become",
                    r.specimen.assembly.strengths->n_nonpositive));
  tell_lonely_particles(r.specimen.assembly);
  tell_estimates(r.scene);
}

int run_scene(LoadedScene scene, const RunOptions& options)
{
  print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    return exit_input;
  const std::filesystem::path folder = result_folder(scene);
  require_writable(folder);
  const bool generated = scene.scene->specimen.source == SpecimenSource::generate;
  if (options.packing && !generated)
    throw std::invalid_argument("--packing: the scene reads its particles from a file already "
                                "(Source = file)");
  say(fmt::format("{}{}", scene.name, scene.scene->title.empty() ? "" : ": " + scene.scene->title));
  RunInProgress r;
  r.packing = options.packing ? read_packing(*options.packing, packing_recipe(*scene.scene))
                              : make_packing(scene);
  r.scene = std::move(scene);
  start_run(r, options);
  return finish(r, folder, options);
}

int resume_run(const std::filesystem::path& file, const RunOptions& options)
{
  Resumed resumed = read_checkpoint(file, options);
  return finish(resumed.run, resumed.folder, options);
}

} // namespace apps
