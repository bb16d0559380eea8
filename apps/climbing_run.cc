#include "apps/climbing_run.h"

#include "apps/events_run.h"
#include "apps/quasistatic_run.h"
#include "dem/climb.h"

#include <fmt/format.h>

#include <algorithm>

namespace apps {

namespace {

class ClimbingRun : public SpecimenRun {
public:
  ClimbingRun(const Scene& scene, const dem::Assembly& assembly, const dem::Loading& loading,
              int n_threads)
      : model_(quasistatic_model(scene, assembly, loading)), small_strain_(scene.small_strain),
        n_threads_(n_threads),
        events_(dem::make_events_model(assembly, loading, scene.strength.rate_law,
                                       scene.after_breakage,
                                       std::min(scene.small_strain, scene.load.strain_limit)))
  {
  }
  void work_towards(double time) override
  {
    if (!above_)
      events_.work_towards(time);
    if (!above_ && events_.end() == dem::RunEnd::strain_limit &&
        small_strain_ < model_.strain_limit)
      climb();
    if (above_)
      above_->work_towards(time);
  }
  bool reached(double time) const override
  {
    return above_ ? time < climb_time_ || above_->reached(time) : events_.reached(time);
  }
  bool ended() const override { return end() != dem::RunEnd::running; }
  dem::RunEnd end() const override
  {
    if (above_)
      return above_->end();
    const bool climbs =
        events_.end() == dem::RunEnd::strain_limit && small_strain_ < model_.strain_limit;
    return climbs ? dem::RunEnd::running : events_.end();
  }
  std::string end_reason() const override { return now().end_reason(); }
  double time() const override { return now().time(); }
  dem::Response response(double time) const override
  {
    return above_ && time >= climb_time_ ? above_->response(time) : events_.response(time);
  }
  Snapshot snapshot(double time) const override
  {
    return above_ && time >= climb_time_ ? above_->snapshot(time) : events_.snapshot(time);
  }
  std::optional<dem::EnergyLedger> energy(double time) const override
  {
    return above_ && time >= climb_time_ ? above_->energy(time) : std::nullopt;
  }
  const std::vector<dem::Breakage>& breakages() const override { return now().breakages(); }
  void save(dem::Hdf5File& file) const override
  {
    now().save(file);
    file.set_attribute("state", "climb_time", above_ ? climb_time_ : -1.0);
  }
  void load(const dem::Hdf5File& file) override
  {
    climb_time_ = file.number_attribute("state", "climb_time");
    if (climb_time_ < 0) {
      events_.load(file);
      return;
    }
    above_.emplace(model_, dem::start(model_), n_threads_);
    above_->load(file);
  }
  std::string statistics() const override
  {
    if (!above_)
      return events_.statistics();
    return fmt::format("events up to t = {:.6g} s, where the strain passed {:g} %; from there "
                       "quasistatic: {}",
                       climb_time_, 100 * small_strain_, above_->statistics());
  }
  Counts counts() const override
  {
    Counts counts = now().counts();
    if (above_)
      counts.emplace_back("climb_time_s", climb_time_);
    return counts;
  }
  bool work_is_even_in_time() const override { return false; }

private:
  const SpecimenRun& now() const
  {
    return above_ ? static_cast<const SpecimenRun&>(*above_) : events_;
  }
  void climb()
  {
    climb_time_ = events_.time();
    above_.emplace(
        model_, dem::climb(model_, events_.model(), events_.solver(), events_.state(), climb_time_),
        n_threads_);
  }

  dem::QuasistaticModel model_;
  double small_strain_;
  int n_threads_;
  EventsRun events_;
  std::optional<QuasistaticRun> above_;
  double climb_time_ = -1;
};

} // namespace

std::unique_ptr<SpecimenRun> make_climbing_run(const Scene& scene, const dem::Assembly& assembly,
                                               const dem::Loading& loading, int n_threads)
{
  return std::make_unique<ClimbingRun>(scene, assembly, loading, n_threads);
}

} // namespace apps
