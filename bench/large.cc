// Elastic solution of one large specimen: time of its parts, memory, residual.
#include "bench/measurement.h"

#include "dem/hdf5_file.h"
#include "dem/network_solver.h"
#include "dem/packing.h"
#include "dem/storage.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <stdexcept>

#include <sys/resource.h>

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

/// The packing of a file, which is made if it is missing.
Particles packing(const PackingRequest& wanted, const std::filesystem::path& path)
{
  if (std::filesystem::exists(path))
    return read_particles(Hdf5File::open(path), "particles");
  const bench::Stopwatch watch;
  const Particles particles = grow_packing(wanted, 1);
  fmt::print(stderr, "packing of {} spheres grown in {:.0f} s\n", particles.size(),
             watch.seconds());
  std::filesystem::create_directories(path.parent_path());
  Hdf5File file = Hdf5File::create(path);
  write_particles(file, "particles", particles);
  // so that a scene can take it as its packing file
  file.set_attribute("", "kind", std::string("packing"));
  file.set_attribute("", "storage_version", storage_version);
  file.set_attribute("", "recipe", std::string("bench/large.cc"));
  file.set_attribute("", "origin", path.string());
  file.set_attribute("particles", "lower_platen_m", 0.0);
  file.set_attribute("particles", "upper_platen_m", wanted.container.height);
  file.set_attribute("particles", "diameter_m", 2 * wanted.container.radius);
  file.publish();
  return particles;
}

ElasticNetwork network_of(const Particles& particles, const PackingRequest& wanted)
{
  Assembly assembly;
  assembly.particles = particles;
  assembly.support = platen_supports(particles, {0, wanted.container.height}, 1e-3);
  assembly.laws = {{burgers(3.2e6, 8.2e8, 5e5, 8.4e6), 11, 1}};
  assembly.pair_laws = {{0, 0, 0}};
  assembly.bonds = make_bonds(particles, nearest_contacts(particles, 5.5).pairs, assembly.laws,
                              assembly.pair_laws);
  assembly.area = wanted.container.area();
  assembly.gauge_length = wanted.container.height;
  return make_network(assembly);
}

double peak_memory()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_maxrss) / 1048576; // [GiB]
}

/// Processor time since it was made: on one thread, the wall time of a machine without other work.
class ProcessorWatch {
public:
  double seconds() const { return double(std::clock() - begin_) / CLOCKS_PER_SEC; }

private:
  std::clock_t begin_ = std::clock();
};

/// A solution and the processor seconds that its parts took.
struct Solution {
  Eigen::VectorXd dofs;
  double set_up = 0, solved = 0; ///< [s]
  int n_iterations = 0;
};

Solution by_iteration(const ElasticNetwork& network, const std::vector<BondStatus>& intact)
{
  const ProcessorWatch setting_up;
  const IterativeSolver solver(network, intact, find_pieces(network, intact));
  const double set_up = setting_up.seconds();
  const ProcessorWatch solving;
  IterativeSolution found = solver.solve(network.unit_load, iteration_tolerance);
  if (found.end != IterationEnd::converged)
    throw std::runtime_error("the iteration did not converge");
  return {std::move(found.x), set_up, solving.seconds(), found.n_iterations};
}

Solution by_factor(const ElasticNetwork& network)
{
  const ProcessorWatch solving;
  const NetworkSolver solver(network, undamaged(network), network.radius.size());
  if (!solver.response())
    throw std::runtime_error(solver.obstacle());
  return {*solver.response(), 0, solving.seconds()};
}

void measure(std::size_t n_particles, const std::filesystem::path& file, bool factor)
{
  const PackingRequest wanted = request(n_particles);
  const Particles particles = packing(wanted, file);
  const bench::OtherPrograms others;
  const bench::Stopwatch wall;
  const ProcessorWatch whole;
  const ElasticNetwork network = network_of(particles, wanted);
  const std::vector<BondStatus> intact(network.bonds.size(), BondStatus::intact);
  const double assembled = whole.seconds();
  const Solution solution = factor ? by_factor(network) : by_iteration(network, intact);
  const NetworkForces forces = network_forces(network, intact, solution.dofs);
  const double total = whole.seconds(), wall_total = wall.seconds();
  fmt::print("solver {}\nspheres {}\nbonds {}\nunknowns {}\nnetwork_s {:.2f}\nset_up_s {:.2f}\n"
             "solution_s {:.2f}\ntotal_s {:.2f}\nwall_s {:.2f}\niterations {}\nresidual {:.1e}\n"
             "compliance_m_per_N {:.15g}\nmemory_GiB {:.2f}\nothers {:.2f}\n",
             factor ? "factor" : "iteration", particles.size(), network.bonds.size(),
             network.n_dofs, assembled, solution.set_up, solution.solved, total, wall_total,
             solution.n_iterations,
             (forces.nodal - network.unit_load).norm() / network.unit_load.norm(),
             solution.dofs[network.platen_dof], peak_memory(), others.processors());
}

} // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Elastic solution of one large specimen."};
  std::size_t n_particles = 60000;
  std::string file;
  bool factor = false;
  app.add_option("spheres", n_particles)->required();
  app.add_option("--packing", file, "file of the packing; made if it is missing")->required();
  app.add_flag("--factor", factor, "factorise the matrix instead of iterating");
  CLI11_PARSE(app, argc, argv);
  try {
    measure(n_particles, file, factor);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
