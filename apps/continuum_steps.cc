#include "apps/continuum_steps.h"

#include "apps/files.h"
#include "fem/agreement.h"
#include "fem/field_files.h"
#include "fem/law_points.h"
#include "fem/refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace apps {

namespace {

bool drives_displacement(const Scene& scene, const dem::Loading& loading)
{
  if (has_platens(scene))
    return loading.control == dem::Loading::Control::displacement;
  for (const auto& [name, boundary] : scene.continuum.boundaries)
    for (const auto& each : boundary->displacement)
      if (each && *each != 0)
        return true;
  return false;
}

/// The loads at a value of the load history.
fem::LoadState load_state(const Scene& scene, const dem::Loading& loading, double value)
{
  if (!has_platens(scene))
    return {!drives_displacement(scene, loading), value, value};
  return {loading.control == dem::Loading::Control::force, value, 1};
}

} // namespace

void say(const Ranks& ranks, const std::string& line)
{
  if (ranks.first()) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  }
}

fem::TimeScheme scheme_of(const Scene& scene, const dem::Loading& loading)
{
  if (breaks(scene.continuum))
    return fem::TimeScheme::stress_linear;
  if (scene.continuum.scheme != TimeSchemeChoice::automatic)
    return scene.continuum.scheme == TimeSchemeChoice::stress_linear
               ? fem::TimeScheme::stress_linear
               : fem::TimeScheme::strain_linear;
  return drives_displacement(scene, loading) ? fem::TimeScheme::strain_linear
                                             : fem::TimeScheme::stress_linear;
}

fem::History history_of(const Scene& scene, const dem::Loading& loading, const BodyLaws& laws)
{
  return {[&scene, loading](double t) {
            return load_state(scene, loading, dem::load_value(loading, t));
          },
          [&scene, loading](double t) {
            return load_state(scene, loading, dem::load_value(loading, std::nextafter(t, 0.)));
          },
          reduced_time(scene, laws)};
}

std::vector<fem::Vec3> probe_places(const ContinuumInput::Probes& v)
{
  std::vector<fem::Vec3> places;
  for (std::size_t k = 0; k + 2 < v.points.size(); k += 3)
    places.emplace_back(v.points[k], v.points[k + 1], v.points[k + 2]);
  if (v.line_from.empty())
    return places;
  const fem::Vec3 from(v.line_from.data()), to(v.line_to.data());
  for (long k = 0; k < v.n_line_points; ++k)
    places.push_back(from + double(k) / double(v.n_line_points - 1) * (to - from));
  return places;
}

namespace {

/// The law files of a scene and the number of each point's law.
template <int dim>
void take_law_files(ContinuumInProgress<dim>& run)
{
  run.laws = read_laws(run.scene);
  const std::map<dealii::types::material_id, int> numbers = law_of_region(run.mesh, run.laws);
  bool without = false;
  for (const auto region : run.specimen->elements().regions()) {
    const auto found = numbers.find(region);
    without = without || (found == numbers.end() && !run.laws.region.front().empty());
    run.law_of_point.push_back(found == numbers.end() ? 0 : found->second);
  }
  if (run.ranks.any(without))
    throw std::invalid_argument("Body/Law: some cells belong to no 'Region NAME', so that a Law "
                                "for them is needed");
}

/// The points of the body in the virgin state.
template <int dim>
void make_points(ContinuumInProgress<dim>& run)
{
  const Scene& scene = *run.scene.scene;
  run.law_of_point.clear();
  if (!has_volumes(scene.continuum))
    take_law_files(run);
  else {
    BodyVolumes volumes;
    fem::together(run.ranks.all(), [&] {
      volumes = make_volumes(run.scene, run.ranks, run.specimen->elements(), run.packings,
                             run.n_threads, run.trial, run.known_volumes);
    });
    run.laws = laws_of(scene, volumes);
    run.law_of_point = volumes.family_of_point;
    if (breaks(scene.continuum)) {
      run.volume_sizes = size_text(scene, volumes);
      constexpr double moment = 1e-6; // [s]
      const auto reduced = reduced_time(scene, run.laws);
      const double begin = run.loading.points.front().time;
      const double pace = (reduced(begin + moment) - reduced(begin)) / moment;
      auto points = breaking_points(scene, std::move(volumes), run.n_threads, begin, pace);
      run.volumes = points.get();
      run.points = std::move(points);
      return;
    }
  }
  run.points = std::make_unique<fem::LawPoints>(run.laws.laws, run.law_of_point, run.scheme);
}

} // namespace

template <int dim>
void make_body(ContinuumInProgress<dim>& run)
{
  const Scene& scene = *run.scene.scene;
  const ContinuumInput& v = scene.continuum;
  run.probes.reset();
  const double tolerance = is_followed(scene) // what volumes leave out of balance is less
                               ? std::max(v.solver_tolerance, scene.quasistatic.residual_tolerance)
                               : v.solver_tolerance;
  run.specimen.emplace(run.mesh, fem::Discretisation{int(v.order), v.dilatation}, body_loads(scene),
                       tolerance);
  make_points(run);
  if (!run.places.empty())
    run.probes.emplace(*run.specimen, run.places);
}

template <int dim>
void refine_at_start(ContinuumInProgress<dim>& run)
{
  const Scene& scene = *run.scene.scene;
  double largest = 0;
  for (const dem::LoadPoint& point : run.loading.points)
    if (std::abs(point.value) > std::abs(largest))
      largest = point.value;
  fem::History history = run.history;
  history.load = [&](double) { return load_state(scene, run.loading, largest); };
  for (long k = 0; k < scene.continuum.n_adaptive_refinements; ++k) {
    fem::MarchState elastic;
    fem::apply_jump(*run.specimen, *run.points, elastic, history);
    fem::refine(run.mesh, *run.specimen, *run.points, scene.continuum.refined_share);
    make_body(run);
  }
}

template <int dim>
void refine_now(ContinuumInProgress<dim>& run)
{
  const double drive = run.specimen->drive_displacement(), step = run.points->last_step();
  const auto states =
      fem::refine(run.mesh, *run.specimen, *run.points, run.scene.scene->continuum.refined_share);
  make_body(run);
  fem::restore_cell_states(*run.specimen, *run.points, states, drive);
  run.points->set_last_step(step);
  say(run.ranks, fmt::format("  t = {:.6g} s: refined to {} cells", run.march.time,
                             run.mesh.cells->n_global_active_cells()));
}

template <int dim>
double motion(const ContinuumInProgress<dim>& run)
{
  return has_platens(*run.scene.scene) ? run.specimen->drive_displacement()
                                       : run.specimen->mean_displacement();
}

template <int dim>
fem::Vec3 most_strained_place(const ContinuumInProgress<dim>& run)
{
  const fem::Elements<dim>& elements = run.specimen->elements();
  double most = -1;
  fem::Vec3 place = fem::Vec3::Zero();
  std::size_t q = 0;
  for (const auto& cell : elements.dofs().active_cell_iterators())
    if (cell->is_locally_owned())
      for (std::size_t k = 0; k < elements.points_per_cell(); ++k, ++q)
        if (const double strain = run.volumes && run.volumes->is_lost(q)
                                      ? std::numeric_limits<double>::infinity()
                                      : run.points->strain()[q].norm();
            strain > most) {
          most = strain;
          for (int c = 0; c < dim; ++c)
            place[c] = cell->center()[unsigned(c)];
        }
  struct {
    double value;
    int rank;
  } own{most, int(dealii::Utilities::MPI::this_mpi_process(run.ranks.all()))}, all;
  MPI_Allreduce(&own, &all, 1, MPI_DOUBLE_INT, MPI_MAXLOC, run.ranks.all());
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, all.rank, run.ranks.all());
  return place;
}

template <int dim>
void record_history(ContinuumInProgress<dim>& run)
{
  const bool platens = has_platens(*run.scene.scene);
  const double now = motion(run), span = run.march.time - run.last_time;
  dem::Response row{};
  row.time = run.march.time;
  row.force = platens ? run.specimen->drive_force() : dem::load_value(run.loading, run.march.time);
  row.strain = now / run.face.length;
  row.strain_rate = span > 0 ? (now - run.last_motion) / span / run.face.length : 0;
  row.strength_factor = std::numeric_limits<double>::infinity();
  row.compliance = run.elastic_compliance;
  if (run.volumes) {
    run.record.volumes.push_back(volume_reading(*run.volumes, run.ranks, run.march.time));
    row.n_broken = long(run.record.volumes.back().n_broken);
  }
  run.record.history.push_back(row);
  if (run.probes) {
    run.record.probe_times.push_back(run.march.time);
    run.record.probe_readings.push_back(run.probes->read(*run.specimen, *run.points));
  }
}

template <int dim>
void record_state_before(ContinuumInProgress<dim>& run)
{
  if (run.record.history.empty() || !(run.last_time > run.record.history.back().time))
    return;
  dem::Response row = run.record.history.back();
  const double motion_before = row.strain * run.face.length;
  row.strain_rate =
      (run.last_motion - motion_before) / (run.last_time - row.time) / run.face.length;
  row.time = run.last_time;
  row.strain = run.last_motion / run.face.length;
  row.force = has_platens(*run.scene.scene) ? run.specimen->drive_force()
                                            : dem::load_value(run.loading, run.last_time);
  run.record.history.push_back(row);
}

template <int dim>
void record_fields(ContinuumInProgress<dim>& run, const std::filesystem::path& folder)
{
  if (!run.scene.scene->output.paraview)
    return;
  const std::string name = fmt::format("body_{:04}.vtu", run.record.fields.size());
  fem::together(run.ranks.all(), [&] {
    if (run.ranks.first())
      make_folder(folder / "paraview");
  });
  std::vector<fem::CellField> volumes;
  if (run.volumes)
    volumes = volume_fields(*run.volumes, run.specimen->elements().points_per_cell());
  fem::write_fields(folder / "paraview" / name, *run.specimen, *run.points, volumes);
  run.record.fields.emplace_back(run.march.time, name);
  fem::together(run.ranks.all(), [&] {
    if (run.ranks.first())
      fem::write_series(folder / "paraview" / "body.pvd", run.record.fields);
  });
}

template void make_body(ContinuumInProgress<2>&);
template void make_body(ContinuumInProgress<3>&);
template void refine_at_start(ContinuumInProgress<2>&);
template void refine_at_start(ContinuumInProgress<3>&);
template void refine_now(ContinuumInProgress<2>&);
template void refine_now(ContinuumInProgress<3>&);
template void record_history(ContinuumInProgress<2>&);
template void record_history(ContinuumInProgress<3>&);
template void record_fields(ContinuumInProgress<2>&, const std::filesystem::path&);
template void record_fields(ContinuumInProgress<3>&, const std::filesystem::path&);
template void record_state_before(ContinuumInProgress<2>&);
template void record_state_before(ContinuumInProgress<3>&);
template fem::Vec3 most_strained_place(const ContinuumInProgress<2>&);
template fem::Vec3 most_strained_place(const ContinuumInProgress<3>&);
template double motion(const ContinuumInProgress<2>&);
template double motion(const ContinuumInProgress<3>&);

} // namespace apps
