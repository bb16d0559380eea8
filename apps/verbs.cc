#include "apps/verbs.h"

#include "apps/checkpoint.h"
#include "apps/collection.h"
#include "apps/continuum_run.h"
#include "apps/files.h"
#include "apps/measured.h"
#include "apps/schema.h"
#include "apps/stored_study.h"
#include "apps/study.h"
#include "apps/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

std::filesystem::path result_file(const std::string& name)
{
  const std::filesystem::path path = existing(name, "file or folder");
  if (!std::filesystem::is_directory(path))
    return path;
  if (std::filesystem::exists(path / "runs.csv"))
    throw std::invalid_argument(fmt::format("{}: a study of several runs: name one of its folders; "
                                            "of all of them there are summary.csv and "
                                            "statistics.csv, and 'mastic report' makes a page",
                                            name));
  if (!std::filesystem::exists(path / "result.h5"))
    throw std::invalid_argument(fmt::format("{}: there is no result.h5 in it", name));
  return path / "result.h5";
}

/// Group of the snapshot nearest to a time; says so if it is not that time.
std::string snapshot_group(const dem::Hdf5File& file, const std::string& time)
{
  const std::vector<std::string> names = file.members("snapshots");
  if (names.empty())
    throw std::invalid_argument("the result has no snapshots");
  if (time.empty())
    return "snapshots/" + names.back();
  const double wanted = Units().parse(time, "s", "s");
  std::string best, all;
  double least = INFINITY, found = 0;
  for (const std::string& name : names) {
    const double t = file.number_attribute("snapshots/" + name, "time_s");
    all += fmt::format("{}{:g}", all.empty() ? "" : ", ", t);
    if (std::abs(t - wanted) < least) {
      least = std::abs(t - wanted);
      best = name;
      found = t;
    }
  }
  if (least > 1e-9 * std::max(1.0, std::abs(wanted)))
    fmt::print(stderr, "note: nearest snapshot is at {:g} s; there are: {} s\n", found, all);
  return "snapshots/" + best;
}

dem::Particles stored_particles(const dem::Hdf5File& file)
{
  dem::Particles particles;
  const std::vector<double> centre = file.read_doubles("packing/centre");
  for (std::size_t k = 0; k + 2 < centre.size(); k += 3)
    particles.centre.emplace_back(centre[k], centre[k + 1], centre[k + 2]);
  particles.radius = file.read_doubles("packing/radius");
  return particles;
}

std::vector<std::array<dem::Index, 2>> stored_ends(const dem::Hdf5File& file)
{
  std::vector<std::array<dem::Index, 2>> ends;
  const std::vector<std::int32_t> numbers = file.read_integers("bonds/particles");
  for (std::size_t k = 0; k + 1 < numbers.size(); k += 2)
    ends.push_back({numbers[k], numbers[k + 1]});
  return ends;
}

std::string packing_csv(const Packing& packing)
{
  std::vector<Column> columns{{"x_mm", "mm", {}},
                              {"y_mm", "mm", {}},
                              {"z_mm", "mm", {}},
                              {"r_mm", "mm", {}},
                              {"class", "1", {}}};
  for (std::size_t i = 0; i < packing.particles.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      columns[std::size_t(k)].values.push_back(1e3 * packing.particles.centre[i][k]);
    columns[3].values.push_back(1e3 * packing.particles.radius[i]);
    columns[4].values.push_back(packing.particles.material_class[i]);
  }
  return csv(columns);
}

/// Goes on with a study or a collection of scenes from its folder.
int resume_study(const std::filesystem::path& folder, const RunOptions& options)
{
  refuse_other_options(options);
  StoredStudy stored = read_study(folder, options.overrides);
  print_diagnostics(stored.scene.diagnostics);
  if (stored.scene.has_errors())
    return exit_input;
  return stored.scene.scene->study.scenes.empty()
             ? run_study(std::move(stored.scene), options, true)
             : run_collection(stored, options, true);
}

/// Adds what is wrong with the runs of a study or the scenes of a collection.
void check_members(const std::string& scene, const std::vector<std::string>& overrides,
                   LoadedScene& loaded)
{
  if (loaded.has_errors())
    return;
  std::vector<Diagnostic> problems =
      loaded.scene->study.scenes.empty()
          ? check_study_runs(scene, overrides, study_runs(*loaded.scene))
          : check_collection(collected_scenes(loaded), overrides);
  for (Diagnostic& each : problems)
    loaded.diagnostics.push_back(std::move(each));
}

/// Goes on with a run or a study, from its folder or from a checkpoint.
int resume_from(const std::filesystem::path& from, const RunOptions& options)
{
  if (!std::filesystem::is_directory(from))
    return resume_run(from, options);
  if (is_study(from))
    return resume_study(from, options);
  if (!has_checkpoint(from))
    throw std::invalid_argument(fmt::format(
        "{}: there is no checkpoint in it{}", from.string(),
        std::filesystem::exists(from / "result.h5") ? "; the run has come to its end" : ""));
  return resume_run(checkpoint_file(from), options);
}

} // namespace

int run_verb(const std::string& scene, const std::string& resume, const std::string& packing,
             RunOptions options)
{
  if (scene.empty() == resume.empty())
    throw std::invalid_argument("run needs either a scene file or --resume");
  if (!packing.empty())
    options.packing = existing(packing, "file");
  if (!resume.empty())
    return resume_from(resume, options);
  existing(scene, "file");
  LoadedScene loaded = load_scene(scene, options.overrides);
  const bool several = !loaded.has_errors() &&
                       (!loaded.scene->study.scenes.empty() || !study_runs(*loaded.scene).empty());
  if (!several)
    return run_scene(std::move(loaded), options);
  check_members(scene, options.overrides, loaded);
  print_diagnostics(loaded.diagnostics);
  if (loaded.has_errors())
    return exit_input;
  if (!loaded.scene->study.scenes.empty())
    return run_collection({std::move(loaded), options.overrides}, options, false);
  return run_study(std::move(loaded), options, false);
}

int check_verb(const std::string& scene, const std::vector<std::string>& overrides)
{
  existing(scene, "file");
  LoadedScene loaded = load_scene(scene, overrides);
  check_members(scene, overrides, loaded);
  if (!loaded.has_errors() && loaded.scene->solver == SolverChoice::continuum) {
    try {
      check_continuum_files(loaded);
    } catch (const std::exception& problem) {
      loaded.diagnostics.push_back({Diagnostic::Kind::error, "Body", problem.what()});
    }
  } else if (!loaded.has_errors() && loaded.scene->specimen.source == SpecimenSource::file) {
    try {
      make_specimen(loaded, make_packing(loaded));
    } catch (const std::exception& problem) {
      loaded.diagnostics.push_back({Diagnostic::Kind::error, "Specimen", problem.what()});
    }
  }
  if (!loaded.has_errors() && study_runs(*loaded.scene).empty()) {
    try {
      measured_curve(loaded);
    } catch (const std::invalid_argument& problem) {
      loaded.diagnostics.push_back({Diagnostic::Kind::error, "Output/Measured", problem.what()});
    }
  }
  print_diagnostics(loaded.diagnostics);
  const auto count = [&](Diagnostic::Kind kind) {
    return std::ranges::count(loaded.diagnostics, kind, &Diagnostic::kind);
  };
  if (loaded.has_errors()) {
    fmt::print("{}: {} error(s)\n", scene, count(Diagnostic::Kind::error));
    return exit_input;
  }
  fmt::print("{}: no errors, {} warning(s)\n", scene, count(Diagnostic::Kind::warning));
  return exit_ok;
}

int pack_verb(const std::string& scene, const std::string& output,
              const std::vector<std::string>& overrides)
{
  existing(scene, "file");
  const LoadedScene loaded = load_scene(scene, overrides);
  print_diagnostics(loaded.diagnostics);
  if (loaded.has_errors())
    return exit_input;
  if (loaded.scene->specimen.source != SpecimenSource::generate)
    throw std::invalid_argument("pack makes packings: the scene needs Source = generate");
  const std::filesystem::path file = output.empty() ? loaded.name + ".packing.h5" : output;
  if (file.extension() != ".h5" && file.extension() != ".csv")
    throw std::invalid_argument(
        fmt::format("{}: packings are written as .h5 or .csv", file.string()));
  const Packing packing = make_packing(loaded);
  if (file.extension() == ".csv")
    write_text_file(file, packing_csv(packing));
  else
    write_packing(file, packing, packing_recipe(*loaded.scene));
  fmt::print("{}written to {}\n", packing_report(*loaded.scene, packing), file.string());
  return exit_ok;
}

int new_verb(const std::string& kind)
{
  const std::map<std::string, std::vector<std::string>> kinds{
      {"creep", {"Title = Creep at constant stress"}},
      {"constant-rate", {"Title = Constant strain rate", "Loading/Test = constant rate"}},
      {"history",
       {"Title = Stress history", "Loading/Test = stress history",
        "Loading/Stress history = 0 s: 0 kPa, 10 s: 400 kPa, 100 s: 400 kPa, 100 s: 0 kPa, 500 s: "
        "0 kPa"}},
      {"cycles",
       {"Title = Haversine pulses with rests", "Loading/Test = haversine",
        "Strength/Rate window fraction = 0"}},
      {"network",
       {"Title = Network from files", "Specimen/Source = file", "Specimen/File = particles.csv",
        "Specimen/Bond file = bonds.csv", "Loading/Test = particle loads"}},
      {"dynamic", {"Title = Creep by the explicit solver", "Solver = dynamic"}},
      {"continuum",
       {"Title = Creep of a continuum", "Solver = continuum", "Body/Law = material.law"}},
      {"study",
       {"Title = Creep at several stresses", "Study/Vary = Loading/Axial stress",
        "Study/Values = 400 kPa, 500 kPa, 600 kPa, 1000 kPa"}}};
  const auto found = kinds.find(kind);
  if (found == kinds.end()) {
    std::vector<std::string> names;
    std::string all;
    for (const auto& [name, settings] : kinds) {
      names.push_back(name);
      all += (all.empty() ? "" : ", ") + name;
    }
    const std::string close = nearest(kind, names);
    throw std::invalid_argument(
        fmt::format("there is no kind '{}' of scene; kinds: {}{}", kind, all,
                    close.empty() ? "" : fmt::format("; did you mean '{}'?", close)));
  }
  const LoadedScene scene = load_scene_text("", kind, ".", found->second);
  fmt::print("# A scene for mastic. Every key is shown with its meaning, its unit and range, and "
             "its default;\n# keys may be left out. Check it with: mastic check FILE\n\n{}",
             scene.schema->print(true));
  return exit_ok;
}

int keys_verb()
{
  const Units units;
  Schema schema(units);
  Scene scene;
  declare(schema, scene, {{"NAME"}, {"NAME"}, {"NAME"}});
  fmt::print(
      "# All keys of a scene\n\nPrinted by `mastic keys`, version {}. A scene with all of them: "
      "`mastic new`.\n\n{}",
      MASTIC_VERSION, schema.reference());
  return exit_ok;
}

int export_verb(const std::string& result, const std::string& table, const std::string& time)
{
  const std::vector<std::string> tables{"history",   "breakages", "cycles",          "energy",
                                        "particles", "bonds",     "complex_modulus", "probes"};
  if (std::find(tables.begin(), tables.end(), table) == tables.end()) {
    const std::string close = nearest(table, tables);
    throw std::invalid_argument(
        fmt::format("there is no table '{}'; tables: {}{}", table, fmt::join(tables, ", "),
                    close.empty() ? "" : fmt::format("; did you mean '{}'?", close)));
  }
  const dem::Hdf5File file = open_stored(result_file(result), "result");
  std::vector<Column> columns;
  if (table == "particles" || table == "bonds") {
    if (!file.has("packing"))
      throw std::invalid_argument("a continuum has no particles; its fields are in paraview/");
    const Snapshot snapshot = read_snapshot(file, snapshot_group(file, time));
    columns = table == "particles" ? particle_columns(stored_particles(file), snapshot)
                                   : bond_columns(stored_ends(file), snapshot);
  } else {
    if (!file.has(table))
      throw std::invalid_argument(fmt::format("the result has no table '{}'", table));
    columns = stored_columns(file, table);
  }
  fmt::print("{}", csv(columns));
  return exit_ok;
}

int info_verb(const std::string& name)
{
  const bool unfinished = std::filesystem::is_directory(name) && has_checkpoint(name) &&
                          !std::filesystem::exists(std::filesystem::path(name) / "result.h5");
  const std::filesystem::path path = unfinished ? checkpoint_file(name) : result_file(name);
  const dem::Hdf5File file = open_stored(path, "");
  const std::string kind = file.text_attribute("", "kind");
  fmt::print("{}: {}\n", path.string(), kind);
  if (kind == "packing") {
    fmt::print("  {}\n  {}\n", file.text_attribute("", "origin"),
               file.text_attribute("", "recipe"));
    return exit_ok;
  }
  if (kind == "checkpoint") {
    fmt::print("  scene {}, solver {}\n  to go on: mastic run --resume {}\n",
               file.text_attribute("scene", "name"), file.text_attribute("scene", "solver"),
               path.string());
    return exit_ok;
  }
  for (const char* attribute :
       {"name", "title", "program", "revision", "compiler", "written_utc", "solver",
        "solver_reason", "solver_statistics", "end", "end_reason", "estimated_values"})
    fmt::print("  {:<20} {}\n", attribute, file.text_attribute("", attribute));
  if (file.text_attribute("", "solver") == "continuum") {
    for (const char* attribute : {"ranks", "wall_time_s", "cells", "unknowns", "element_order",
                                  "steps", "estimated_time_error"})
      fmt::print("  {:<20} {:g}\n", attribute, file.number_attribute("", attribute));
    fmt::print("\nscene as resolved:\n\n{}", file.read_text("scene/resolved"));
    return exit_ok;
  }
  for (const char* attribute :
       {"threads", "wall_time_s", "packing_seed", "strength_seed", "viscosity_shift_aT"})
    fmt::print("  {:<20} {:g}\n", attribute, file.number_attribute("", attribute));
  fmt::print("  {:<20} {}\n", "particles", file.read_doubles("packing/radius").size());
  fmt::print("  {:<20} {}\n", "bonds", stored_ends(file).size());
  fmt::print("  {:<20} {}\n", "broken bonds", file.read_doubles("breakages/time_s").size());
  std::string times;
  for (const std::string& each : file.members("snapshots"))
    times += fmt::format("{}{:g}", times.empty() ? "" : ", ",
                         file.number_attribute("snapshots/" + each, "time_s"));
  fmt::print("  {:<20} {} s\n\nscene as resolved:\n\n{}", "snapshots at", times,
             file.read_text("scene/resolved"));
  return exit_ok;
}

} // namespace apps
