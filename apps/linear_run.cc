#include "apps/linear_run.h"

#include "apps/equations_text.h"
#include "dem/linear.h"

#include <algorithm>
#include <cmath>

namespace apps {

namespace {

class LinearRun : public SpecimenRun {
public:
  LinearRun(const dem::Assembly& assembly, const dem::Loading& loading,
            const dem::RateLaw& rate_law, double strain_limit)
      : model_(dem::make_linear_model(assembly)), loading_(loading), rate_law_(rate_law),
        limit_(strain_limit), history_(dem::linear_history(model_, loading))
  {
  }
  void work_towards(double time) override
  {
    const double before = std::max(time_, loading_.points.front().time);
    time_ = time;
    if (std::abs(strain(time)) >= limit_) {
      time_ = first_beyond_limit(before, time);
      end_ = dem::RunEnd::strain_limit;
    } else if (time >= dem::end_time(loading_))
      end_ = dem::RunEnd::finished;
  }
  bool reached(double time) const override { return time_ >= time; }
  bool ended() const override { return end_ != dem::RunEnd::running; }
  dem::RunEnd end() const override { return end_; }
  std::string end_reason() const override { return {}; }
  double time() const override { return time_; }
  dem::Response response(double time) const override
  {
    const double load = dem::load(dem::segment_at(history_, time), history_.creep, time);
    const bool by_force = loading_.control == dem::Loading::Control::force;
    const double rate = dem::averaged_strain_rate(history_, rate_law_, time);
    return {time, by_force ? load : load / model_.compliance, strain(time),
            rate, dem::strength_factor(rate_law_, rate),      model_.compliance,
            0};
  }
  Snapshot snapshot(double time) const override
  {
    const std::vector<dem::BondStatus> intact(model_.network.bonds.size(), dem::BondStatus::intact);
    return network_snapshot(model_.network, time, intact,
                            dem::displacements(model_, loading_, time),
                            dem::elastic_displacements(model_, loading_, time));
  }
  const std::vector<dem::Breakage>& breakages() const override { return none_; }
  void save(dem::Hdf5File& file) const override
  {
    file.write("state/time", std::vector{time_}, "s");
  }
  void load(const dem::Hdf5File& file) override
  {
    work_towards(file.read_doubles("state/time").at(0)); // finds out, too, whether that was the end
  }
  std::string statistics() const override
  {
    return "1 elastic solution: " + equations_text(model_.network, model_.statistics);
  }
  Counts counts() const override
  {
    return {{"unknowns", double(model_.network.n_dofs)},
            {"steps", 0},
            {"solves", 1},
            {"factorisations", 1}};
  }
  bool work_is_even_in_time() const override { return false; }

private:
  double strain(double time) const { return dem::strain(history_, time); }

  /// Time at which the strain reaches its limit, between one within it and one beyond.
  double first_beyond_limit(double within, double beyond) const
  {
    if (std::abs(strain(within)) >= limit_)
      return within;
    for (double middle; (middle = within + 0.5 * (beyond - within)) > within && middle < beyond;)
      (std::abs(strain(middle)) >= limit_ ? beyond : within) = middle;
    return beyond;
  }

  dem::LinearModel model_;
  dem::Loading loading_;
  dem::RateLaw rate_law_;
  double limit_;
  dem::LoadHistory history_;
  double time_ = -1;
  dem::RunEnd end_ = dem::RunEnd::running;
  std::vector<dem::Breakage> none_;
};

} // namespace

std::unique_ptr<SpecimenRun> make_linear_run(const dem::Assembly& assembly,
                                             const dem::Loading& loading,
                                             const dem::RateLaw& rate_law, double strain_limit)
{
  return std::make_unique<LinearRun>(assembly, loading, rate_law, strain_limit);
}

} // namespace apps
