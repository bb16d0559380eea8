// Cost of the explicit solver per bond and step, and the platen force it ends with.
#include "bench/bonded_cylinder.h"
#include "bench/measurement.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>

using namespace bench;

namespace {

/// One way to run the scene.
struct Case {
  Law law;
  int n_threads;
  double target; ///< seconds per bond and step; 0: none
};

struct Result {
  std::vector<double> cost; ///< seconds per bond and step, of each repetition
  double force;             ///< on the upper platen at the end [N]
};

/// The scene from start to end, all cases in turn so that disturbances strike them alike.
std::vector<Result> measure(const BondedCylinder& scene, const std::vector<Case>& cases, int rounds)
{
  constexpr long warm_up = 100, repetition = 500;
  std::vector<Result> results(cases.size());
  for (int round = 0; round < rounds; ++round) {
    std::vector<ExplicitRun> runs;
    for (const Case& each : cases)
      timed_steps(runs.emplace_back(start_run(scene, each.law)), warm_up, each.n_threads);
    for (long done = warm_up; done < scene.n_steps; done += repetition)
      for (std::size_t c = 0; c < cases.size(); ++c)
        results[c].cost.push_back(
            timed_steps(runs[c], std::min(repetition, scene.n_steps - done), cases[c].n_threads));
    for (std::size_t c = 0; c < cases.size(); ++c)
      results[c].force = runs[c].state.force_on_upper;
  }
  return results;
}

void print(const BondedCylinder& scene, const std::filesystem::path& data,
           const std::vector<Case>& cases, const std::vector<Result>& results, double others)
{
  fmt::print("{} spheres, {} bonds, {} steps of {:g} s\n"
             "machine: {}; other programs used {:.2f} of it\n\n",
             scene.particles.size(), scene.pairs.size(), scene.n_steps, scene.time_step, machine(),
             others);
  fmt::print("                 ns per bond and step              platen force at the end\n"
             "law      threads median  least  most  target       N    reference  difference\n");
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const Summary cost = summary(results[c].cost);
    const double force = -results[c].force; // compression positive
    const double reference = reference_force(data, cases[c].law);
    fmt::print("{:8} {:7} {:6.1f} {:6.1f} {:5.1f} {:>7} {:9.3f} {:10.3f} {:9.3f} %\n",
               name_of(cases[c].law), cases[c].n_threads, 1e9 * cost.median, 1e9 * cost.least,
               1e9 * cost.most,
               cases[c].target > 0 ? fmt::format("{:g}", 1e9 * cases[c].target) : "-", force,
               reference, 100 * (force / reference - 1));
  }
}

/// Runs as many steps as each line of the input says and answers: seconds, platen force. That is
/// how two programs are timed in turn.
void serve(const BondedCylinder& scene, Law law, int n_threads)
{
  ExplicitRun run = start_run(scene, law);
  fmt::print("ready bonds {}\n", scene.pairs.size());
  std::fflush(stdout);
  for (long n_steps = 0; std::cin >> n_steps;) {
    const double work = double(n_steps) * double(scene.pairs.size());
    const double seconds = timed_steps(run, n_steps, n_threads) * work;
    fmt::print("done seconds {:.6f} force {:.6f}\n", seconds, -run.state.force_on_upper);
    std::fflush(stdout);
  }
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Cost of the explicit solver on 6000 bonded spheres."};
  std::string data = MASTIC_BENCH_DATA, law = "burgers";
  int rounds = 3, n_threads = 1;
  bool as_server = false;
  app.add_option("--data", data, "Folder of the scene");
  app.add_option("--rounds", rounds, "Runs of the whole scene")->check(CLI::PositiveNumber);
  app.add_flag("--serve", as_server, "Run the number of steps on each line of the input");
  app.add_option("--law", law, "elastic or burgers, with --serve");
  app.add_option("--threads", n_threads, "with --serve")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    const BondedCylinder scene = read_bonded_cylinder(data);
    if (as_server) {
      serve(scene, law_named(law), n_threads);
      return 0;
    }
    const std::vector<Case> cases{{Law::elastic, 1, 0},
                                  {Law::elastic, 2, 0},
                                  {Law::burgers, 1, 20e-9},
                                  {Law::burgers, 2, 11e-9}};
    const OtherPrograms others;
    const std::vector<Result> results = measure(scene, cases, rounds);
    print(scene, data, cases, results, others.processors());
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
