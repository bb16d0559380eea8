#include "apps/quasistatic_run.h"

#include "apps/stopwatch.h"
#include "dem/storage.h"

#include <fmt/format.h>

namespace apps {

namespace {

class QuasistaticRun : public SpecimenRun {
public:
  QuasistaticRun(const dem::QuasistaticModel& model, int n_threads)
      : model_(model), solver_(model_, n_threads), state_(dem::start(model_))
  {
  }
  void work_towards(double time) override
  {
    const Stopwatch watch;
    while (!ended() && !reached(time) && watch.seconds() < work_slice)
      state_ = solver_.step(std::move(state_));
  }
  bool reached(double time) const override
  {
    return state_.time() > time || (state_.time() == time && state_.settled);
  }
  bool ended() const override { return end() != dem::RunEnd::running; }
  dem::RunEnd end() const override { return state_.end; }
  std::string end_reason() const override { return state_.end_reason; }
  double time() const override { return state_.time(); }
  dem::Response response(double time) const override { return solver_.response(state_, time); }
  Snapshot snapshot(double) const override
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
  const std::vector<dem::Breakage>& breakages() const override { return state_.breakages; }
  void save(dem::Hdf5File& file) const override { dem::write_state(file, "state", state_); }
  void load(const dem::Hdf5File& file) override
  {
    state_ = dem::read_quasistatic_state(file, "state", model_);
    solver_.resume(state_);
  }
  std::string statistics() const override
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
  Counts counts() const override
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
  bool work_is_even_in_time() const override { return false; }

private:
  dem::QuasistaticModel model_;
  dem::QuasistaticSolver solver_;
  dem::QuasistaticState state_;
};

} // namespace

std::unique_ptr<SpecimenRun> make_quasistatic_run(const dem::QuasistaticModel& model, int n_threads)
{
  return std::make_unique<QuasistaticRun>(model, n_threads);
}

} // namespace apps
