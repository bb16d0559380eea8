// Volume elements: packing, six solutions, creep in time, frequencies, realisations.
#include "dem/element_creep.h"
#include "dem/frequency_response.h"
#include "dem/packing.h"
#include "dem/realisations.h"

#include <benchmark/benchmark.h>

#include <cmath>

using namespace dem;

namespace {

PeriodicPackingRequest request(std::size_t n_particles)
{
  return cube_request(named_grading("sma10"), n_particles, 0.7);
}

/// Two laws, chosen by the classes of the particles.
VolumeElement element_of(std::size_t n_particles, std::uint64_t seed)
{
  const PeriodicPackingRequest wanted = request(n_particles);
  Particles particles = grow_periodic_packing(wanted, seed);
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.material_class[i] = int(i % 2);
  const BondLaw soft{burgers(3.2e6, 8.2e8, 5e5, 8.4e6), 11, 1};
  const BondLaw stiff{burgers(3e7, 8e11, 9e7, 4e9), 11, 1};
  return make_volume_element(wanted.container, particles,
                             periodic_nearest_contacts(wanted.container, particles, 5.5),
                             {soft, stiff}, {{0, 0, 0}, {1, 1, 0}, {0, 1, 1}});
}

/// Made once for all benchmarks.
const VolumeElement& element()
{
  static const VolumeElement element = element_of(1000, 1);
  return element;
}

void periodic_packing(benchmark::State& state)
{
  for (auto _ : state)
    benchmark::DoNotOptimize(grow_periodic_packing(request(1000), 1).size());
}
BENCHMARK(periodic_packing)->Unit(benchmark::kMillisecond)->UseRealTime();

void six_solutions(benchmark::State& state)
{
  const auto condition = BoundaryCondition(state.range(0));
  const VolumeElement& packed = element();
  for (auto _ : state)
    benchmark::DoNotOptimize(homogenize(packed, condition).stiffness.sum());
  state.counters["bonds"] = double(packed.bonds.size());
}
BENCHMARK(six_solutions)
    ->DenseRange(0, 3)
    ->ArgName("condition")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

std::vector<double> decades(double first, double last, int n)
{
  std::vector<double> result;
  for (int k = 0; k < n; ++k)
    result.push_back(first * std::pow(last / first, k / double(n - 1)));
  return result;
}

void fifty_frequencies(benchmark::State& state)
{
  const std::vector<double> omega = decades(1e-5, 1e4, 50);
  FrequencyResponse response;
  for (auto _ : state)
    response = frequency_response(element(), omega);
  state.counters["basis"] = response.basis_size;
}
BENCHMARK(fifty_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();

void creep_over_six_decades(benchmark::State& state)
{
  const std::vector<double> times = decades(1e-2, 1e4, 19);
  CreepHistory history;
  for (auto _ : state)
    history = creep_compliance(make_element_model(element()), times, 1e-3);
  state.counters["factorisations"] = history.n_factorisations;
  state.counters["steps"] = history.n_steps;
}
BENCHMARK(creep_over_six_decades)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Packings, bonds, and stiffness under three boundary conditions, on some threads.
void fifty_realisations(benchmark::State& state)
{
  const auto make = [](std::uint64_t seed) { return element_of(1000, seed); };
  SizeVerdict verdict;
  for (auto _ : state)
    verdict = judge_size(realisations(make, 1, 50, int(state.range(0))), 0.05);
  state.counters["gap_%"] = 100 * verdict.gap;
  state.counters["scatter_%"] = 100 * verdict.scatter;
  state.counters["band_%"] = 100 * verdict.band;
  state.counters["size_ratio"] = verdict.size_ratio;
}
BENCHMARK(fifty_realisations)
    ->Arg(2)
    ->ArgName("threads")
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->Iterations(1);

} // namespace

BENCHMARK_MAIN();
