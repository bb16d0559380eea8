#include "apps/linear_run.h"

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
        limit_(strain_limit)
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
    const double force = dem::linear_response(model_, loading_, time).force;
    const double rate = averaged_rate(time);
    return {
        time, force, strain(time), rate, dem::strength_factor(rate_law_, rate), model_.compliance,
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
  std::string statistics() const override { return "1 elastic solution"; }
  Counts counts() const override
  {
    return {{"unknowns", double(model_.network.n_dofs)},
            {"steps", 0},
            {"solves", 1},
            {"factorisations", 1}};
  }
  bool work_is_even_in_time() const override { return false; }

private:
  double strain(double time) const
  {
    return dem::linear_response(model_, loading_, time).displacement / model_.gauge_length;
  }

  /// Time at which the strain reaches its limit, between one within it and one beyond.
  double first_beyond_limit(double within, double beyond) const
  {
    if (std::abs(strain(within)) >= limit_)
      return within;
    for (double middle; (middle = within + 0.5 * (beyond - within)) > within && middle < beyond;)
      (std::abs(strain(middle)) >= limit_ ? beyond : within) = middle;
    return beyond;
  }

  /// Sum over the jumps of the load up to a time.
  template <typename Function>
  double over_jumps(double time, Function&& value) const
  {
    double sum = 0, before = 0;
    for (std::size_t k = 0; k < loading_.points.size() && loading_.points[k].time <= time; ++k) {
      if (k == 0 || loading_.points[k].time == loading_.points[k - 1].time)
        sum += (loading_.points[k].value - before) * value(time - loading_.points[k].time);
      before = loading_.points[k].value;
    }
    return sum;
  }

  bool by_displacement() const { return loading_.control == dem::Loading::Control::displacement; }

  /// Strain without elastic jumps [-].
  double smooth_strain(double time) const
  {
    const double per_load = by_displacement() ? 1 : model_.compliance;
    return strain(time) -
           per_load * over_jumps(time, [](double) { return 1.0; }) / model_.gauge_length;
  }

  /// Strain rate just after a time, without elastic jumps [1/s].
  double rate(double time) const
  {
    if (by_displacement())
      return dem::load_rate(loading_, time) / model_.gauge_length;
    double sum = over_jumps(
        time, [&](double since) { return dem::creep_compliance_rate(model_.creep, since); });
    for (std::size_t k = 0; k + 1 < loading_.points.size(); ++k) {
      const double begin = loading_.points[k].time, end = loading_.points[k + 1].time;
      if (begin > time || !(end > begin))
        continue;
      const double slope =
          (loading_.points[k + 1].value - loading_.points[k].value) / (end - begin);
      const double gone = end <= time ? dem::creep_compliance(model_.creep, time - end) : 0;
      sum += slope * (dem::creep_compliance(model_.creep, time - begin) - gone);
    }
    return model_.compliance * sum / model_.gauge_length;
  }

  /// The rate that the other solvers report: averaged over the window of the rate law.
  double averaged_rate(double time) const
  {
    const double begin = loading_.points.front().time, elapsed = time - begin;
    const double span =
        std::min(elapsed, std::max(rate_law_.window, rate_law_.window_fraction * elapsed));
    if (!(span > 1e-14 * std::abs(time)))
      return rate(time);
    return (smooth_strain(time) - smooth_strain(time - span)) / span;
  }

  dem::LinearModel model_;
  dem::Loading loading_;
  dem::RateLaw rate_law_;
  double limit_;
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
