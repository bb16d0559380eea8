#pragma once
#include "apps/specimen_run.h"
#include "dem/quasistatic.h"

namespace apps {

/// The quasi-static model of a scene.
dem::QuasistaticModel quasistatic_model(const Scene& scene, const dem::Assembly& assembly,
                                        const dem::Loading& loading);

/// A run of the quasi-static solver.
class QuasistaticRun : public SpecimenRun {
public:
  /// \param state  to go on from
  QuasistaticRun(const dem::QuasistaticModel& model, dem::QuasistaticState state, int n_threads)
      : model_(model), solver_(model_, n_threads), state_(std::move(state))
  {
  }
  void work_towards(double time) override;
  bool reached(double time) const override
  {
    return state_.time() > time || (state_.time() == time && state_.settled);
  }
  bool ended() const override { return end() != dem::RunEnd::running; }
  dem::RunEnd end() const override { return state_.end; }
  std::string end_reason() const override { return state_.end_reason; }
  double time() const override { return state_.time(); }
  dem::Response response(double time) const override { return solver_.response(state_, time); }
  Snapshot snapshot(double) const override;
  std::optional<dem::EnergyLedger> energy(double time) const override
  {
    return dem::point_at(state_.path, time).energy;
  }
  const std::vector<dem::Breakage>& breakages() const override { return state_.breakages; }
  void save(dem::Hdf5File& file) const override;
  void load(const dem::Hdf5File& file) override;
  std::string statistics() const override;
  Counts counts() const override;
  bool work_is_even_in_time() const override { return false; }

private:
  dem::QuasistaticModel model_;
  dem::QuasistaticSolver solver_;
  dem::QuasistaticState state_;
};

} // namespace apps
