#include "apps/continuum_check.h"

#include "apps/continuum_body.h"
#include "apps/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace apps {

namespace {

void check_body(const Scene& scene, Findings& findings)
{
  const ContinuumInput& v = scene.continuum;
  const ContinuumInput::Body& body = v.body;
  if (!has_volumes(v) && body.law_file.empty() && v.regions.empty())
    findings.error("Body/Law", "Solver = continuum needs a Law: the .law file of 'mastic extract', "
                               "'mastic fit' or 'mastic calibrate'");
  for (const auto& [name, file] : v.regions)
    if (file.empty())
      findings.error("Region " + name + "/Law", "give the law file of this region");
  if (body.shape == BodyShape::file && body.mesh_file.empty())
    findings.error("Body/Mesh file", "Shape = file needs a Mesh file");
  if (body.shape != BodyShape::file && !v.regions.empty())
    findings.error("Body/Shape", "only a mesh file has regions");
  const bool hollow =
      body.shape == BodyShape::hollow_cylinder || body.shape == BodyShape::hollow_sphere;
  if (hollow && body.inner_diameter >= scene.specimen.diameter)
    findings.error("Body/Inner diameter", "must be less than Specimen/Diameter");
  if (body.shape == BodyShape::disc && body.strip_width >= 0.5 * scene.specimen.diameter)
    findings.error("Body/Strip width", "must be less than half of Specimen/Diameter");
  if (body.shape == BodyShape::box && body.edges.size() != 3)
    findings.error("Body/Edges",
                   fmt::format("three lengths are needed, found {}", body.edges.size()));
  if (body.section == BodySection::meridian && body.shape != BodyShape::cylinder &&
      body.shape != BodyShape::hollow_cylinder && body.shape != BodyShape::file)
    findings.error("Body/Section", "meridian is for cylinder, hollow cylinder and mesh files");
}

void check_volumes(const Scene& scene, Findings& findings)
{
  const ContinuumInput& v = scene.continuum;
  if (!has_volumes(v))
    return;
  if (!v.body.law_file.empty())
    findings.error("Body/Law", "the law of volumes is their own; a Law needs Material = law file");
  if (!v.regions.empty())
    findings.error("Body/Material", "a body of volumes has one region");
  if (scene.element.source == ElementSource::cut)
    findings.error("Volume element/Source", "volumes in a body must be periodic: grow or file");
  if (scene.element.source == ElementSource::file && v.volumes.n_families != 1)
    findings.error("Volumes/Families", "a packing from a file makes one family");
  if (v.body.section == BodySection::meridian)
    findings.error("Body/Section", "a volume is not the same around an axis; use solid");
  if (!breaks(v))
    return;
  const bool followed = v.volumes.solver == VolumeSolver::quasistatic;
  if (!followed && scene.after_breakage == dem::AfterBreakage::friction)
    findings.error("Bonds/After breakage", "volumes know friction with Volumes/Solver = "
                                           "quasistatic only; else use pressed or leave");
  if (followed && v.volumes.softening != SofteningChoice::as_it_is)
    findings.error("Volumes/Softening", "volumes of the solver quasistatic are as large as their "
                                        "elements: use as it is");
  if (scene.strength.kind == StrengthKind::none)
    findings.error("Strength/Distribution", "bonds that do not break need Material = law only");
  if (!v.refinement_times.empty())
    findings.error("Continuum/Refinement times",
                   "broken bonds cannot be carried over to other points; refine at the start");
  if (v.scheme == TimeSchemeChoice::strain_linear)
    findings.error("Continuum/Time scheme", "volumes that break know stress linear only");
}

void check_boundaries(const Scene& scene, Findings& findings)
{
  const ContinuumInput& v = scene.continuum;
  const std::vector<std::string> names = boundary_names(v.body);
  const auto require = [&](const std::string& name, const std::string& key) {
    if (names.empty() || std::ranges::find(names, name) != names.end())
      return;
    const std::string close = nearest(name, names);
    findings.error(key, fmt::format("the body has no boundary '{}'; {}", name,
                                    close.empty() ? fmt::format("its boundaries are: {}",
                                                                fmt::join(names, ", "))
                                                  : fmt::format("did you mean '{}'?", close)));
  };
  bool loaded = v.body.density > 0;
  for (const auto& [name, boundary] : v.boundaries) {
    const std::string section = "Boundary " + name;
    for (const char* key : {"/Displacement", "/Traction", "/Pressure"})
      if (findings.is_set(section + key)) {
        require(name, section + key);
        break;
      }
    if (!boundary->displacement.empty() && boundary->displacement.size() != 3)
      findings.error(section + "/Displacement", "three entries are needed: x, y, z");
    if (!boundary->traction.empty() && boundary->traction.size() != 3)
      findings.error(section + "/Traction", "three entries are needed: x, y, z");
    for (const auto& each : boundary->displacement) {
      loaded = loaded || (each && *each != 0);
      if (has_platens(scene) && each && *each != 0)
        findings.error(section + "/Displacement",
                       "a displacement other than 0 needs Loading/Test = boundary loads");
    }
    loaded = loaded || !boundary->traction.empty() || boundary->pressure != 0;
  }
  if (has_platens(scene)) {
    require("top", "Loading/Test");
    if (v.body.density > 0)
      findings.error("Body/Density", "the weight acts in the test boundary loads only");
  } else if (!loaded)
    findings.error("Loading/Test", "boundary loads: no section 'Boundary NAME' has a Traction, a "
                                   "Pressure or a Displacement other than 0");
  if (scene.load.confining_stress > 0)
    require("side", "Loading/Confining stress");
}

void check_settings(const Scene& scene, Findings& findings)
{
  const ContinuumInput& v = scene.continuum;
  const bool simplices = v.body.cells == CellKind::tetrahedra && v.body.shape != BodyShape::file;
  if (simplices && v.order > 2)
    findings.error("Continuum/Order", "tetrahedra have the orders 1 and 2");
  if (simplices && (v.n_adaptive_refinements > 0 || !v.refinement_times.empty()))
    findings.error("Body/Cells", "adaptive refinement needs hexahedra");
  for (const auto& [key, numbers] :
       {std::pair("Probes/Line from", &v.probes.line_from), {"Probes/Line to", &v.probes.line_to}})
    if (!numbers->empty() && numbers->size() != 3)
      findings.error(key, "three coordinates are needed");
  if (v.probes.line_from.empty() != v.probes.line_to.empty())
    findings.error("Probes/Line from", "a line needs Line from and Line to");
  if (v.probes.points.size() % 3 != 0)
    findings.error("Probes/Points", "three coordinates are needed for each place");
  if (scene.load.true_stress)
    findings.error("Loading/True stress", "a continuum is of small strain: stresses are nominal");
  if (scene.load.test == TestKind::particle_loads)
    findings.error("Loading/Test", "a continuum has no particles; use boundary loads");
  if (scene.repeat.wanted())
    findings.error("Repeat/Scene", "runs of a continuum are not repeated by the section Repeat");
}

} // namespace

void check_continuum(const Scene& scene, Findings& findings)
{
  if (scene.solver != SolverChoice::continuum) {
    const ContinuumInput::Body& body = scene.continuum.body;
    if (!body.law_file.empty())
      findings.error("Body/Law", "the section Body is for Solver = continuum");
    if (!body.mesh_file.empty())
      findings.error("Body/Mesh file", "the section Body is for Solver = continuum");
    if (!scene.continuum.boundaries.empty())
      findings.error("Solver", "sections 'Boundary NAME' are for Solver = continuum");
    return;
  }
  check_body(scene, findings);
  check_volumes(scene, findings);
  check_boundaries(scene, findings);
  check_settings(scene, findings);
}

} // namespace apps
