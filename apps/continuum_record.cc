#include "apps/continuum_record.h"

#include "apps/cycles.h"
#include "apps/files.h"
#include "apps/provenance.h"
#include "fem/mandel.h"

#include <fmt/format.h>

namespace apps {

std::vector<Column> probe_columns(const std::vector<fem::Vec3>& places,
                                  const ContinuumRecord& record)
{
  std::vector<Column> columns{{"time_s", "s", {}}, {"probe", "1", {}}, {"x_mm", "mm", {}},
                              {"y_mm", "mm", {}},  {"z_mm", "mm", {}}, {"ux_mm", "mm", {}},
                              {"uy_mm", "mm", {}}, {"uz_mm", "mm", {}}};
  for (const char* name : {"xx", "yy", "zz", "yz", "xz", "xy"})
    columns.push_back({fmt::format("strain_{}_percent", name), "%", {}});
  for (const char* name : {"xx", "yy", "zz", "yz", "xz", "xy"})
    columns.push_back({fmt::format("stress_{}_kPa", name), "kPa", {}});
  for (std::size_t t = 0; t < record.probe_times.size(); ++t)
    for (std::size_t k = 0; k < places.size(); ++k) {
      const fem::ProbeReading& reading = record.probe_readings[t][k];
      std::vector<double> row{record.probe_times[t], double(k)};
      for (int c = 0; c < 3; ++c)
        row.push_back(1e3 * places[k][c]);
      for (int c = 0; c < 3; ++c)
        row.push_back(1e3 * reading.displacement[c]);
      const fem::Vec6 strain = fem::tensor_components(reading.strain);
      const fem::Vec6 stress = fem::tensor_components(reading.stress);
      for (int c = 0; c < 6; ++c)
        row.push_back(100 * strain[c]);
      for (int c = 0; c < 6; ++c)
        row.push_back(stress[c] / 1e3);
      for (std::size_t c = 0; c < row.size(); ++c)
        columns[c].values.push_back(row[c]);
    }
  return columns;
}

std::string statistics(const fem::MarchState& march)
{
  return fmt::format(
      "{} time steps, {} of them tried again smaller; {} linear solves, {} "
      "iterations, {} matrices with their multigrid; estimated error of the time steps "
      "together {:.2g}{}",
      march.n_steps, march.n_rejected, march.n_solves, march.n_iterations, march.n_assemblies,
      march.error_sum,
      march.n_changes > 0
          ? fmt::format("; {} times equilibrium anew after breakages", march.n_changes)
          : "");
}

void write_continuum_results(const ContinuumResult& r, const std::filesystem::path& folder)
{
  const std::vector<Column> history = history_columns(r.face, r.record.history);
  dem::Hdf5File file = dem::Hdf5File::create(folder / "result.h5");
  write_origin(file, r.scene, "result");
  const auto set = [&](const char* name, const auto& value) {
    file.set_attribute("", name, value);
  };
  set("solver", std::string("continuum"));
  set("solver_reason", std::string("the scene asks for it"));
  set("solver_statistics", statistics(r.march));
  set("end", r.end);
  set("end_reason", r.end_reason);
  set("wall_time_s", r.wall_time);
  set("control", std::string(r.by_displacement ? "displacement" : "force"));
  set("threads", double(r.size.n_ranks));
  set("ranks", double(r.size.n_ranks));
  set("cells", double(r.size.n_cells));
  set("unknowns", double(r.size.n_unknowns));
  set("element_order", double(r.size.order));
  set("time_scheme", r.size.scheme);
  set("steps", double(r.march.n_steps));
  set("solves", double(r.march.n_solves));
  set("factorisations", double(r.march.n_assemblies));
  set("estimated_time_error", r.march.error_sum);
  const bool volumes = has_volumes(r.scene.scene->continuum);
  const std::string estimates = volumes ? estimated_keys(r.scene) : "";
  set("estimated_values", estimates.empty() ? std::string("none") : estimates);
  if (volumes) {
    set("packing_seed", double(r.scene.scene->specimen.seed));
    set("strength_seed", double(r.scene.scene->strength.seed));
  }
  set("bonds", r.record.volumes.empty() ? 0. : r.record.volumes.back().n_bonds);
  set("sign", std::string("history: compression positive; probes and fields: tension positive"));
  file.write_text("scene/as_typed", r.scene.text);
  file.write_text("scene/resolved", r.scene.schema->print(false));
  for (std::size_t k = 0; k < r.laws.size(); ++k)
    file.write_text(fmt::format("laws/{}", k), r.laws[k]);
  write_columns(file, "history", history);
  if (cyclic_load(*r.scene.scene, 1)) {
    RunRecord record;
    record.history = r.record.history;
    const std::vector<Column> cycles = cycle_columns(*r.scene.scene, record);
    write_columns(file, "cycles", cycles);
    write_text_file(folder / "cycles.csv", csv(cycles));
  }
  if (!r.record.volumes.empty()) {
    const std::vector<Column> readings = volume_columns(r.record.volumes);
    write_columns(file, "volumes", readings);
    write_text_file(folder / "volumes.csv", csv(readings));
  }
  if (r.damage)
    write_damage(file, *r.damage);
  if (!r.modulus.empty()) {
    write_columns(file, "complex_modulus", r.modulus);
    write_text_file(folder / "complex_modulus.csv", csv(r.modulus));
  }
  if (!r.places.empty()) {
    const std::vector<Column> probes = probe_columns(r.places, r.record);
    write_columns(file, "probes", probes);
    write_text_file(folder / "probes.csv", csv(probes));
  }
  file.publish();
  write_text_file(folder / "history.csv", csv(history));
}

} // namespace apps
