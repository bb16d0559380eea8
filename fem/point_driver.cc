#include "fem/point_driver.h"

#include <Eigen/LU>
#include <fmt/format.h>

#include <stdexcept>

namespace fem {

namespace {

/// The strain increment of a step at which all that is prescribed is met: the stress is affine in
/// it, so one solution does.
Vec6 strain_increment(const ConstitutiveAnswer& at_rest, const Vec6& strain, const Vec6& target,
                      const std::array<bool, 6>& strain_given)
{
  Mat6 system = at_rest.tangent[0];
  Vec6 right = target - at_rest.stress[0];
  for (int c = 0; c < 6; ++c)
    if (strain_given[std::size_t(c)]) {
      system.row(c) = Mat6::Identity().row(c) * at_rest.tangent[0](c, c);
      right[c] = (target[c] - strain[c]) * at_rest.tangent[0](c, c);
    }
  return system.partialPivLu().solve(right);
}

/// One point under way.
class Driver {
public:
  Driver(const ComplianceLaw& law, TimeScheme scheme, const std::array<bool, 6>& strain_given)
      : points_(std::span(&law, 1), {0}, scheme), strain_given_(strain_given)
  {
  }

  /// Tries a step; \return its estimated error.
  double attempt(double step, const Vec6& target)
  {
    const Vec6 still = Vec6::Zero();
    const ConstitutiveAnswer at_rest = points_.evaluate(std::span(&still, 1), step);
    const Vec6 increment = strain_increment(at_rest, points_.strain()[0], target, strain_given_);
    points_.evaluate(std::span(&increment, 1), step);
    constexpr double weight = 1;
    const StepError error = points_.step_error(std::span(&weight, 1));
    size_ = std::max(size_, std::sqrt(error.size_square));
    return size_ > 0 ? std::sqrt(error.square) / size_ : 0;
  }

  void commit() { points_.commit(); }
  PointReading reading(double time) const
  {
    return {time, points_.strain()[0], points_.stress()[0]};
  }

private:
  LawPoints points_;
  std::array<bool, 6> strain_given_;
  double size_ = 0; ///< largest strain or stress so far
};

/// From one target to the next one, at a later time.
void march(Driver& driver, const PointTarget& from, const PointTarget& to,
           const StepSettings& settings, double& step, PointRun& run)
{
  const double whole = to.time - from.time;
  double time = from.time;
  while (time < to.time) {
    const double way = to.time - time;
    double h = step_within(step > 0 ? step : settings.first_step, way);
    while (true) {
      const double end = h == way ? to.time : time + h;
      const double share = (end - from.time) / whole;
      const double error = driver.attempt(end - time, (1 - share) * from.value + share * to.value);
      if (error <= settings.tolerance) {
        driver.commit();
        step = std::max(next_step(h, error, settings), h == way ? step : 0.);
        time = end;
        run.error_sum += error;
        ++run.n_steps;
        break;
      }
      h = smaller_step(h, error, settings);
      step = h;
      if (!(h > 1e-12 * whole))
        throw std::runtime_error(
            fmt::format("at {:.6g} s of reduced time no step is small enough", time));
    }
  }
}

} // namespace

PointRun drive_point(const ComplianceLaw& law, TimeScheme scheme,
                     const std::array<bool, 6>& strain_given, std::span<const PointTarget> targets,
                     const StepSettings& settings)
{
  Driver driver(law, scheme, strain_given);
  PointRun run;
  PointTarget last{0, Vec6::Zero()};
  double step = 0;
  for (const PointTarget& target : targets) {
    if (!(target.time >= last.time))
      throw std::invalid_argument(fmt::format(
          "times must not decrease or be negative: {:g} s after {:g} s", target.time, last.time));
    const bool first = run.readings.empty();
    if (target.time > last.time)
      march(driver, first ? PointTarget{last.time, Vec6::Zero()} : last, target, settings, step,
            run);
    else {
      driver.attempt(0, target.value);
      driver.commit();
      step = 0;
    }
    run.readings.push_back(driver.reading(target.time));
    last = target;
  }
  return run;
}

} // namespace fem
