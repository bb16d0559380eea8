#include "apps/element_realisations.h"

#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/progress.h"
#include "apps/specimen.h"
#include "dem/packing.h"
#include "dem/realisations.h"
#include "dem/storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <numbers>
#include <stdexcept>
#include <thread>

namespace apps {

namespace {

dem::PeriodicPackingRequest periodic_request(const Scene& scene, std::size_t n_particles)
{
  const dem::PackingRequest like = packing_request(scene);
  const dem::PeriodicCell cell =
      scene.element.edges.empty()
          ? dem::cube_request(like.grading, n_particles, like.solid_fraction).container
          : cell_of(scene.element.edges);
  return {cell,
          like.grading,
          n_particles,
          like.solid_fraction,
          like.density,
          like.min_contacts,
          like.contact_gap,
          like.residual_stress_bound,
          like.preparation_stiffness};
}

/// What a kept packing was made from.
std::string recipe(const Scene& scene, const RealisationTask& task)
{
  const std::string specimen = packing_recipe(scene);
  const std::size_t from = specimen.find("solid fraction"), to = specimen.rfind(", seed");
  return fmt::format("periodic, {} particles, seed {}, edges {}; {}", task.n_particles, task.seed,
                     fmt::join(scene.element.edges, " "), specimen.substr(from, to - from));
}

/// Grows the packing, or takes the one that was kept.
dem::Particles grown(const Scene& scene, const RealisationTask& task,
                     const dem::PeriodicPackingRequest& request, PackingStore& store)
{
  const std::filesystem::path file =
      store.folder / fmt::format("{}-spheres-seed-{}.packing.h5", task.n_particles, task.seed);
  const std::string wanted = recipe(scene, task);
  if (!store.folder.empty() && std::filesystem::exists(file)) {
    const std::scoped_lock lock(store.lock);
    try {
      const Packing packing = read_packing(file, wanted);
      return packing.particles;
    } catch (const std::invalid_argument&) { // of another scene, or damaged: made anew
    }
  }
  const dem::Particles particles = dem::grow_periodic_packing(request, task.seed);
  if (!store.folder.empty()) {
    const std::scoped_lock lock(store.lock);
    write_packing(file,
                  {particles,
                   std::nullopt,
                   {},
                   {0, 0},
                   fmt::format("periodic, generated, seed {}", task.seed)},
                  wanted);
  }
  return particles;
}

dem::PeriodicContacts contacts(const Scene::Specimen& v, const dem::PeriodicCell& cell,
                               const dem::Particles& particles)
{
  return v.bond_rule == BondRule::gap
             ? dem::periodic_contacts_within(cell, particles, v.bond_gap)
             : dem::periodic_nearest_contacts(cell, particles, v.mean_contacts);
}

dem::VolumeElement cut_element(const LoadedScene& loaded, std::uint64_t seed)
{
  const Scene& scene = *loaded.scene;
  const std::vector<double>& e = scene.element.edges;
  if (e.size() != 3)
    throw std::invalid_argument(
        "Volume element/Edges: give the three lengths of the box that is cut out");
  Packing packing;
  if (scene.specimen.source == SpecimenSource::generate)
    packing = {dem::grow_packing(packing_request(scene), seed),
               std::nullopt,
               {},
               {0, scene.specimen.height},
               "",
               std::nullopt};
  else
    packing = make_packing(loaded);
  const dem::ContactPairs pairs =
      scene.specimen.bond_rule == BondRule::gap
          ? dem::contacts_within(packing.particles, scene.specimen.bond_gap)
          : dem::nearest_contacts(packing.particles, scene.specimen.mean_contacts);
  const dem::Vec3 size(e[0], e[1], e[2]),
      middle(0, 0, 0.5 * (packing.platens.low + packing.platens.high));
  return dem::cut_box(packing.particles, pairs.pairs, middle - size / 2, middle + size / 2,
                      scene.element.cut_layer, bond_laws(scene, 1),
                      pair_laws(scene, packing.particles));
}

} // namespace

std::vector<double> angular_frequencies(const Scene& scene)
{
  std::vector<double> omega;
  for (const double f : scene.output.frequencies)
    omega.push_back(2 * std::numbers::pi * f);
  return omega;
}

std::vector<RealisationTask> realisation_tasks(const Scene& scene)
{
  const bool several_laws = !dem::proportional_laws(bond_laws(scene, 1));
  std::vector<std::size_t> sizes;
  for (const double each : scene.element.sizes)
    sizes.push_back(std::size_t(std::lround(each)));
  if (sizes.empty())
    sizes.push_back(std::size_t(scene.specimen.n_particles));
  std::ranges::sort(sizes);
  std::vector<RealisationTask> tasks;
  const bool grown = scene.element.source == ElementSource::grow;
  const bool many = grown || (scene.element.source == ElementSource::cut &&
                              scene.specimen.source == SpecimenSource::generate);
  for (auto n = sizes.rbegin(); n != sizes.rend(); ++n) // the longest first: threads end together
    for (long k = 0; k < (many ? scene.element.n_realisations : 1); ++k)
      tasks.push_back({grown ? *n : 0, std::uint64_t(scene.specimen.seed + k),
                       several_laws && *n == sizes.back()});
  return tasks;
}

std::string name_of(dem::BoundaryCondition condition)
{
  switch (condition) {
  case dem::BoundaryCondition::affine:
    return "affine";
  case dem::BoundaryCondition::kinematic:
    return "kinematic";
  case dem::BoundaryCondition::periodic:
    return "periodic";
  default:
    return "uniform traction";
  }
}

dem::VolumeElement make_element(const LoadedScene& loaded, const RealisationTask& task,
                                PackingStore& store)
{
  const Scene& scene = *loaded.scene;
  if (scene.element.source == ElementSource::cut)
    return cut_element(loaded, task.seed);
  dem::PeriodicCell cell;
  dem::Particles particles;
  if (scene.element.source == ElementSource::file) {
    if (scene.specimen.source != SpecimenSource::file)
      throw std::invalid_argument(
          "Volume element/Source = file needs Specimen/Source = file with its File");
    cell = cell_of(scene.element.edges);
    particles = make_packing(loaded).particles;
  } else {
    const dem::PeriodicPackingRequest request = periodic_request(scene, task.n_particles);
    cell = request.container;
    particles = grown(scene, task, request, store);
  }
  const dem::PeriodicContacts found = contacts(scene.specimen, cell, particles);
  std::vector<dem::PairLaw> pairs = pair_laws(scene, particles);
  return dem::make_volume_element(cell, std::move(particles), found, bond_laws(scene, 1),
                                  std::move(pairs));
}

Realisation realise(const LoadedScene& loaded, const RealisationTask& task, PackingStore& store)
{
  const VolumeElementInput& v = loaded.scene->element;
  const dem::VolumeElement element = make_element(loaded, task, store);
  Realisation result;
  result.n_particles = element.particles.size();
  result.n_bonds = element.bonds.size();
  result.seed = task.seed;
  result.volume = element.cell.volume();
  result.size_ratio = dem::face_distances(element.cell).minCoeff() /
                      (2 * std::ranges::max(element.particles.radius));
  result.solid_fraction = dem::solid_fraction(element);
  for (std::size_t k = 0; k < all_conditions.size(); ++k) {
    const dem::BoundaryCondition each = all_conditions[k];
    const bool possible = element.is_periodic || each != dem::BoundaryCondition::periodic;
    if (each != v.condition && !(v.bounds && possible))
      continue;
    try {
      const dem::Homogenization answer = dem::homogenize(element, each);
      result.stiffness[k] = answer.stiffness;
      result.hill_mandel = std::max(result.hill_mandel, answer.hill_mandel);
      result.n_loose = std::max(result.n_loose, answer.loose.size());
    } catch (const std::exception&) { // a bound that this element does not have
      if (each == v.condition)
        throw;
    }
  }
  if (task.wants_samples && !loaded.scene->output.frequencies.empty())
    result.complex_compliance =
        coupling::complex_compliances(element, angular_frequencies(*loaded.scene));
  if (task.wants_samples)
    result.samples = coupling::sampled_compliance(
        element, {v.first_time, v.last_time, int(v.n_times), v.tolerance, int(v.n_terms)});
  return result;
}

std::vector<std::optional<Realisation>> realise_all(const LoadedScene& loaded,
                                                    const std::vector<RealisationTask>& tasks,
                                                    PackingStore& store, const RunOptions& options)
{
  std::vector<std::optional<Realisation>> results(tasks.size());
  double total = 0;
  for (const RealisationTask& task : tasks)
    total += double(task.n_particles);
  std::atomic<double> finished = 0;
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> ended = false;
  std::exception_ptr failure;
  Progress progress(loaded.name + " (volume elements)", options.quiet, false);
  std::jthread worker([&] {
    try {
      dem::for_each_realisation(int(tasks.size()), options.n_threads, [&](int k) {
        if (interrupted())
          return;
        results[k] = realise(loaded, tasks[k], store);
        finished += double(tasks[k].n_particles);
        ++done;
      });
    } catch (...) {
      failure = std::current_exception();
    }
    ended = true;
  });
  while (!ended) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    progress.update(total > 0 ? finished / total : 0,
                    fmt::format("{} of {} elements", done.load(), tasks.size()));
  }
  worker.join();
  progress.finish();
  if (failure)
    std::rethrow_exception(failure);
  return results;
}

} // namespace apps
