#include "apps/load_case.h"

#include "apps/cycles.h"

#include <algorithm>
#include <cmath>

namespace apps {

namespace {

dem::Loading from_history(const std::vector<std::pair<double, double>>& history,
                          dem::Loading::Control control, double factor)
{
  dem::Loading loading{control, {}, false};
  for (const auto& [time, value] : history)
    loading.points.push_back({time, factor * value});
  return loading;
}

std::vector<double> sorted(std::vector<double> times)
{
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Times spread over the test as asked for, and all points of the load.
std::vector<double> spaced_times(const Scene& scene, const dem::Loading& loading)
{
  const Scene::Output& v = scene.output;
  const double start = loading.points.front().time, end = dem::end_time(loading);
  const bool creeps =
      scene.load.test == TestKind::creep || scene.load.test == TestKind::particle_loads ||
      (scene.load.test == TestKind::boundary_loads && scene.load.factor_history.empty());
  const bool logarithmic =
      v.spacing == TimeSpacing::logarithmic || (v.spacing == TimeSpacing::automatic && creeps);
  std::vector<double> times{start};
  const double first = std::min(v.first_time, end - start);
  const auto n = double(std::max(1L, v.n_times - 1));
  const auto series = [&](double begin, double length) {
    for (long k = 0; k < v.n_times; ++k)
      times.push_back(logarithmic && length > first
                          ? begin + first * std::pow(length / first, double(k) / n)
                          : begin + length * double(k + 1) / double(v.n_times));
  };
  if (creeps && scene.load.release_time) { // recovery anew
    series(start, *scene.load.release_time - start);
    series(*scene.load.release_time, end - *scene.load.release_time);
  } else
    series(start, end - start);
  for (std::size_t k = 0; k < loading.points.size(); ++k) {
    const double time = loading.points[k].time;
    times.push_back(time);
    if (k > 0 && time == loading.points[k - 1].time) // a jump: what was before it, too
      times.push_back(std::nextafter(time, start));
  }
  return times;
}

} // namespace

dem::Loading make_loading(const Scene& scene, double area, double length)
{
  using Control = dem::Loading::Control;
  const Scene::Load& v = scene.load;
  const double force = -area, displacement = -length;
  dem::Loading loading;
  if (v.test == TestKind::creep && v.release_time)
    loading = dem::step_and_release(force * v.stress, *v.release_time, v.end_time);
  else if (v.test == TestKind::creep)
    loading = dem::step_load(Control::force, force * v.stress, v.end_time);
  else if (v.test == TestKind::constant_rate)
    loading = dem::ramp(Control::displacement, displacement * v.strain_rate,
                        *v.end_strain / std::abs(v.strain_rate));
  else if (v.test == TestKind::stress_history)
    loading = from_history(v.stress_history, Control::force, force);
  else if (v.test == TestKind::strain_history)
    loading = from_history(v.strain_history, Control::displacement, displacement);
  else if (const auto cyclic = cyclic_load(scene, area))
    loading = dem::cyclic_loading(*cyclic);
  else if (!v.factor_history.empty())
    loading = from_history(v.factor_history, Control::force, 1);
  else if (v.test == TestKind::boundary_loads && v.release_time)
    loading = dem::step_and_release(1, *v.release_time, v.end_time);
  else
    loading = dem::step_load(Control::force, 1, v.end_time);
  loading.true_stress = v.true_stress;
  return loading;
}

std::vector<double> history_times(const Scene& scene, const dem::Loading& loading)
{
  const double start = loading.points.front().time, end = dem::end_time(loading);
  std::vector<double> times =
      cyclic_load(scene, 1) ? cycle_times(scene, loading) : spaced_times(scene, loading);
  for (const ExpectedValue& expected : scene.expect.values)
    if (expected.table == ExpectedValue::Table::history)
      times.push_back(expected.time);
  for (double& time : times)
    time = std::clamp(time, start, end);
  return sorted(times);
}

std::vector<double> snapshot_times(const Scene& scene, const dem::Loading& loading)
{
  const double start = loading.points.front().time, end = dem::end_time(loading);
  std::vector<double> times{start, end};
  for (const double time : scene.output.snapshot_times)
    if (time > start && time < end)
      times.push_back(time);
  for (const ExpectedValue& expected : scene.expect.values)
    if (expected.table != ExpectedValue::Table::history && expected.time > start &&
        expected.time < end)
      times.push_back(expected.time);
  return sorted(times);
}

double face_stress(const dem::Assembly& assembly, double platen_force)
{
  return -platen_force / assembly.area;
}

} // namespace apps
