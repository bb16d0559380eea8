#include "apps/continuum_keys.h"

#include <fmt/format.h>

namespace apps {

namespace {

void declare_body(Schema& s, ContinuumInput::Body& v)
{
  s.section("Body", "The body of Solver = continuum: its shape, mesh and creep law.");
  s.choice<BodyShape>(
      "Shape", v.shape,
      {{"cylinder", BodyShape::cylinder},
       {"hollow cylinder", BodyShape::hollow_cylinder},
       {"box", BodyShape::box},
       {"disc", BodyShape::disc},
       {"hollow sphere", BodyShape::hollow_sphere},
       {"file", BodyShape::file}},
      "cylinder",
      "Diameter and height are those of the section Specimen. Names of boundaries: cylinder: "
      "bottom, top, side; hollow cylinder: also inner; box: left, right, front, back, bottom, top; "
      "disc (lying on its rim, Height is its thickness): bottom and top (the loading strips), rim, "
      "front, back; hollow sphere (one eighth): inner, side, left, front, bottom; file: those of "
      "the physical groups.");
  s.choice<BodySection>("Section", v.section,
                        {{"solid", BodySection::solid}, {"meridian", BodySection::meridian}},
                        "solid",
                        "meridian: only the section r, z of a (hollow) cylinder, or of a flat mesh "
                        "file, for laws and loads that are the same around the axis. Boundaries of "
                        "a cylinder: axis or inner, side, bottom, top.");
  s.quantities("Edges", v.edges, "mm", "100 mm, 100 mm, 100 mm", above(0), "Of a box: x, y, z.");
  s.quantity("Inner diameter", v.inner_diameter, "mm", "20 mm", above(0),
             "Of hollow cylinder and hollow sphere.");
  s.quantity("Strip width", v.strip_width, "mm", "12.7 mm", above(0), "Of the loading strips.");
  s.words("Mesh file", v.mesh_file, "", "Gmsh mesh (.msh, format 2.2 or 4.1) for Shape = file.");
  s.quantity("Mesh unit", v.mesh_unit, "mm", "1 mm", above(0),
             "Length that a coordinate of 1 in the mesh file stands for.");
  s.choice<CellKind>("Cells", v.cells,
                     {{"hexahedra", CellKind::hexahedra}, {"tetrahedra", CellKind::tetrahedra}},
                     "hexahedra", "Of generated meshes; in a section quadrilaterals or triangles.");
  s.quantity("Cell size", v.cell_size, "mm", "10 mm", above(0), "Largest edge of generated cells.");
  s.integer("Refinements", v.n_refinements, "0", between(0, 8), "Halvings of all cells.");
  s.choice<PlatenKind>(
      "Platens", v.platens,
      {{"bonded", PlatenKind::bonded}, {"frictionless", PlatenKind::frictionless}}, "bonded",
      "Rigid platens at bottom and top, for all tests but boundary loads: glued, or without "
      "friction.");
  s.choice<MaterialChoice>(
      "Material", v.material,
      {{"law file", MaterialChoice::law_file},
       {"law only", MaterialChoice::law_only},
       {"adaptive", MaterialChoice::adaptive},
       {"all live", MaterialChoice::all_live}},
      "law file",
      "law file: the key Law. The others make each point a volume of bonded spheres (sections "
      "Volumes, Specimen, Bonds, Strength). law only: its exact law, nothing breaks. adaptive: "
      "its bonds break; it stays on its law until the first one does. all live: every bond of "
      "every volume is looked at in every step, to check adaptive.");
  s.words("Law", v.law_file, "",
          "Law file (.law) of the body, from 'mastic extract', 'mastic fit' or 'mastic calibrate'; "
          "of all regions that have no section of their own.");
  s.quantity("Density", v.density, "kg/m^3", "0 kg/m^3", at_least(0),
             "For the weight, along -z, times the load factor; test boundary loads.");
}

void declare_boundary(Schema& s, const std::string& name, BoundaryInput& v)
{
  s.section("Boundary " + name, "What acts on a boundary of the body; in a meridian section x is "
                                "the radius.");
  s.optional_quantities("Displacement", v.displacement, "free", "mm", "", any(),
                        "x, y, z, each free or a displacement (times the load factor).");
  s.quantities("Traction", v.traction, "kPa", "", any(),
               "x, y, z, force per area (times the load factor in the test boundary loads, else in "
               "full from the start).");
  s.quantity("Pressure", v.pressure, "kPa", "0 kPa", any(),
             "Against the outward normal (load factor as for Traction).");
}

void declare_solver(Schema& s, ContinuumInput& v)
{
  s.section("Continuum", "How the continuum is solved.");
  s.integer("Order", v.order, "2", between(1, 3), "Of the elements; tetrahedra have 1 and 2.");
  s.choice<fem::Dilatation>(
      "Dilatation", v.dilatation,
      {{"projected", fem::Dilatation::projected}, {"pointwise", fem::Dilatation::pointwise}},
      "projected",
      "projected: volume strain of one degree less, which does not lock when the material is "
      "nearly incompressible. pointwise: as it is.");
  s.choice<TimeSchemeChoice>("Time scheme", v.scheme,
                             {{"auto", TimeSchemeChoice::automatic},
                              {"stress linear", TimeSchemeChoice::stress_linear},
                              {"strain linear", TimeSchemeChoice::strain_linear}},
                             "auto",
                             "What changes linearly within a step. stress linear is exact for "
                             "constant stresses, strain linear for held strains. auto: by whether "
                             "the load or the displacement is prescribed.");
  s.number("Step tolerance", v.step_tolerance, "1e-5", Bounds{0, 0.1, false, true},
           "Estimated error of a time step over the strain (or stress).");
  s.number("Solver tolerance", v.solver_tolerance, "1e-9", Bounds{0, 1e-3, false, true},
           "Residual forces over loads and reactions.");
  s.quantity("First step", v.first_step, "s", "1e-3 s", above(0), "After a jump of the load.");
  s.flag("Extrapolate law", v.extrapolate, "false",
         "Use a law at times and temperatures in which it was not measured.");
  s.integer("Adaptive refinements", v.n_adaptive_refinements, "0", between(0, 12),
            "At the start: solve elastically, refine where the error indicator is largest, again.");
  s.number("Refined share", v.refined_share, "0.2", Bounds{0, 1, false, true},
           "Of the cells, each time.");
  s.quantities("Refinement times", v.refinement_times, "s", "", at_least(0),
               "Refine again at these times; the state is carried over.");
}

void declare_volumes(Schema& s, ContinuumInput::Volumes& v)
{
  s.section("Volumes",
            "The volumes of bonded spheres that the points of a body are (Body/Material). "
            "Source and Edges are those of the section Volume element.");
  s.integer("Particles", v.n_particles, "200", between(1, 1000000), "Of each volume.");
  s.integer("Families", v.n_families, "1", between(0, 1000000),
            "Different volumes, with packings and strengths from Specimen/Seed and Strength/Seed "
            "on, dealt to the points at random. 0: each point has one of its own.");
  s.choice<VolumeSolver>(
      "Solver", v.solver,
      {{"events", VolumeSolver::events}, {"quasistatic", VolumeSolver::quasistatic}}, "events",
      "events: the closed form, for bonds that share one law and small motion, without friction. "
      "quasistatic: friction, new contacts, finite motion inside the volumes (section "
      "Quasistatic), and bonds of several laws with Material = all live; many times the work.");
  s.choice<SofteningChoice>(
      "Softening", v.softening,
      {{"scaled", SofteningChoice::scaled}, {"as it is", SofteningChoice::as_it_is}}, "scaled",
      "Breaking gathers in a band as wide as a volume. scaled: a point of another size is a volume "
      "in series with (or short of) intact material, so that the energy per area of the band does "
      "not depend on the mesh. as it is: the point is the volume; refused unless their sizes agree "
      "within 25 %.");
  s.number("Breakage tolerance", v.breakage_tolerance, "1e-6", between(1e-12, 0.5),
           "Bonds that are this share below their strength, or below the most loaded one, break "
           "with it; larger is faster.");
  s.number("Balance", v.balance, "1.2", at_least(0),
           "Over the ranks of mpirun: from this ratio of the largest to the mean cost of the ranks "
           "on, measured as the run goes, cells are shared out anew where that is worth its time. "
           "0: never.");
}

void declare_probes(Schema& s, ContinuumInput::Probes& v)
{
  s.section("Probes", "Places of a continuum whose displacement, strain and stress are recorded.");
  s.quantities("Points", v.points, "mm", "", any(), "x, y, z of one place after the other.");
  s.quantities("Line from", v.line_from, "mm", "", any(), "x, y, z of the start of a line.");
  s.quantities("Line to", v.line_to, "mm", "", any(), "x, y, z of its end.");
  s.integer("Line points", v.n_line_points, "21", between(2, 10000), "Places on it.");
}

} // namespace

void declare(Schema& s, ContinuumInput& v, const std::vector<std::string>& boundaries,
             const std::vector<std::string>& regions)
{
  declare_body(s, v.body);
  for (const std::string& name : boundaries) {
    v.boundaries[name] = std::make_unique<BoundaryInput>();
    declare_boundary(s, name, *v.boundaries[name]);
  }
  for (const std::string& name : regions) {
    s.section("Region " + name, "A region of the body with a law of its own.");
    s.words("Law", v.regions[name], "", "Law file (.law).");
  }
  declare_solver(s, v);
  declare_volumes(s, v.volumes);
  declare_probes(s, v.probes);
}

} // namespace apps
