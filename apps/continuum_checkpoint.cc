#include "apps/checkpoint.h"
#include "apps/continuum_progress.h"
#include "apps/files.h"
#include "apps/provenance.h"
#include "apps/text.h"
#include "fem/agreement.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <sstream>
#include <stdexcept>

namespace apps {

namespace {

std::vector<double> march_numbers(const fem::MarchState& m)
{
  return {m.time,
          m.next_step,
          m.error_sum,
          m.size,
          double(m.n_steps),
          double(m.n_rejected),
          double(m.n_solves),
          double(m.n_iterations),
          double(m.n_assemblies),
          double(m.n_changes),
          double(m.is_settled)};
}

fem::MarchState march_of(const std::vector<double>& n)
{
  fem::MarchState m;
  m.time = n.at(0);
  m.next_step = n.at(1);
  m.error_sum = n.at(2);
  m.size = n.at(3);
  m.n_steps = long(n.at(4));
  m.n_rejected = long(n.at(5));
  m.n_solves = long(n.at(6));
  m.n_iterations = long(n.at(7));
  m.n_assemblies = long(n.at(8));
  m.n_changes = long(n.at(9));
  m.is_settled = n.at(10) != 0;
  return m;
}

std::vector<double> probe_numbers(const ContinuumRecord& record)
{
  std::vector<double> numbers;
  for (const auto& readings : record.probe_readings)
    for (const fem::ProbeReading& r : readings) {
      numbers.insert(numbers.end(), r.displacement.begin(), r.displacement.end());
      numbers.insert(numbers.end(), r.strain.begin(), r.strain.end());
      numbers.insert(numbers.end(), r.stress.begin(), r.stress.end());
    }
  return numbers;
}

void restore_probes(ContinuumRecord& record, const std::vector<double>& numbers)
{
  constexpr std::size_t n = 15;
  const std::size_t n_times = record.probe_times.size();
  const std::size_t n_places = n_times ? numbers.size() / n / n_times : 0;
  for (std::size_t k = 0; k < n_times; ++k) {
    record.probe_readings.emplace_back();
    for (std::size_t p = 0; p < n_places; ++p) {
      const double* const from = &numbers[(k * n_places + p) * n];
      record.probe_readings.back().push_back({Eigen::Map<const fem::Vec3>(from),
                                              Eigen::Map<const fem::Vec6>(from + 3),
                                              Eigen::Map<const fem::Vec6>(from + 9)});
    }
  }
}

std::vector<double> volume_numbers(const ContinuumRecord& record)
{
  std::vector<double> numbers;
  for (const VolumeReading& r : record.volumes)
    numbers.insert(numbers.end(), {r.time, r.n_broken, r.n_bonds, r.n_live, r.n_points,
                                   r.strength_use, r.n_failed});
  return numbers;
}

void restore_volumes(ContinuumRecord& record, const std::vector<double>& n)
{
  for (std::size_t k = 0; k + 6 < n.size(); k += 7)
    record.volumes.push_back({n[k], n[k + 1], n[k + 2], n[k + 3], n[k + 4], n[k + 5], n[k + 6]});
}

void write_all(dem::Hdf5File& file, const LoadedScene& scene, const std::filesystem::path& folder,
               const StoredContinuum& stored)
{
  write_origin(file, scene, "checkpoint");
  file.write_text("scene/resolved", scene.schema->print(false));
  file.write_text("scene/as_typed", scene.text);
  file.set_attribute("scene", "name", scene.name);
  file.set_attribute("scene", "folder", absolute_folder(scene.folder).string());
  file.set_attribute("scene", "solver", std::string("continuum"));
  file.set_attribute("scene", "files_fingerprint", stored.files);
  file.set_attribute("scene", "result_folder", absolute_folder(folder).string());
  file.write_text("cells/names", fmt::format("{}", fmt::join(stored.cells.names, "\n")));
  std::vector<double> states;
  for (const std::vector<double>& each : stored.cells.states)
    states.insert(states.end(), each.begin(), each.end());
  file.write("cells/states", states, "SI", int(stored.cells.states.front().size()));
  file.write("march", march_numbers(stored.march), "SI");
  file.write("scalars",
             std::vector<double>{stored.drive_displacement, stored.last_step,
                                 stored.elastic_compliance, stored.last_time, stored.last_motion,
                                 stored.wall_time, double(stored.n_recorded),
                                 double(stored.n_jumped), stored.drive_force},
             "SI");
  RunRecord history;
  history.history = stored.record.history;
  write_record(file, "record", history);
  std::string names;
  std::vector<double> times;
  for (const auto& [time, name] : stored.record.fields) {
    names += name + "\n";
    times.push_back(time);
  }
  file.write_text("record/field_files", names);
  file.write("record/field_times", times, "s");
  file.write("record/volumes", volume_numbers(stored.record), "SI");
  file.write("record/probe_times", stored.record.probe_times, "s");
  file.write("record/probe_readings", probe_numbers(stored.record), "SI");
}

} // namespace

std::string continuum_fingerprint(const LoadedScene& scene)
{
  const ContinuumInput& v = scene.scene->continuum;
  std::vector<std::string> names{v.body.law_file};
  for (const auto& region : v.regions)
    names.push_back(region.second);
  if (v.body.shape == BodyShape::file)
    names.push_back(v.body.mesh_file);
  if (has_volumes(v) && scene.scene->element.source == ElementSource::file)
    names.push_back(scene.scene->specimen.file);
  std::string all;
  for (const std::string& name : names)
    if (!name.empty())
      all += read_text_file(scene.folder / name);
  return fmt::format("{:016x}", std::hash<std::string>()(all));
}

template <int dim>
void write_continuum_checkpoint(const ContinuumInProgress<dim>& run,
                                const std::filesystem::path& folder)
{
  const StoredContinuum stored{
      fem::gathered(run.mesh, fem::cell_states(*run.specimen, *run.points)),
      run.march,
      run.record,
      run.specimen->drive_displacement(),
      run.points->last_step(),
      run.elastic_compliance,
      run.last_time,
      run.last_motion,
      run.wall_time,
      run.n_recorded,
      run.n_jumped,
      continuum_fingerprint(run.scene),
      run.specimen->drive_force()};
  fem::together(run.ranks.all(), [&] {
    if (!run.ranks.first())
      return;
    const std::filesystem::path path = checkpoint_file(folder);
    dem::Hdf5File file = dem::Hdf5File::create(path);
    write_all(file, run.scene, folder, stored);
    publish_checkpoint(file, path);
  });
}

StoredContinuum read_continuum_checkpoint(const dem::Hdf5File& file)
{
  StoredContinuum stored;
  stored.cells.names = split(file.read_text("cells/names"), '\n');
  const std::vector<double> states = file.read_doubles("cells/states");
  const std::size_t n = states.size() / stored.cells.names.size();
  for (std::size_t k = 0; k < stored.cells.names.size(); ++k)
    stored.cells.states.emplace_back(states.begin() + long(k * n),
                                     states.begin() + long((k + 1) * n));
  stored.march = march_of(file.read_doubles("march"));
  const std::vector<double> scalars = file.read_doubles("scalars");
  stored.drive_displacement = scalars.at(0);
  stored.last_step = scalars.at(1);
  stored.elastic_compliance = scalars.at(2);
  stored.last_time = scalars.at(3);
  stored.last_motion = scalars.at(4);
  stored.wall_time = scalars.at(5);
  stored.n_recorded = std::size_t(scalars.at(6));
  stored.n_jumped = std::size_t(scalars.at(7));
  stored.drive_force = scalars.size() > 8 ? scalars[8] : 0;
  stored.files = file.text_attribute("scene", "files_fingerprint");
  stored.record.history = read_record(file, "record").history;
  const std::vector<std::string> names = split(trimmed(file.read_text("record/field_files")), '\n');
  const std::vector<double> times = file.read_doubles("record/field_times");
  for (std::size_t k = 0; k < times.size(); ++k)
    stored.record.fields.emplace_back(times[k], names.at(k));
  restore_volumes(stored.record, file.read_doubles("record/volumes"));
  stored.record.probe_times = file.read_doubles("record/probe_times");
  restore_probes(stored.record, file.read_doubles("record/probe_readings"));
  return stored;
}

template void write_continuum_checkpoint(const ContinuumInProgress<2>&,
                                         const std::filesystem::path&);
template void write_continuum_checkpoint(const ContinuumInProgress<3>&,
                                         const std::filesystem::path&);

} // namespace apps
