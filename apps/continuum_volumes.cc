#include "apps/continuum_volumes.h"

#include "apps/element_realisations.h"
#include "apps/files.h"
#include "apps/specimen.h"
#include "coupling/extraction.h"
#include "dem/random.h"
#include "dem/realisations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace apps {

namespace {

constexpr double size_agreement = 1.25;
/// Out-of-balance force in volumes, over that of the body: what they leave must not stir it.
constexpr double volume_tightness = 1e-2;

/// A number that stands for a point whatever the ranks: of the name of its cell and its place.
std::uint64_t point_key(const std::string& cell, std::size_t point)
{
  std::uint64_t sum = 14695981039346656037ULL; // FNV-1a
  for (const char c : cell + fmt::format("/{}", point))
    sum = (sum ^ std::uint64_t(static_cast<unsigned char>(c))) * 1099511628211ULL;
  const auto words = dem::philox({std::uint32_t(sum), std::uint32_t(sum >> 32), 0, 0}, {0, 0});
  return std::uint64_t(words[0]) << 32 | words[1];
}

/// How far the seeds of each point's volume are from those of the scene.
template <int dim>
std::vector<std::uint64_t> seed_offsets(const fem::Elements<dim>& elements, long n_families)
{
  std::vector<std::uint64_t> offsets;
  for (const auto& cell : elements.dofs().active_cell_iterators())
    if (cell->is_locally_owned())
      for (std::size_t q = 0; q < elements.points_per_cell(); ++q) {
        const std::uint64_t key = point_key(cell->id().to_string(), q);
        offsets.push_back(n_families > 0 ? key % std::uint64_t(n_families) : key >> 33);
      }
  return offsets;
}

dem::Strengths strengths_of(const Scene& scene, const dem::VolumeElement& element,
                            std::uint64_t offset)
{
  if (breaks(scene.continuum))
    return drawn_strengths(scene, element.bonds.id, std::uint64_t(scene.strength.seed) + offset);
  const std::vector<double> endless(element.bonds.size(), std::numeric_limits<double>::infinity());
  return {endless, endless, 0};
}

coupling::QuasistaticPoints::Volume followed_volume(const Scene& scene, dem::VolumeElement element,
                                                    dem::Strengths strengths)
{
  dem::QuasistaticSettings settings = scene.quasistatic;
  settings.after_breakage = scene.after_breakage;
  settings.friction = scene.friction;
  settings.residual_tolerance *= volume_tightness;
  auto volume = std::make_shared<const dem::QuasistaticVolume>(
      dem::make_quasistatic_volume(std::move(element), std::move(strengths), settings));
  if (!volume->creep && scene.continuum.body.material != MaterialChoice::all_live)
    throw std::invalid_argument("Body/Material: bonds of several laws have no common law to start "
                                "from; use all live");
  return volume;
}

OneVolume make_one(const LoadedScene& loaded, PackingStore& store, std::uint64_t offset)
{
  const Scene& scene = *loaded.scene;
  const bool grown = scene.element.source == ElementSource::grow;
  dem::VolumeElement element =
      make_element(loaded,
                   {grown ? std::size_t(scene.continuum.volumes.n_particles) : 0,
                    std::uint64_t(scene.specimen.seed) + offset, false},
                   store);
  dem::Strengths strengths = strengths_of(scene, element, offset);
  OneVolume result;
  if (is_followed(scene))
    result.followed = followed_volume(scene, element, strengths);
  if (!result.followed || result.followed->creep) {
    const bool bare = !breaks(scene.continuum) || is_followed(scene); // they end at a breakage
    result.family = coupling::make_family(std::move(element), std::move(strengths),
                                          bare ? dem::AfterBreakage::leave : scene.after_breakage);
  }
  return result;
}

double edge_of(const BodyVolumes& volumes, std::size_t point)
{
  const auto k = std::size_t(volumes.family_of_point[point]);
  return std::cbrt(volumes.families.empty() ? volumes.followed[k]->element.cell.volume()
                                            : volumes.families[k].element->volume());
}

/// Edges of the points' elements: of the cell, over the order of its functions [m].
template <int dim>
std::vector<double> point_edges(const fem::Elements<dim>& elements)
{
  std::vector<double> edges;
  for (const auto& cell : elements.dofs().active_cell_iterators())
    if (cell->is_locally_owned())
      edges.insert(edges.end(), elements.points_per_cell(),
                   std::pow(cell->measure(), 1. / dim) / elements.discretisation().order);
  return edges;
}

} // namespace

template <int dim>
BodyVolumes make_volumes(const LoadedScene& loaded, const Ranks& ranks,
                         const fem::Elements<dim>& elements, const std::filesystem::path& packings,
                         int n_threads, bool trial, KnownVolumes& known)
{
  const Scene& scene = *loaded.scene;
  const ContinuumInput::Volumes& v = scene.continuum.volumes;
  const std::vector<std::uint64_t> offsets =
      trial ? std::vector<std::uint64_t>(elements.n_points(), 0)
            : seed_offsets(elements, v.n_families);
  std::map<std::uint64_t, int> number;
  for (const std::uint64_t each : offsets)
    number.emplace(each, 0);
  std::vector<std::uint64_t> needed, missing;
  for (auto& [offset, k] : number) {
    k = int(needed.size());
    needed.push_back(offset);
    if (!known.contains(offset))
      missing.push_back(offset);
  }
  BodyVolumes result;
  for (const std::uint64_t each : offsets)
    result.family_of_point.push_back(number.at(each));
  PackingStore store{ranks.first() ? packings : std::filesystem::path(), {}}; // one writer
  if (!store.folder.empty())
    make_folder(store.folder);
  std::vector<OneVolume> made(missing.size());
  dem::for_each_realisation(int(missing.size()), n_threads, [&](int k) {
    made[std::size_t(k)] = make_one(loaded, store, missing[std::size_t(k)]);
  });
  for (std::size_t k = 0; k < missing.size(); ++k)
    known.emplace(missing[k], std::move(made[k]));
  for (const std::uint64_t each : needed) {
    const OneVolume& one = known.at(each);
    if (one.family)
      result.families.push_back(*one.family);
    if (one.followed)
      result.followed.push_back(one.followed);
  }
  const std::vector<double> edges = point_edges(elements);
  for (std::size_t q = 0; q < edges.size(); ++q) {
    const double edge = edge_of(result, q);
    result.size_ratio.push_back(v.softening == SofteningChoice::scaled ? edge / edges[q] : 1);
    const double ratio = edge / edges[q];
    if (v.softening == SofteningChoice::as_it_is && breaks(scene.continuum) &&
        (ratio > size_agreement || ratio < 1 / size_agreement))
      throw std::invalid_argument(fmt::format(
          "Volumes/Softening = as it is: a volume is {:.3g} mm wide and an element of the mesh "
          "{:.3g} mm; what breaks would dissipate by the mesh. Use scaled, or other sizes",
          1e3 * edge, 1e3 * edges[q]));
  }
  return result;
}

namespace {

/// The law of a volume whose bonds follow several laws, at the instant of a load.
fem::ComplianceLaw elastic_law(const dem::QuasistaticVolume& volume)
{
  const auto elastic = dem::VolumeFollower(volume).step(dem::at_rest(volume), fem::Vec6::Zero(), 0);
  if (!elastic)
    throw std::invalid_argument("a volume has no equilibrium at rest");
  return coupling::proportional_law(dem::compliance(elastic->tangent),
                                    dem::make_creep_law(1, std::nullopt, {}));
}

} // namespace

bool is_followed(const Scene& scene)
{
  return breaks(scene.continuum) && scene.continuum.volumes.solver == VolumeSolver::quasistatic;
}

BodyLaws laws_of(const Scene& scene, const BodyVolumes& volumes)
{
  BodyLaws laws;
  const bool exact = !volumes.families.empty();
  const std::size_t n = exact ? volumes.families.size() : volumes.followed.size();
  for (std::size_t k = 0; k < n; ++k) {
    fem::LawRecord record;
    record.law = exact
                     ? coupling::proportional_law(dem::compliance(volumes.families[k].stiffness()),
                                                  volumes.families[k].element->creep())
                     : elastic_law(*volumes.followed[k]);
    record.reference_temperature = scene.temperature.reference;
    record.last_time = 1e30; // exact for all times
    record.provenance.push_back(exact ? "exact, of an intact volume of the run"
                                      : "elastic part, of an intact volume of the run");
    laws.laws.push_back(record.law);
    laws.records.push_back(std::move(record));
    laws.region.emplace_back();
  }
  return laws;
}

std::unique_ptr<coupling::BreakingPoints> breaking_points(const Scene& scene, BodyVolumes volumes,
                                                          int n_threads, double start,
                                                          double first_pace)
{
  coupling::VolumeSettings settings{coupling::VolumeUse::adaptive, scene.strength.rate_law,
                                    scene.continuum.volumes.breakage_tolerance, n_threads,
                                    first_pace};
  const bool all_live = scene.continuum.body.material == MaterialChoice::all_live;
  const std::vector<int> numbers = volumes.family_of_point;
  std::optional<coupling::VolumePoints> law;
  if (volumes.followed.empty() || !all_live) {
    if (all_live)
      settings.use = coupling::VolumeUse::all_live;
    law.emplace(std::move(volumes.families), numbers, std::move(volumes.size_ratio), settings,
                start);
  }
  if (volumes.followed.empty())
    return std::make_unique<coupling::VolumePoints>(std::move(*law));
  return std::make_unique<coupling::QuasistaticPoints>(std::move(volumes.followed), numbers,
                                                       settings, start, std::move(law));
}

std::string size_text(const Scene& scene, const BodyVolumes& volumes)
{
  if (volumes.family_of_point.empty())
    return "";
  const auto k = std::size_t(volumes.family_of_point[0]);
  const dem::VolumeElement& first = volumes.families.empty()
                                        ? volumes.followed[k]->element
                                        : volumes.families[k].element->element();
  const auto [least, most] = std::ranges::minmax(volumes.size_ratio);
  const std::string ratios = most < 1.01 * least ? fmt::format("{:.2g}", most)
                                                 : fmt::format("{:.2g} to {:.2g}", least, most);
  const bool scaled = scene.continuum.volumes.softening == SofteningChoice::scaled;
  return fmt::format("{} spheres and {} bonds, {:.3g} mm wide, {} times the size of their "
                     "elements{}",
                     first.particles.size(), first.bonds.size(), 1e3 * edge_of(volumes, 0), ratios,
                     scaled ? "" : " (softening as it is)");
}

VolumeReading volume_reading(const coupling::BreakingPoints& points, const Ranks& ranks,
                             double time)
{
  double use = points.largest_strength_use();
  double sums[] = {double(points.n_broken()), double(points.n_bonds()), double(points.n_live()),
                   double(points.size()), double(points.n_failed())};
  MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, ranks.all());
  MPI_Allreduce(MPI_IN_PLACE, &use, 1, MPI_DOUBLE, MPI_MAX, ranks.all());
  return {time, sums[0], sums[1], sums[2], sums[3], use, sums[4]};
}

std::vector<Column> volume_columns(const std::vector<VolumeReading>& readings)
{
  std::vector<Column> columns{
      {"time_s", "s", {}},       {"broken_bonds", "1", {}},       {"broken_share_percent", "%", {}},
      {"live_points", "1", {}},  {"live_share_percent", "%", {}}, {"strength_use", "1", {}},
      {"failed_points", "1", {}}};
  for (const VolumeReading& r : readings) {
    const double row[] = {r.time,
                          r.n_broken,
                          100 * r.n_broken / std::max(1., r.n_bonds),
                          r.n_live,
                          100 * r.n_live / r.n_points,
                          r.strength_use,
                          r.n_failed};
    for (std::size_t c = 0; c < columns.size(); ++c)
      columns[c].values.push_back(row[c]);
  }
  return columns;
}

std::vector<fem::CellField> volume_fields(const coupling::BreakingPoints& points,
                                          std::size_t points_per_cell)
{
  std::vector<fem::CellField> fields{{"live_share", {}},
                                     {"broken_share", {}},
                                     {"strength_use", {}},
                                     {"stiffness_loss", {}},
                                     {"first_breakage_s", {}}};
  for (std::size_t first = 0; first < points.size(); first += points_per_cell) {
    double live = 0, broken = 0, use = 0, loss = 0, since = std::numeric_limits<double>::infinity();
    for (std::size_t q = first; q < first + points_per_cell; ++q) {
      use = std::max(use, points.strength_use(q));
      const coupling::PointDamage damage = points.damage(q);
      live += damage.is_live ? 1 : 0;
      broken += damage.broken_share;
      loss += damage.stiffness_loss;
      if (damage.broken_share > 0)
        since = std::min(since, damage.since);
    }
    const double n = double(points_per_cell);
    const double row[] = {live / n, broken / n, use, loss / n, std::isfinite(since) ? since : -1};
    for (std::size_t k = 0; k < fields.size(); ++k)
      fields[k].values.push_back(row[k]);
  }
  return fields;
}

template BodyVolumes make_volumes(const LoadedScene&, const Ranks&, const fem::Elements<2>&,
                                  const std::filesystem::path&, int, bool, KnownVolumes&);
template BodyVolumes make_volumes(const LoadedScene&, const Ranks&, const fem::Elements<3>&,
                                  const std::filesystem::path&, int, bool, KnownVolumes&);

} // namespace apps
