#pragma once
#include "apps/specimen_run.h"
#include "dem/events.h"

namespace apps {

/// A run of the event solver.
class EventsRun : public SpecimenRun {
public:
  explicit EventsRun(const dem::EventsModel& model) : model_(model), solver_(model_)
  {
    state_ = solver_.start();
  }
  void work_towards(double time) override;
  bool reached(double time) const override { return solver_.next_change(state_) > time; }
  bool ended() const override { return state_.end != dem::RunEnd::running; }
  dem::RunEnd end() const override { return state_.end; }
  std::string end_reason() const override { return state_.end_reason; }
  double time() const override { return dem::start(state_.history.segments.back()); }
  dem::Response response(double time) const override { return solver_.response(state_, time); }
  Snapshot snapshot(double time) const override;
  const std::vector<dem::Breakage>& breakages() const override { return state_.breakages; }
  void save(dem::Hdf5File& file) const override;
  void load(const dem::Hdf5File& file) override;
  std::string statistics() const override;
  Counts counts() const override;
  bool work_is_even_in_time() const override { return false; }

  const dem::EventsModel& model() const { return model_; }
  const dem::EventsSolver& solver() const { return solver_; }
  const dem::EventsState& state() const { return state_; }

private:
  dem::EventsModel model_;
  dem::EventsSolver solver_;
  dem::EventsState state_;
  long n_steps_ = 0; ///< changes followed, since the start or the last resumption
};

} // namespace apps
