// Parts of the linear and the event solver, and packings: time and its growth.
#include "dem/network_solver.h"
#include "dem/packing.h"

#include <benchmark/benchmark.h>

#include <cmath>

using namespace dem;

namespace {

/// The specimen of the creep study with as many spheres as asked, of the same sizes.
PackingRequest request(std::size_t n_particles)
{
  const double scale = std::cbrt(double(n_particles) / 6000);
  PackingRequest request;
  request.container = {0.5 * 60.2e-3 * scale, 120.3e-3 * scale};
  request.grading = named_grading("sma10");
  request.n_particles = n_particles;
  request.solid_fraction = 0.7;
  return request;
}

ElasticNetwork network_of(std::size_t n_particles)
{
  const PackingRequest wanted = request(n_particles);
  Assembly assembly;
  assembly.particles = grow_packing(wanted, 1);
  const PlatenHeights platens{0, wanted.container.height};
  assembly.support = platen_supports(assembly.particles, platens, 1e-3);
  assembly.laws = {{burgers(3.2e6, 8.2e8, 5e5, 8.4e6), 11, 1}};
  assembly.pair_laws = {{0, 0, 0}};
  assembly.bonds = make_bonds(assembly.particles, nearest_contacts(assembly.particles, 5.5).pairs,
                              assembly.laws, assembly.pair_laws);
  assembly.area = 1;
  assembly.gauge_length = platens.high - platens.low;
  return make_network(assembly);
}

/// Made once for all benchmarks.
const ElasticNetwork& network()
{
  static const ElasticNetwork network = network_of(6000);
  return network;
}

std::vector<double> intact_values(const SymmetricPattern& pattern)
{
  const Damage intact = undamaged(network());
  return stiffness_values(network(), pattern, intact.status,
                          NetworkSolver(network(), intact).pieces());
}

void describe(benchmark::State& state)
{
  state.counters["unknowns"] = double(network().n_dofs);
  state.counters["bonds"] = double(network().bonds.size());
}

void symbolic_analysis(benchmark::State& state)
{
  const SymmetricPattern pattern = stiffness_pattern(network());
  for (auto _ : state)
    benchmark::DoNotOptimize(SupernodalFactor(pattern).n_nonzeros());
  describe(state);
}
BENCHMARK(symbolic_analysis)->Unit(benchmark::kMillisecond);

void factorisation(benchmark::State& state)
{
  const SymmetricPattern pattern = stiffness_pattern(network());
  const std::vector<double> values = intact_values(pattern);
  SupernodalFactor factor(pattern);
  for (auto _ : state)
    if (!factor.factorise(values))
      state.SkipWithError("the matrix is not positive definite");
  describe(state);
  state.counters["nonzeros"] = double(factor.n_nonzeros());
}
BENCHMARK(factorisation)->Unit(benchmark::kMillisecond)->UseRealTime();

void solve(benchmark::State& state)
{
  const SymmetricPattern pattern = stiffness_pattern(network());
  SupernodalFactor factor(pattern);
  if (!factor.factorise(intact_values(pattern)))
    state.SkipWithError("the matrix is not positive definite");
  for (auto _ : state)
    benchmark::DoNotOptimize(factor.back_solve(factor.half_solve(network().unit_load)).sum());
  describe(state);
}
BENCHMARK(solve)->Unit(benchmark::kMillisecond)->UseRealTime();

/// Analysis, factorisation and the response of the intact specimen: what D(t) needs.
void elastic_response(benchmark::State& state)
{
  for (auto _ : state)
    benchmark::DoNotOptimize(NetworkSolver(network(), undamaged(network())).response()->sum());
  describe(state);
}
BENCHMARK(elastic_response)->Unit(benchmark::kMillisecond)->UseRealTime();

/// One bond leaves at each iteration, the next of a list spread over the specimen; the mean
/// includes the factorisations that the solver makes now and then.
void breakage_update(benchmark::State& state)
{
  constexpr Index stride = 61; // between bonds that break
  Damage damage = undamaged(network());
  NetworkSolver solver(network(), damage);
  Index bond = 0;
  for (auto _ : state) {
    const BondChange change{bond, BondStatus::gone};
    damage = solver.apply(std::move(damage), {&change, 1});
    bond += stride;
  }
  describe(state);
  state.counters["factorisations"] = solver.statistics().n_factorisations - 1;
}
BENCHMARK(breakage_update)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(250);

void packing(benchmark::State& state)
{
  for (auto _ : state)
    benchmark::DoNotOptimize(grow_packing(request(std::size_t(state.range(0))), 1).size());
  state.SetComplexityN(state.range(0));
}
BENCHMARK(packing)
    ->Arg(1500)
    ->Arg(3000)
    ->Arg(6000)
    ->Arg(12000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Complexity();

} // namespace

BENCHMARK_MAIN();
