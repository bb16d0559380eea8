#include "apps/quasistatic_run.h"

#include "apps/specimen.h"
#include "apps/stopwatch.h"
#include "dem/storage.h"

#include <fmt/format.h>

namespace apps {

dem::QuasistaticModel quasistatic_model(const Scene& scene, const dem::Assembly& assembly,
                                        const dem::Loading& loading)
{
  dem::QuasistaticSettings settings = scene.quasistatic;
  settings.after_breakage = scene.after_breakage;
  settings.friction = scene.friction;
  return dem::make_quasistatic_model(assembly, loading, scene.strength.rate_law, settings,
                                     scene.load.strain_limit, make_reduced_time(scene));
}

void QuasistaticRun::work_towards(double time)
{
  const Stopwatch watch;
  while (!ended() && !reached(time) && watch.seconds() < work_slice)
    state_ = solver_.step(std::move(state_));
}

Snapshot QuasistaticRun::snapshot(double) const
{
  Snapshot snapshot{time(), {}, {}, {}, {}, {}};
  for (std::size_t i = 0; i < model_.assembly.particles.size(); ++i) {
    const dem::BodyMotion m = dem::motion(model_, state_, dem::Index(i));
    snapshot.displacement.push_back(m.displacement);
    snapshot.rotation.push_back(m.rotation);
  }
  for (std::size_t b = 0; b < model_.assembly.bonds.size(); ++b) {
    const dem::BondLoad load = dem::link_load(state_.links, b);
    const dem::Link& link = state_.links.link[b];
    snapshot.force.push_back(load.force);
    snapshot.moment.push_back(load.moment);
    snapshot.state.push_back(link.kind == dem::LinkKind::bond ? 0 : link.closed ? 1 : 2);
  }
  return snapshot;
}

void QuasistaticRun::load(const dem::Hdf5File& file)
{
  state_ = dem::read_quasistatic_state(file, "state", model_);
  solver_.resume(state_);
}

std::string QuasistaticRun::statistics() const
{
  const dem::StaleFactor::Statistics& s = solver_.finder().factor().statistics();
  const dem::EnergyLedger& energy = state_.path.back().energy;
  return fmt::format(
      "{} unknowns, {} steps in time ({} tried in vain), {} equilibria, {} linear solves with {} "
      "iterations, {} factorisations, {} analyses, {} passages; energy: work {:.3g} J, stored "
      "{:.1f} %, dashpots {:.1f} %, friction {:.1f} %, breakage {:.1f} %, regularisation {:.1e}, "
      "gap {:.1e}",
      model_.dofs.n_dofs, state_.n_steps, state_.n_rejected, state_.path.size(), s.n_solves,
      s.n_iterations, s.n_factorisations, s.n_analyses, state_.n_passages, energy.work,
      100 * energy.stored / energy.work, 100 * energy.dashpots / energy.work,
      100 * energy.friction / energy.work, 100 * energy.breakage / energy.work,
      energy.regularisation / energy.work, energy.gap() / energy.work);
}

Counts QuasistaticRun::counts() const
{
  const dem::StaleFactor::Statistics& s = solver_.finder().factor().statistics();
  const dem::EnergyLedger& energy = state_.path.back().energy;
  const double scale = energy.work != 0 ? energy.work : 1;
  return {{"unknowns", double(model_.dofs.n_dofs)},
          {"steps", double(state_.n_steps)},
          {"rejected_steps", double(state_.n_rejected)},
          {"equilibria", double(state_.path.size())},
          {"solves", double(s.n_solves)},
          {"iterations", double(s.n_iterations)},
          {"factorisations", double(s.n_factorisations)},
          {"passages", double(state_.n_passages)},
          {"regularisation_energy_share", energy.regularisation / scale},
          {"energy_gap_share", energy.gap() / scale}};
}

void QuasistaticRun::save(dem::Hdf5File& file) const
{
  dem::write_state(file, "state", state_);
}

} // namespace apps
