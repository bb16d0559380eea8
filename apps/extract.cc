#include "apps/extract.h"

#include "apps/extract_files.h"
#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/specimen.h"
#include "dem/realisations.h"
#include "fem/symmetry.h"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Scatter scatter(const std::vector<double>& values)
{
  Scatter s{values.size(), 0, 0, infinity};
  for (const double each : values)
    s.mean += each / double(s.n);
  if (s.n < 2)
    return s;
  for (const double each : values)
    s.deviation += (each - s.mean) * (each - s.mean) / double(s.n - 1);
  s.deviation = std::sqrt(s.deviation);
  const double t = quantile(boost::math::students_t(double(s.n - 1)), 0.975);
  s.band = t * s.deviation / std::sqrt(double(s.n));
  return s;
}

fem::EngineeringConstants<double> isotropic_constants(const dem::Mat6& compliance)
{
  return fem::engineering_constants(fem::nearest(compliance, fem::Symmetry{}));
}

std::size_t wanted_condition(const Scene& scene)
{
  return std::size_t(std::ranges::find(all_conditions, scene.element.condition) -
                     all_conditions.begin());
}

SizeResult summed_up(const Scene& scene, const std::vector<const Realisation*>& group)
{
  const std::size_t wanted = wanted_condition(scene);
  SizeResult result{group.front()->n_particles, 0, {}, {}, {}, 0};
  std::vector<double> young, poisson;
  dem::Mat6 mean = dem::Mat6::Zero();
  for (const Realisation* each : group) {
    const dem::Mat6 compliance = dem::compliance(*each->stiffness[wanted]);
    const auto constants = isotropic_constants(compliance);
    young.push_back(constants.young[0]);
    poisson.push_back(constants.poisson(0, 1));
    mean += compliance / double(group.size());
    result.size_ratio += each->size_ratio / double(group.size());
  }
  result.young = scatter(young);
  result.poisson = scatter(poisson);
  result.anisotropy = fem::distance(mean, fem::Symmetry{});
  for (std::size_t k = 0; k < all_conditions.size(); ++k) {
    std::vector<double> values;
    for (const Realisation* each : group)
      if (each->stiffness[k])
        values.push_back(isotropic_constants(dem::compliance(*each->stiffness[k])).young[0]);
    if (!values.empty())
      result.bounds[k] = scatter(values);
  }
  return result;
}

coupling::ExtractedLaw law_of(const Scene& scene, const std::vector<const Realisation*>& group)
{
  const VolumeElementInput& v = scene.element;
  const std::vector<dem::BondLaw> laws = bond_laws(scene, 1);
  if (const auto proportional = dem::proportional_laws(laws)) {
    dem::Mat6 mean = dem::Mat6::Zero();
    for (const Realisation* each : group)
      mean += dem::compliance(*each->stiffness[wanted_condition(scene)]) / double(group.size());
    return {coupling::proportional_law(mean, proportional->creep), true, 0, 0, 0, 0, 0, infinity};
  }
  std::vector<coupling::MeanCompliance> samples;
  for (const Realisation* each : group)
    samples.push_back(*each->samples);
  return coupling::fitted_law(
      coupling::mean_of(samples),
      {v.first_time, v.last_time, int(v.n_times), v.tolerance, int(v.n_terms)});
}

fem::Symmetry symmetry_of(LawSymmetry kind, const fem::ComplianceLaw& law)
{
  switch (kind) {
  case LawSymmetry::orthotropic:
    return fem::best_symmetry(law, fem::SymmetryClass::orthotropic);
  case LawSymmetry::transversely_isotropic:
    return fem::best_symmetry(law, fem::SymmetryClass::transversely_isotropic);
  default:
    return {};
  }
}

fem::TemperatureShift law_shift(const Scene::Temperature& v)
{
  if (v.shift == ShiftKind::wlf)
    return fem::WlfShift{v.wlf_c1, v.wlf_c2, v.reference};
  if (v.shift == ShiftKind::arrhenius)
    return fem::ArrheniusShift{v.activation_energy, v.reference};
  return std::monostate{};
}

/// Whether one element of a size, and the mean of those computed, is good for the accuracy.
std::string verdict(const std::vector<const Realisation*>& group, const SizeResult& size,
                    double accuracy)
{
  std::vector<dem::ElementBounds> bounds;
  for (const Realisation* each : group)
    if (each->stiffness[1] && each->stiffness[2] && each->stiffness[3])
      bounds.push_back(
          {*each->stiffness[1], *each->stiffness[2], *each->stiffness[3], each->size_ratio});
  if (group.size() < 2)
    return "one volume says nothing about scatter";
  if (bounds.size() < group.size())
    return fmt::format(
        "{} spheres: Young's modulus of one volume scatters by {:.2g} %, the mean of "
        "{} is known to {:.2g} %; no verdict without all bounds",
        size.n_particles, 100 * size.young.deviation / size.young.mean, size.young.n,
        100 * size.young.band / size.young.mean);
  const dem::SizeVerdict v = dem::judge_size(bounds, accuracy);
  std::string text =
      fmt::format("{} spheres: {} for {:g} %{}. Stiffness of one volume scatters by {:.2g} %, the "
                  "mean of {} is "
                  "known to {:.2g} %; half the distance of the bounds is {:.2g} %",
                  size.n_particles, v.is_large_enough ? "large enough" : "NOT large enough",
                  100 * accuracy, v.is_large_enough ? "" : ": " + v.reason, 100 * v.scatter,
                  group.size(), 100 * v.band, 100 * v.gap);
  if (v.scatter > accuracy)
    text +=
        fmt::format("; if scatter falls with the square root of the volume, {:.2g} spheres "
                    "scatter by {:g} %",
                    double(size.n_particles) * std::pow(v.scatter / accuracy, 2), 100 * accuracy);
  return text;
}

/// What sizes say about each other.
void compare_sizes(Extraction& e)
{
  for (std::size_t k = 0; k + 1 < e.sizes.size(); ++k) {
    const Scatter &a = e.sizes[k].young, &b = e.sizes.back().young;
    const double change = a.mean / b.mean - 1, noise = std::hypot(a.band, b.band) / b.mean;
    e.notes.push_back(
        fmt::format("Young's modulus of {} spheres: {:+.2g} % beside that of {} ({})",
                    e.sizes[k].n_particles, 100 * change, e.sizes.back().n_particles,
                    std::abs(change) > noise
                        ? "more than the confidence bands explain: the size matters"
                        : fmt::format("within the confidence bands, {:.2g} %", 100 * noise)));
  }
}

/// How far the law, which was found over time, is from the mean of what each element answers to
/// steady oscillation.
void compare_routes(const Scene& scene, const std::vector<const Realisation*>& group, Extraction& e)
{
  const std::vector<double> omega = angular_frequencies(scene);
  std::vector<fem::ComplexMat6> mean(omega.size(), fem::ComplexMat6::Zero());
  for (const Realisation* each : group)
    for (std::size_t k = 0; k < omega.size(); ++k)
      mean[k] += each->complex_compliance[k] / double(group.size());
  if (!omega.empty())
    e.notes.push_back(fmt::format(
        "the law is within {:.2g} % of the complex compliances that were solved for at {} "
        "frequencies",
        100 * coupling::frequency_difference(e.law.law, omega, mean), omega.size()));
}

} // namespace

Extraction sum_up(const LoadedScene& loaded, std::vector<Realisation> realisations)
{
  const Scene& scene = *loaded.scene;
  Extraction e{std::move(realisations), {}, {}, 0, {}, {}};
  std::map<std::size_t, std::vector<const Realisation*>> groups;
  for (const Realisation& each : e.realisations)
    groups[each.n_particles].push_back(&each);
  for (const auto& [n, group] : groups)
    e.sizes.push_back(summed_up(scene, group));
  e.law = law_of(scene, groups.rbegin()->second);
  fem::ComplianceLaw written = e.law.law;
  if (scene.element.symmetry != LawSymmetry::full) {
    const fem::Symmetry symmetry = symmetry_of(scene.element.symmetry, e.law.law);
    e.symmetry_distance = fem::distance(e.law.law, symmetry);
    written = fem::nearest(e.law.law, symmetry);
  }
  const Scene::Temperature& temperature = scene.temperature;
  e.record.law = written;
  e.record.reference_temperature = temperature.reference;
  e.record.shift = law_shift(temperature);
  e.record.first_time = e.law.is_exact ? scene.element.first_time : e.law.first_time;
  e.record.last_time = e.law.is_exact ? scene.element.last_time : e.law.last_time;
  e.record.relative_error = std::hypot(e.law.relative_rms, e.symmetry_distance);
  e.record.provenance = {
      fmt::format("mastic {} ({}), scene {}", MASTIC_VERSION, MASTIC_REVISION, loaded.name),
      fmt::format("mean compliance of {} volume elements of {} spheres, {} boundary condition, "
                  "seeds from {}",
                  groups.rbegin()->second.size(), groups.rbegin()->first,
                  name_of(scene.element.condition), scene.specimen.seed),
      e.law.is_exact ? "bond laws are proportional: exact for all times"
                     : fmt::format("fitted to creep tests from {:g} s to {:g} s", e.law.first_time,
                                   e.law.last_time)};
  if (const std::string keys = estimated_bond_keys(loaded); !keys.empty())
    e.record.provenance.push_back("estimated, not measured: " + keys);
  if (!e.law.is_exact)
    compare_routes(scene, groups.rbegin()->second, e);
  for (const SizeResult& size : e.sizes)
    e.notes.push_back(verdict(groups[size.n_particles], size, scene.element.accuracy));
  compare_sizes(e);
  return e;
}

int extract_verb(const std::string& file, const std::string& output, const RunOptions& options)
{
  LoadedScene scene = load_scene(file, options.overrides);
  print_diagnostics(scene.diagnostics);
  if (scene.has_errors())
    return exit_input;
  const std::filesystem::path folder =
      output.empty() ? result_folder(scene) : std::filesystem::path(output);
  require_writable(folder);
  PackingStore store{folder / "packings", {}};
  make_folder(store.folder);
  fmt::print("{}{}\n", scene.name, scene.scene->title.empty() ? "" : ": " + scene.scene->title);
  std::fflush(stdout);
  const std::vector<RealisationTask> tasks = realisation_tasks(*scene.scene);
  std::vector<Realisation> done;
  for (std::optional<Realisation>& each : realise_all(scene, tasks, store, options))
    if (each)
      done.push_back(std::move(*each));
  if (done.size() < tasks.size()) {
    fmt::print(
        "{}: interrupted; {} of {} volume elements are done. To go on, give the same command "
        "again: their packings are kept in {}\n",
        scene.name, done.size(), tasks.size(), store.folder.string());
    return exit_interrupted;
  }
  const Extraction extraction = sum_up(scene, std::move(done));
  fmt::print("{}", extraction_report(scene, extraction));
  write_extraction(scene, extraction, folder);
  return exit_ok;
}

} // namespace apps
