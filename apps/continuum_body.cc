#include "apps/continuum_body.h"

#include "apps/scene_text.h"
#include "apps/specimen.h"
#include "fem/symmetry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace apps {

namespace {

constexpr double gravity = 9.81; ///< [m/s^2]

/// The shift that the laws name; all must name the same.
fem::TemperatureShift shift_of(const BodyLaws& laws)
{
  const fem::LawRecord& first = laws.records.front();
  for (const fem::LawRecord& each : laws.records)
    for (const double t : {first.reference_temperature - 5, first.reference_temperature + 5}) {
      const auto factor = [&](const fem::LawRecord& record) {
        try {
          return fem::shift_factor(record.shift, t);
        } catch (const std::invalid_argument&) { // outside a free shift
          return -1.;
        }
      };
      if (each.shift.index() != first.shift.index() ||
          each.reference_temperature != first.reference_temperature ||
          std::abs(factor(each) - factor(first)) > 1e-9 * std::abs(factor(first)))
        throw std::invalid_argument("the laws of the regions have different temperature shifts or "
                                    "reference temperatures");
    }
  return first.shift;
}

bool has_shift(const fem::TemperatureShift& shift)
{
  return !std::holds_alternative<std::monostate>(shift);
}

/// The shift of a law for a history of temperatures.
dem::TemperatureShift history_shift(const fem::TemperatureShift& shift)
{
  if (const auto* wlf = std::get_if<fem::WlfShift>(&shift))
    return dem::WlfShift{wlf->c1, wlf->c2, wlf->reference_temperature};
  if (const auto* arrhenius = std::get_if<fem::ArrheniusShift>(&shift))
    return dem::ArrheniusShift{arrhenius->activation_energy, arrhenius->reference_temperature};
  throw std::invalid_argument(
      "a Temperature history needs a law with a WLF or Arrhenius shift; the "
      "shift of this law is a factor for each temperature");
}

template <int dim>
fem::Mesh<dim> generated(const Scene& scene, MPI_Comm ranks)
{
  const ContinuumInput::Body& v = scene.continuum.body;
  const Scene::Specimen& size = scene.specimen;
  const fem::Fineness fineness{v.cell_size, int(v.n_refinements), v.cells == CellKind::tetrahedra};
  if constexpr (dim == 2)
    return fem::meridian(ranks, size.diameter,
                         v.shape == BodyShape::hollow_cylinder ? v.inner_diameter : 0, size.height,
                         fineness);
  else
    switch (v.shape) {
    case BodyShape::hollow_cylinder:
      return fem::hollow_cylinder(ranks, size.diameter, v.inner_diameter, size.height, fineness);
    case BodyShape::box:
      return fem::box(ranks, {v.edges[0], v.edges[1], v.edges[2]}, fineness);
    case BodyShape::disc:
      return fem::strip_loaded_disc(ranks, size.diameter, size.height, v.strip_width, fineness);
    case BodyShape::hollow_sphere:
      return fem::hollow_sphere(ranks, size.diameter, v.inner_diameter, fineness);
    default:
      return fem::cylinder(ranks, size.diameter, size.height, fineness);
    }
}

/// A section stands for a body of revolution: the law must be the same around its axis.
void require_axial_symmetry(const BodyLaws& laws)
{
  for (const fem::ComplianceLaw& law : laws.laws)
    if (const double off =
            fem::distance(law, {fem::SymmetryClass::transversely_isotropic, fem::Mat3::Identity()});
        off > 1e-6)
      throw std::invalid_argument(
          fmt::format("Section = meridian: the law is not the same around the z axis (distance "
                      "{:.2g}); use Section = solid, or a law of that symmetry (Volume element/"
                      "Symmetry)",
                      off));
}

} // namespace

BodyLaws read_laws(const LoadedScene& scene)
{
  BodyLaws result;
  const ContinuumInput& v = scene.scene->continuum;
  std::vector<std::pair<std::string, std::string>> files{{"", v.body.law_file}};
  files.insert(files.end(), v.regions.begin(), v.regions.end());
  for (const auto& [region, name] : files) {
    if (name.empty()) // all regions have their own
      continue;
    const std::filesystem::path file = scene.folder / name;
    result.records.push_back(fem::law_from_text(read_text_file(file), file.string()));
    result.laws.push_back(result.records.back().law);
    result.region.push_back(region);
  }
  if (v.body.section == BodySection::meridian)
    require_axial_symmetry(result);
  return result;
}

std::function<double(double)> reduced_time(const Scene& scene, const BodyLaws& laws)
{
  const fem::TemperatureShift shift = shift_of(laws);
  const Scene::Temperature& v = scene.temperature;
  if (has_temperature_history(scene)) {
    std::vector<dem::TemperaturePoint> points;
    for (const auto& [time, temperature] : v.history)
      points.push_back({time, temperature});
    const dem::ReducedTime reduced = has_shift(shift)
                                         ? dem::make_reduced_time(points, history_shift(shift))
                                         : *make_reduced_time(scene);
    return [reduced](double t) { return dem::reduced_time(reduced, t); };
  }
  if (!has_shift(shift) && v.shift == ShiftKind::none) {
    const double reference = laws.records.front().reference_temperature;
    if (std::abs(v.temperature - reference) > 1e-6)
      throw std::invalid_argument(
          fmt::format("the law is for {:g} degC and names no temperature shift, but the test is at "
                      "{:g} degC: set Temperature/Shift, or Temperature/Temperature = {:g} degC",
                      reference - 273.15, v.temperature - 273.15, reference - 273.15));
    return [](double t) { return t; };
  }
  const double factor =
      has_shift(shift) ? fem::shift_factor(shift, v.temperature) : viscosity_shift(scene);
  return [factor](double t) { return t / factor; };
}

void require_range(const Scene& scene, const BodyLaws& laws, double reduced_end)
{
  if (scene.continuum.extrapolate)
    return;
  const std::string remedy = "; to use it there all the same: Continuum/Extrapolate law = true";
  for (const fem::LawRecord& record : laws.records) {
    if (record.last_time > 0 && reduced_end > record.last_time * (1 + 1e-6))
      throw std::invalid_argument(
          fmt::format("the test lasts {:.4g} s of reduced time, but the law was seen up to {:.4g} "
                      "s only{}",
                      reduced_end, record.last_time, remedy));
    if (!record.temperatures)
      continue;
    std::vector<double> temperatures{scene.temperature.temperature};
    if (has_temperature_history(scene)) {
      temperatures.clear();
      for (const auto& point : scene.temperature.history)
        temperatures.push_back(point.second);
    }
    for (const double t : temperatures)
      if (t < record.temperatures->first - 1e-6 || t > record.temperatures->second + 1e-6)
        throw std::invalid_argument(fmt::format(
            "the test is at {:g} degC, but the law was seen from {:g} to {:g} degC{}", t - 273.15,
            record.temperatures->first - 273.15, record.temperatures->second - 273.15, remedy));
  }
}

template <int dim>
fem::Mesh<dim> make_mesh(const LoadedScene& scene, MPI_Comm ranks)
{
  const ContinuumInput::Body& v = scene.scene->continuum.body;
  if (v.shape == BodyShape::file)
    return fem::gmsh_mesh<dim>(ranks, scene.folder / v.mesh_file, v.mesh_unit,
                               int(v.n_refinements));
  return generated<dim>(*scene.scene, ranks);
}

template <int dim>
std::map<dealii::types::material_id, int> law_of_region(const fem::Mesh<dim>& mesh,
                                                        const BodyLaws& laws)
{
  std::map<dealii::types::material_id, int> result;
  std::string all;
  for (const auto& [name, id] : mesh.regions)
    all += (all.empty() ? "" : ", ") + name;
  for (std::size_t k = 0; k < laws.region.size(); ++k) {
    if (laws.region[k].empty())
      continue;
    const auto found = mesh.regions.find(laws.region[k]);
    if (found == mesh.regions.end())
      throw std::invalid_argument(fmt::format("the mesh has no region '{}'; its regions are: {}",
                                              laws.region[k], all.empty() ? "one, unnamed" : all));
    result[found->second] = int(k);
  }
  return result;
}

bool has_platens(const Scene& scene)
{
  return scene.load.test != TestKind::boundary_loads;
}

fem::BodyLoads body_loads(const Scene& scene)
{
  const ContinuumInput& v = scene.continuum;
  fem::BodyLoads loads;
  const bool platens = has_platens(scene);
  if (platens) {
    const std::optional<double> aside =
        v.body.platens == PlatenKind::bonded ? std::optional(0.) : std::nullopt;
    loads.supports.push_back({"bottom", {aside, aside, 0.}});
    loads.supports.push_back({"top", {aside, aside, 1.}});
  }
  if (v.body.section == BodySection::meridian && v.body.shape == BodyShape::cylinder)
    loads.supports.push_back({"axis", {0., std::nullopt, std::nullopt}});
  for (const auto& [name, boundary] : v.boundaries) {
    if (!boundary->displacement.empty())
      loads.supports.push_back(
          {name,
           {boundary->displacement[0], boundary->displacement[1], boundary->displacement[2]}});
    const auto& t = boundary->traction;
    const fem::Vec3 traction = t.empty() ? fem::Vec3::Zero() : fem::Vec3(t[0], t[1], t[2]);
    if (!traction.isZero(0) || boundary->pressure != 0)
      loads.surface.push_back({name, traction, boundary->pressure, platens});
  }
  if (scene.load.confining_stress > 0)
    loads.surface.push_back({"side", fem::Vec3::Zero(), scene.load.confining_stress, true});
  loads.weight = {0, 0, -gravity * v.body.density};
  return loads;
}

std::vector<std::string> boundary_names(const ContinuumInput::Body& body)
{
  if (body.shape == BodyShape::file)
    return {};
  if (body.section == BodySection::meridian)
    return {"bottom", "top", "side", body.shape == BodyShape::cylinder ? "axis" : "inner"};
  switch (body.shape) {
  case BodyShape::hollow_cylinder:
    return {"bottom", "top", "side", "inner"};
  case BodyShape::box:
    return {"left", "right", "front", "back", "bottom", "top"};
  case BodyShape::disc:
    return {"bottom", "top", "rim", "front", "back"};
  case BodyShape::hollow_sphere:
    return {"inner", "side", "left", "front", "bottom"};
  default:
    return {"bottom", "top", "side"};
  }
}

template fem::Mesh<2> make_mesh(const LoadedScene&, MPI_Comm);
template fem::Mesh<3> make_mesh(const LoadedScene&, MPI_Comm);
template std::map<dealii::types::material_id, int> law_of_region(const fem::Mesh<2>&,
                                                                 const BodyLaws&);
template std::map<dealii::types::material_id, int> law_of_region(const fem::Mesh<3>&,
                                                                 const BodyLaws&);

} // namespace apps
