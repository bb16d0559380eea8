#include "apps/cycles.h"

#include <algorithm>
#include <cmath>

namespace apps {

namespace {

/// Times that count as one: the explicit solver meets a time to rounding of its step.
constexpr double same_time = 1e-11;

struct CycleStrains {
  double peak, permanent; ///< compression positive [-]
  double n_broken;
};

/// First row of the history at or after a time.
auto row_at(const RunRecord& record, double time)
{
  return std::ranges::lower_bound(record.history, time * (1 - same_time), {}, &dem::Response::time);
}

/// What a cycle between two times did; nothing if the run ended before.
std::optional<CycleStrains> strains(const RunRecord& record, double start, double end,
                                    double direction)
{
  const auto last = row_at(record, end); // before a jump, if there is one
  if (last == record.history.end())
    return std::nullopt;
  const auto peak = std::ranges::max_element(row_at(record, start), last + 1, {},
                                             [&](const auto& r) { return direction * r.strain; });
  return CycleStrains{-peak->strain, -last->strain, double(last->n_broken)};
}

} // namespace

std::optional<dem::CyclicLoad> cyclic_load(const Scene& scene, double area)
{
  using Pulse = dem::CyclicLoad::Pulse;
  const Scene::Load& v = scene.load;
  const double peak = -area * v.peak_stress, base = v.contact_share * peak;
  dem::CyclicLoad load{Pulse::haversine, base,       peak - base,       v.loading_time,
                       v.rest_time,      v.n_cycles, v.points_per_pulse};
  if (v.test == TestKind::haversine)
    return load;
  load.pulse = Pulse::block;
  if (v.test == TestKind::block_pulses)
    return load;
  if (v.test == TestKind::sine)
    return dem::CyclicLoad{
        Pulse::sine, -area * v.mean_stress, -area * v.stress_amplitude, 1 / v.frequency, 0,
        v.n_cycles,  v.points_per_pulse};
  return std::nullopt;
}

std::vector<long> recorded_cycles(const Scene& scene)
{
  const long last = scene.load.n_cycles;
  const bool evenly = scene.output.spacing == TimeSpacing::linear;
  std::vector<long> cycles;
  long cycle = 0;
  for (long left = scene.output.n_times; left > 0 && cycle < last; --left) {
    const double now = double(cycle), ratio = double(last) / std::max(now, 1.0);
    const double next = evenly ? now + (double(last) - now) / double(left)
                               : std::max(now, 1.0) * std::pow(ratio, 1 / double(left));
    cycle = left == 1 ? last : std::clamp(std::lround(next), cycle + 1, last);
    cycles.push_back(cycle);
  }
  return cycles;
}

std::vector<double> cycle_times(const Scene& scene, const dem::Loading& loading)
{
  const std::vector<dem::LoadPoint>& points = loading.points;
  const dem::CyclicLoad load = *cyclic_load(scene, 1);
  std::vector<double> times{0};
  const auto follow = [&](double from, double to) {
    for (const double share : {1.0 / 16, 1.0 / 4})
      times.push_back(from + share * (to - from));
  };
  for (const long cycle : recorded_cycles(scene)) {
    const double start = dem::cycle_end(load, cycle - 1), end = dem::cycle_end(load, cycle);
    auto k = std::ranges::lower_bound(points, start, {}, &dem::LoadPoint::time);
    for (; k != points.end() && k->time <= end; ++k) {
      times.push_back(k->time);
      if (k != points.begin() && k->time == (k - 1)->time) // a jump: what was before it, too
        times.push_back(std::nextafter(k->time, 0.0));
    }
    if (load.pulse == dem::CyclicLoad::Pulse::block)
      follow(start, start + load.loading_time);
    if (load.rest_time > 0)
      follow(start + load.loading_time, end);
  }
  return times;
}

std::vector<Column> cycle_columns(const Scene& scene, const RunRecord& record)
{
  std::vector<Column> columns{{"cycle", "1", {}},
                              {"time_s", "s", {}},
                              {"peak_strain_percent", "%", {}},
                              {"permanent_strain_percent", "%", {}},
                              {"resilient_strain_percent", "%", {}},
                              {"broken_bonds", "1", {}}};
  const dem::CyclicLoad load = *cyclic_load(scene, 1);
  const double direction = load.amplitude < 0 ? -1 : 1;
  for (const long cycle : recorded_cycles(scene)) {
    const double end = dem::cycle_end(load, cycle);
    const auto found = strains(record, dem::cycle_end(load, cycle - 1), end, direction);
    if (!found)
      break;
    const double row[] = {double(cycle),
                          end,
                          100 * found->peak,
                          100 * found->permanent,
                          100 * (found->peak - found->permanent),
                          found->n_broken};
    for (std::size_t k = 0; k < columns.size(); ++k)
      columns[k].values.push_back(row[k]);
  }
  return columns;
}

} // namespace apps
