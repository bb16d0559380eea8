// What this machine allows: rate of multiply-adds, bandwidth against working set, and how far the
// bond kernel is from both.
#include "bench/bonded_cylinder.h"
#include "bench/measurement.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>

using namespace bench;

namespace {

constexpr int repetitions = 7;

/// Median and most of a rate over repetitions.
template <class Measure>
Summary repeated(Measure measure)
{
  std::vector<double> values;
  for (int k = 0; k < repetitions; ++k)
    values.push_back(measure());
  return summary(values);
}

/// Registers of doubles.
struct FourDoubles {
  typedef double Register __attribute__((vector_size(32)));
};
struct EightDoubles {
  typedef double Register __attribute__((vector_size(64)));
};

/// Multiply-adds in as many independent chains as hide their latency [flop/s].
template <class Width>
double multiply_add_rate(int n_threads)
{
  using Vector = typename Width::Register;
  constexpr int lanes = sizeof(Vector) / sizeof(double), chains = 12;
  constexpr long rounds = 4'000'000;
  double sink = 0;
  const Stopwatch watch;
#pragma omp parallel num_threads(n_threads) reduction(+ : sink)
  {
    Vector value[chains];
    Vector factor = Vector{} + 0.999;
    for (int k = 0; k < chains; ++k)
      value[k] = Vector{} + k;
    asm("" : "+x"(factor)); // its value is not known to the compiler
    for (long round = 0; round < rounds; ++round)
#pragma GCC unroll 12
      for (int k = 0; k < chains; ++k)
        value[k] = value[k] * factor + factor;
    for (int k = 0; k < chains; ++k)
      sink += value[k][0];
  }
  const double seconds = watch.seconds();
  return std::isfinite(sink) ? 2.0 * lanes * chains * rounds * n_threads / seconds : 0;
}

/// Numbers per bond that the kernel reads, and those among them that it writes back.
struct BondStream {
  int n_read, n_written;
};

BondStream bond_stream(int n_modes)
{
  return {dem::n_fields(n_modes), 7 + 6 * n_modes};
}

/// Seconds to read blocks of 8 x n_read numbers and write n_written of them back, per pass.
double stream_pass(dem::AlignedDoubles& data, BondStream stream, int n_threads, int n_passes)
{
  const long block = 8L * stream.n_read, n_blocks = long(data.size()) / block;
  double* const first = data.data();
  const Stopwatch watch;
#pragma omp parallel num_threads(n_threads)
  for (int pass = 0; pass < n_passes; ++pass)
#pragma omp for schedule(static)
    for (long b = 0; b < n_blocks; ++b) {
      double* const at = first + b * block;
      double kept[8] = {};
#pragma omp simd
      for (int l = 0; l < 8; ++l)
        for (int f = stream.n_written; f < stream.n_read; ++f)
          kept[l] += at[8 * f + l];
      for (int f = 0; f < stream.n_written; ++f)
#pragma omp simd
        for (int l = 0; l < 8; ++l)
          at[8 * f + l] += kept[l];
    }
  return watch.seconds() / n_passes;
}

/// Seconds per bond to stream what the kernel streams.
Summary stream_time(BondStream stream, std::size_t n_bonds, int n_threads)
{
  dem::AlignedDoubles data(n_bonds * stream.n_read, 0.0);
  const int n_passes = int(std::max<std::size_t>(3, 10'000'000 / n_bonds));
  stream_pass(data, stream, n_threads, 1);
  return repeated([&] { return stream_pass(data, stream, n_threads, n_passes) / double(n_bonds); });
}

/// a = b + 3 c over a working set [byte/s], 24 bytes counted for each element.
Summary triad_rate(double mebibytes, int n_threads)
{
  const long n = long(mebibytes * 1048576 / 24) / 8 * 8;
  dem::AlignedDoubles a(n, 0.0), b(n, 1.0), c(n, 2.0);
  const int n_passes = int(std::max(3.0, 2e9 / (24.0 * double(n))));
  return repeated([&] {
    const Stopwatch watch;
#pragma omp parallel num_threads(n_threads)
    for (int pass = 0; pass < n_passes; ++pass) {
#pragma omp for simd schedule(static) nowait
      for (long i = 0; i < n; ++i)
        a[i] = b[i] + 3.0 * c[i];
      asm volatile("" ::: "memory");
    }
    return 24.0 * double(n) * n_passes / watch.seconds();
  });
}

/// Floating-point operations of the kernel per bond and step, counted from its source: additions,
/// multiplications, three divisions, one square root; a fused multiply-add counts as two.
int kernel_flops(int n_modes)
{
  constexpr int normal_and_length = 13, motion_at_contact = 39, swing = 21, twist = 34,
                orthonormal = 30, increments = 34, force_and_moment = 51, strength = 9,
                added_to_ends = 12;
  return normal_and_length + motion_at_contact + swing + twist + orthonormal + increments +
         4 * 6 * n_modes + force_and_moment + strength + added_to_ends;
}

/// The bond kernel without the rest of the step, on one thread [s per bond and step].
Summary kernel_time(ExplicitRun& run)
{
  dem::DynamicBonds& bonds = run.state.bonds;
  dem::AlignedDoubles partial(bonds.n_partial_forces * dem::force_stride, 0.0);
  std::vector<dem::Index> broken;
  constexpr int n_steps = 200;
  return repeated([&] {
    const Stopwatch watch;
    for (int step = 0; step < n_steps; ++step)
      for (const dem::BondChunk& chunk : bonds.chunks)
        dem::advance_chunk(bonds, chunk, run.state.motions.data(), run.model.factors, 1.0,
                           partial.data(), broken);
    return watch.seconds() / n_steps / double(run.model.assembly.bonds.size());
  });
}

Summary step_time(ExplicitRun& run, int n_threads)
{
  return repeated([&] { return timed_steps(run, 500, n_threads); });
}

/// Rates in 1e9 per second.
std::string in_billions(const Summary& rate)
{
  return fmt::format("{:7.1f} ({:6.1f})", 1e-9 * rate.median, 1e-9 * rate.most);
}

void print_machine_limits(std::array<double, 2>& best_flops)
{
  const OtherPrograms others;
  fmt::print("machine: {}\nmedian (most) of {}\n\n", machine(), repetitions);
  fmt::print("                            1 thread          2 threads\n");
  std::array<std::string, 2> narrow, wide;
  for (const int t : {1, 2}) {
    const Summary of_four = repeated([&] { return multiply_add_rate<FourDoubles>(t); });
    const Summary of_eight = repeated([&] { return multiply_add_rate<EightDoubles>(t); });
    narrow[t - 1] = in_billions(of_four);
    wide[t - 1] = in_billions(of_eight);
    best_flops[t - 1] = std::max(of_four.most, of_eight.most);
  }
  fmt::print("multiply-add, 256 bit   {}   {}  Gflop/s\n", narrow[0], narrow[1]);
  fmt::print("multiply-add, 512 bit   {}   {}  Gflop/s\n", wide[0], wide[1]);
  for (const double size : {0.03, 0.5, 3.0, 16.0, 256.0})
    fmt::print("triad, {:6g} MiB       {}   {}  GB/s\n", size, in_billions(triad_rate(size, 1)),
               in_billions(triad_rate(size, 2)));
  fmt::print("other programs used {:.2f} processors\n", others.processors());
}

void print_kernel(const BondedCylinder& scene, Law law, const std::array<double, 2>& best_flops)
{
  ExplicitRun run = start_run(scene, law);
  const std::size_t n_bonds = scene.pairs.size();
  const int n_modes = run.model.n_modes, flops = kernel_flops(n_modes);
  const BondStream stream = bond_stream(n_modes);
  const OtherPrograms others;
  const int streamed = 8 * (stream.n_read + stream.n_written) + 2 * int(sizeof(dem::Index));
  const int of_ends = 2 * 8 * (dem::motion_stride + 2 * dem::force_stride);
  fmt::print("\n{}: {} flop, {} bytes of bond data (working set {:.1f} MB), {} bytes of its ends\n",
             name_of(law), flops, streamed, 8e-6 * double(n_bonds) * stream.n_read, of_ends);
  fmt::print("  ns per bond and step      1 thread          2 threads\n");
  std::array<double, 2> arithmetic;
  std::array<Summary, 2> streaming, whole;
  for (const int t : {1, 2}) {
    arithmetic[t - 1] = flops / best_flops[t - 1];
    streaming[t - 1] = stream_time(stream, n_bonds, t);
    whole[t - 1] = step_time(run, t);
  }
  const auto row = [](const char* name, double one, double two) {
    fmt::print("  {:24} {:8.2f} {:18.2f}\n", name, 1e9 * one, 1e9 * two);
  };
  row("arithmetic alone", arithmetic[0], arithmetic[1]);
  row("bond data alone", streaming[0].least, streaming[1].least);
  const std::array<double, 2> limit{std::max(arithmetic[0], streaming[0].least),
                                    std::max(arithmetic[1], streaming[1].least)};
  row("limit", limit[0], limit[1]);
  row("whole step, median", whole[0].median, whole[1].median);
  row("whole step, least", whole[0].least, whole[1].least);
  fmt::print("  {:24} {:8.1f} {:18.1f}\n", "whole step over limit", whole[0].median / limit[0],
             whole[1].median / limit[1]);
  fmt::print("  {:24} {:8.2f}\n", "bonds without the rest", 1e9 * kernel_time(run).median);
  fmt::print("  other programs used {:.2f} processors\n", others.processors());
}

} // namespace

int main()
{
  try {
    std::array<double, 2> best_flops{};
    print_machine_limits(best_flops);
    const BondedCylinder scene = read_bonded_cylinder(MASTIC_BENCH_DATA);
    for (const Law law : {Law::elastic, Law::burgers})
      print_kernel(scene, law, best_flops);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
