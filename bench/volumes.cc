// Volume elements at the points of a body: one breakage, one macroscopic iteration of a thousand
// live ones, and what it costs that points could break while none does.

#include "coupling/extraction.h"
#include "coupling/volume_points.h"
#include "dem/packing.h"
#include "fem/law_points.h"

#include <benchmark/benchmark.h>

#include <limits>
#include <map>
#include <memory>

namespace {

using coupling::VolumeFamily;
using fem::Vec6;

constexpr std::size_t n_points = 1000;

VolumeFamily make_family(std::size_t n_particles)
{
  const dem::Grading grading = dem::named_grading("sma10");
  const dem::PeriodicPackingRequest request = dem::cube_request(grading, n_particles, 0.7);
  dem::Particles particles = dem::grow_periodic_packing(request, 1);
  const dem::PeriodicContacts contacts =
      dem::periodic_nearest_contacts(request.container, particles, 5.5);
  const dem::BondLaw law{dem::burgers(1e6, 1.6e8, 8e5, 2.4e7), 11, 1};
  dem::VolumeElement element = dem::make_volume_element(request.container, std::move(particles),
                                                        contacts, {law}, {{0, 0, 0}});
  dem::Strengths strengths = dem::draw_strengths(
      {dem::WeibullStrength{3, 60}, dem::NonpositiveRule::error, 1}, element.bonds.id, 1);
  return coupling::make_family(std::move(element), std::move(strengths),
                               dem::AfterBreakage::pressed);
}

/// Made once for each size.
const VolumeFamily& family(std::size_t n_particles)
{
  static std::map<std::size_t, VolumeFamily> made;
  const auto found = made.find(n_particles);
  return found != made.end() ? found->second
                             : made.emplace(n_particles, make_family(n_particles)).first->second;
}

std::vector<Vec6> small_strain()
{
  return std::vector<Vec6>(n_points, 1e-9 * Vec6::Ones());
}

/// The answer of a volume one of whose bonds has just broken.
void one_breakage(benchmark::State& state)
{
  const VolumeFamily& volume = family(std::size_t(state.range(0)));
  std::vector<dem::BondStatus> status = volume.element->intact()->status;
  std::size_t next = 0;
  for (auto _ : state) {
    status[next = (next + 7) % status.size()] = dem::BondStatus::gone;
    benchmark::DoNotOptimize(coupling::live_volume(volume, volume.element->answer(status), 1, 0));
    status = volume.element->intact()->status;
  }
  state.counters["bonds"] = double(status.size());
}
BENCHMARK(one_breakage)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond);

/// One step of a thousand points: stress and tangent, whether something breaks within the step, the
/// states at its end, and whether something is overloaded there.
void step(fem::MaterialPoints& points, const std::vector<Vec6>& increment, double& time)
{
  points.begin_step(time, 1);
  benchmark::DoNotOptimize(points.evaluate(increment, 1));
  benchmark::DoNotOptimize(points.share_without_change());
  points.commit();
  benchmark::DoNotOptimize(points.overload());
  time += 1;
}

void thousand_live_points(benchmark::State& state)
{
  coupling::VolumeSettings settings;
  settings.use = coupling::VolumeUse::all_live;
  coupling::VolumePoints points({family(std::size_t(state.range(0)))},
                                std::vector<int>(n_points, 0), std::vector<double>(n_points, 1.),
                                settings, 0);
  const std::vector<Vec6> increment = small_strain();
  double time = 0;
  for (auto _ : state)
    step(points, increment, time);
  state.counters["numbers_per_state"] = double(points.numbers_per_point());
}
BENCHMARK(thousand_live_points)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond);

void thousand_points_that_could_break(benchmark::State& state)
{
  coupling::VolumePoints points({family(200)}, std::vector<int>(n_points, 0),
                                std::vector<double>(n_points, 1.), {}, 0);
  const std::vector<Vec6> increment = small_strain();
  double time = 0;
  for (auto _ : state)
    step(points, increment, time);
}
BENCHMARK(thousand_points_that_could_break)->Unit(benchmark::kMillisecond);

void thousand_points_of_the_law(benchmark::State& state)
{
  const VolumeFamily& volume = family(200);
  const fem::ComplianceLaw law =
      coupling::proportional_law(dem::compliance(volume.stiffness()), volume.element->creep());
  fem::LawPoints points(std::span(&law, 1), std::vector<int>(n_points, 0),
                        fem::TimeScheme::stress_linear);
  const std::vector<Vec6> increment = small_strain();
  double time = 0;
  for (auto _ : state)
    step(points, increment, time);
}
BENCHMARK(thousand_points_of_the_law)->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
