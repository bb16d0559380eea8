#include "apps/audit.h"

#include "apps/files.h"
#include "dem/bonds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apps {

void print_scaling_audit(const RunInProgress& r, const std::filesystem::path& folder)
{
  const Scene& scene = *r.scene.scene;
  const dem::Assembly& assembly = r.specimen.assembly;
  if (!dem::proportional_laws(assembly.laws)) {
    fmt::print("  scaling audit: not possible, the bond laws are not proportional\n");
    return;
  }
  Scene exact_scene_values; // only the members that the solvers read
  const bool breaks = assembly.strengths.has_value();
  const dem::AfterBreakage after = scene.after_breakage == dem::AfterBreakage::leave
                                       ? dem::AfterBreakage::leave
                                       : dem::AfterBreakage::pressed;
  exact_scene_values.strength = scene.strength;
  exact_scene_values.load = scene.load;
  exact_scene_values.after_breakage = after;
  const SolverChoice solver =
      breaks || r.loading.true_stress ? SolverChoice::events : SolverChoice::linear;
  const auto exact = make_run(solver, exact_scene_values, assembly, r.loading, 1);

  std::vector<Column> columns{{"time_s", "s", {}},
                              {"strain_percent", "%", {}},
                              {"exact_strain_percent", "%", {}},
                              {"broken_bonds", "1", {}},
                              {"exact_broken_bonds", "1", {}}};
  double worst_late = 0, worst_time = 0;
  const double last = r.record.history.back().time;
  for (const dem::Response& found : r.record.history) {
    const double time = std::min(found.time, dem::end_time(r.loading)); // the last step goes beyond
    while (!exact->ended() && !exact->reached(time))
      exact->work_towards(time);
    if (exact->ended() && exact->time() < time)
      break;
    const dem::Response expected = exact->response(time);
    const double row[] = {found.time, -100 * found.strain, -100 * expected.strain,
                          double(found.n_broken), double(expected.n_broken)};
    for (std::size_t k = 0; k < columns.size(); ++k)
      columns[k].values.push_back(row[k]);
    const double error = std::abs(found.strain / expected.strain - 1);
    if (found.time >= 0.1 * last && std::isfinite(error) && error >= worst_late) {
      worst_late = error;
      worst_time = found.time;
    }
  }
  write_text_file(folder / "audit.csv", csv(columns));
  if (columns[0].values.size() < 2 || columns[2].values.back() == 0)
    return;
  fmt::print("  scaling audit against '{}' (x = {:g}): strain off by up to {:.2g} % in the last 90 "
             "% of the time (at {:.4g} s), by {:.2g} % at {:.4g} s; {:.0f} bonds broken, exact "
             "{:.0f}\n",
             name_of(solver), scene.dynamic.viscosity_scaling, 100 * worst_late, worst_time,
             100 * std::abs(columns[1].values.back() / columns[2].values.back() - 1),
             columns[0].values.back(), columns[3].values.back(), columns[4].values.back());
  if (scene.after_breakage == dem::AfterBreakage::friction)
    fmt::print("  (the exact solver has no friction in broken contacts: that difference is "
               "included)\n");
}

} // namespace apps
