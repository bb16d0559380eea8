#include "apps/checkpoint.h"

#include "apps/files.h"
#include "apps/load_case.h"
#include "dem/storage.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>

namespace apps {

namespace {

std::filesystem::path previous(const std::filesystem::path& checkpoint)
{
  return checkpoint.string() + ".previous";
}

/// Keys that do not change what is computed.
bool may_change(const std::string& key)
{
  return key == "Output/ParaView" || key == "Output/Plots" || key == "Output/Checkpoint interval";
}

Packing stored_packing(const dem::Hdf5File& file, const LoadedScene& scene)
{
  if (scene.scene->specimen.source == SpecimenSource::file)
    return make_packing(scene); // with its supports and loads
  return {dem::read_particles(file, "packing"),
          std::nullopt,
          {},
          {file.number_attribute("packing", "lower_platen_m"),
           file.number_attribute("packing", "upper_platen_m")},
          file.text_attribute("packing", "origin")};
}

/// The solver that a checkpoint was written by.
SolverDecision stored_decision(const dem::Hdf5File& file)
{
  const std::string solver = file.text_attribute("scene", "solver");
  for (const SolverChoice each : {SolverChoice::linear, SolverChoice::events,
                                  SolverChoice::quasistatic, SolverChoice::dynamic})
    if (name_of(each) == solver)
      return {each, file.text_attribute("scene", "solver_reason")};
  throw std::runtime_error(fmt::format("there is no solver '{}'", solver));
}

Resumed restored(const std::filesystem::path& path, const RunOptions& options)
{
  const dem::Hdf5File file = open_stored(path, "checkpoint");
  RunInProgress run;
  run.scene =
      load_scene_text(file.read_text("scene/resolved"), file.text_attribute("scene", "name"),
                      file.text_attribute("scene", "folder"), options.overrides);
  run.scene.name = file.text_attribute("scene", "name");
  run.scene.text = file.read_text("scene/as_typed");
  print_diagnostics(run.scene.diagnostics);
  if (run.scene.has_errors())
    throw std::invalid_argument(path.string() + ": its scene has errors");
  fmt::print("{}: resumed from {}\n", run.scene.name, path.string());
  if (files_fingerprint(run.scene) != file.text_attribute("scene", "files_fingerprint"))
    throw std::invalid_argument(path.string() + ": the files of particles or bonds have changed "
                                                "since the run began");
  run.measured = measured_curve(run.scene);
  run.packing = stored_packing(file, run.scene);
  run.decision = stored_decision(file);
  start_run(run, options);
  run.run->load(file);
  run.record = read_record(file, "record");
  run.n_recorded = std::size_t(file.number_attribute("record", "n_recorded"));
  run.wall_time_before = file.number_attribute("", "wall_time_s");
  return {std::move(run), file.text_attribute("scene", "result_folder")};
}

} // namespace

std::filesystem::path checkpoint_file(const std::filesystem::path& folder)
{
  return folder / "checkpoint.h5";
}

bool has_checkpoint(const std::filesystem::path& folder)
{
  const std::filesystem::path file = checkpoint_file(folder);
  return std::filesystem::exists(file) || std::filesystem::exists(previous(file));
}

void remove_checkpoints(const std::filesystem::path& folder)
{
  const std::string name = checkpoint_file(folder).string();
  std::error_code ignored;
  for (const char* end : {"", ".previous", ".part"}) // the last one if a run was killed on the way
    std::filesystem::remove(name + end, ignored);
}

void write_checkpoint(const RunInProgress& r, const std::filesystem::path& folder, double wall_time)
{
  const std::filesystem::path path = checkpoint_file(folder);
  dem::Hdf5File file = dem::Hdf5File::create(path);
  file.set_attribute("", "kind", std::string("checkpoint"));
  file.set_attribute("", "storage_version", dem::storage_version);
  file.set_attribute("", "wall_time_s", wall_time);
  file.write_text("scene/resolved", r.scene.schema->print(false));
  file.write_text("scene/as_typed", r.scene.text);
  file.set_attribute("scene", "name", r.scene.name);
  file.set_attribute("scene", "folder", absolute_folder(r.scene.folder).string());
  file.set_attribute("scene", "files_fingerprint", r.files_fingerprint);
  file.set_attribute("scene", "solver", name_of(r.decision.solver));
  file.set_attribute("scene", "solver_reason", r.decision.reason);
  file.set_attribute("scene", "result_folder", absolute_folder(folder).string());
  dem::write_particles(file, "packing", r.packing.particles);
  file.set_attribute("packing", "lower_platen_m", r.packing.platens.low);
  file.set_attribute("packing", "upper_platen_m", r.packing.platens.high);
  file.set_attribute("packing", "origin", r.packing.origin);
  r.run->save(file);
  write_record(file, "record", r.record);
  file.set_attribute("record", "n_recorded", double(r.n_recorded));
  publish_checkpoint(file, path);
}

void publish_checkpoint(dem::Hdf5File& file, const std::filesystem::path& path)
{
  std::error_code ignored; // there may be none before
  std::filesystem::rename(path, previous(path), ignored);
  file.publish();
}

dem::Hdf5File open_checkpoint(const std::filesystem::path& path)
{
  try {
    return open_stored(path, "checkpoint");
  } catch (const std::exception&) {
    if (!std::filesystem::exists(previous(path)))
      throw;
  }
  return open_stored(previous(path), "checkpoint");
}

void refuse_other_options(const RunOptions& options)
{
  for (const std::string& each : options.overrides)
    if (const std::string key = override_entry(each).path(); !may_change(key))
      throw std::invalid_argument(fmt::format(
          "--set \"{}\": a run goes on as it began; with --resume only Output/ParaView, "
          "Output/Plots and Output/Checkpoint interval can be set",
          each));
  if (options.packing)
    throw std::invalid_argument("--packing: a run goes on with the packing it began with");
}

Resumed read_checkpoint(const std::filesystem::path& file, const RunOptions& options)
{
  refuse_other_options(options);
  const std::filesystem::path before = previous(file);
  if (std::filesystem::exists(before))
    try {
      return restored(file, options);
    } catch (const std::exception& problem) {
      fmt::print(stderr, "warning: {}\nwarning: taking the checkpoint before it\n", problem.what());
    }
  const std::filesystem::path& source = std::filesystem::exists(before) ? before : file;
  try {
    return restored(source, options);
  } catch (const std::runtime_error& damage) {
    throw std::invalid_argument(damage.what());
  }
}

} // namespace apps
