#include "apps/cycles.h"
#include "apps/files.h"
#include "apps/paraview.h"
#include "apps/provenance.h"
#include "apps/run.h"
#include "dem/linear.h"
#include "dem/storage.h"

#include <fmt/format.h>

namespace apps {

namespace {

/// |E*| and phase angle over frequency, from the elastic solution of the run.
std::vector<Column> network_modulus_columns(const RunInProgress& r)
{
  const dem::Assembly& assembly = r.specimen.assembly;
  const dem::CreepLaw law = dem::proportional_laws(assembly.laws).value().creep;
  const dem::CreepLaw creep = dem::network_creep(law).law;
  const double elastic = r.record.history.back().compliance * assembly.area / assembly.gauge_length;
  return modulus_columns(r.scene.scene->output.frequencies,
                         [&](double omega) { return dem::complex_modulus(creep, elastic, omega); });
}

void write_provenance(dem::Hdf5File& file, const RunInProgress& r, double wall_time)
{
  write_origin(file, r.scene, "result");
  file.set_attribute("", "solver", name_of(r.decision.solver));
  file.set_attribute("", "solver_reason", r.decision.reason);
  file.set_attribute("", "solver_statistics", r.run->statistics());
  file.set_attribute("", "end", name_of(r.run->end()));
  file.set_attribute("", "end_reason", r.run->end_reason());
  file.set_attribute("", "wall_time_s", wall_time);
  file.set_attribute("", "control",
                     std::string(r.loading.control == dem::Loading::Control::displacement
                                     ? "displacement"
                                     : "force"));
  file.set_attribute("", "bonds", double(r.specimen.assembly.bonds.size()));
  for (const auto& [what, count] : r.run->counts())
    file.set_attribute("", what, count);
  file.set_attribute("", "threads", r.n_threads);
  file.set_attribute("", "packing_seed", double(r.scene.scene->specimen.seed));
  file.set_attribute("", "strength_seed", double(r.scene.scene->strength.seed));
  const std::string estimates = estimated_keys(r.scene);
  file.set_attribute("", "estimated_values", estimates.empty() ? std::string("none") : estimates);
  file.set_attribute("", "viscosity_shift_aT", r.specimen.viscosity_shift);
  if (r.specimen.assembly.strengths)
    file.set_attribute("", "nonpositive_strength_draws",
                       double(r.specimen.assembly.strengths->n_nonpositive));
  file.set_attribute("", "sign",
                     std::string("history: compression positive; bonds: tension positive"));
}

/// Where the energy went, at the times of the history.
std::vector<Column> energy_columns(const RunInProgress& r)
{
  std::vector<Column> columns{{"time_s", "s", {}},           {"work_J", "J", {}},
                              {"stored_J", "J", {}},         {"dashpots_J", "J", {}},
                              {"friction_J", "J", {}},       {"breakage_J", "J", {}},
                              {"regularisation_J", "J", {}}, {"gap_J", "J", {}}};
  for (const dem::Response& row : r.record.history)
    if (const std::optional<dem::EnergyLedger> e = r.run->energy(row.time)) {
      const double values[] = {row.time,    e->work,     e->stored,         e->dashpots,
                               e->friction, e->breakage, e->regularisation, e->gap()};
      for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c].values.push_back(values[c]);
    }
  return columns;
}

} // namespace

void write_results(const RunInProgress& r, const std::filesystem::path& folder, double wall_time)
{
  make_folder(folder);
  const dem::Assembly& assembly = r.specimen.assembly;
  const std::vector<Column> history = history_columns(face_of(assembly), r.record.history);
  const std::vector<Column> breakages = breakage_columns(assembly, r.run->breakages());
  dem::Hdf5File file = dem::Hdf5File::create(folder / "result.h5");
  write_provenance(file, r, wall_time);
  file.write_text("scene/as_typed", r.scene.text);
  file.write_text("scene/resolved", r.scene.schema->print(false));
  dem::write_particles(file, "packing", r.packing.particles);
  dem::write_bonds(file, "bonds", assembly);
  write_columns(file, "history", history);
  write_columns(file, "breakages", breakages);
  for (std::size_t k = 0; k < r.record.snapshots.size(); ++k)
    write_snapshot(file, fmt::format("snapshots/{:04}", k), r.record.snapshots[k]);
  if (r.decision.solver == SolverChoice::linear && dem::loaded_by_platen(assembly)) {
    const std::vector<Column> modulus = network_modulus_columns(r);
    write_columns(file, "complex_modulus", modulus);
    write_text_file(folder / "complex_modulus.csv", csv(modulus));
  }
  if (const std::vector<Column> energy = energy_columns(r); !energy[0].values.empty()) {
    write_columns(file, "energy", energy);
    write_text_file(folder / "energy.csv", csv(energy));
  }
  if (cyclic_load(*r.scene.scene, 1)) {
    const std::vector<Column> cycles = cycle_columns(*r.scene.scene, r.record);
    write_columns(file, "cycles", cycles);
    write_text_file(folder / "cycles.csv", csv(cycles));
  }
  if (!r.measured.time.empty()) {
    write_columns(file, "measured", measured_columns(r.measured));
    file.set_attribute("measured", "relative_rms_difference",
                       agreement(r.measured, history).difference);
  }
  file.publish();
  write_text_file(folder / "history.csv", csv(history));
  write_text_file(folder / "breakages.csv", csv(breakages));
  if (r.scene.scene->output.paraview)
    write_paraview(folder / "paraview", assembly, r.record.snapshots);
}

} // namespace apps
