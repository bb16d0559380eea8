#include "apps/volume_element_keys.h"

#include <fmt/format.h>

#include <stdexcept>

namespace apps {

namespace {

void declare_element(Schema& s, VolumeElementInput& v)
{
  s.section("Volume element",
            "Representative volumes that 'mastic extract' takes a law from. Spheres, grading, "
            "solid fraction and seed are those of the section Specimen.");
  s.choice<ElementSource>(
      "Source", v.source,
      {{"grow", ElementSource::grow}, {"file", ElementSource::file}, {"cut", ElementSource::cut}},
      "grow",
      "grow: periodic packings. file: a periodic packing from Specimen/File, "
      "with Edges. cut: a box of Edges out of the middle of the specimen.");
  s.quantities("Edges", v.edges, "mm", "", any(),
               "Of the cell: three lengths, or nine numbers, the components of three edge vectors. "
               "Empty: a cube that fits the spheres.");
  s.quantity("Cut layer", v.cut_layer, "mm", "4 mm", above(0),
             "For cut: spheres with centres nearer to a face are the boundary.");
  s.choice<dem::BoundaryCondition>(
      "Boundary condition", v.condition,
      {{"periodic", dem::BoundaryCondition::periodic},
       {"affine", dem::BoundaryCondition::affine},
       {"kinematic", dem::BoundaryCondition::kinematic},
       {"uniform traction", dem::BoundaryCondition::uniform_traction}},
      "periodic",
      "That the law is taken under. Stiffness falls in the order affine, kinematic, periodic, "
      "uniform traction. A cut element knows no periodic one.");
  s.flag("Bounds", v.bounds, "true", "Compute the other boundary conditions as well.");
  s.integer("Realisations", v.n_realisations, "4", between(1, 100000),
            "Packings of each size, or specimens to cut from; seeds count up from Specimen/Seed.");
  s.quantities(
      "Sizes", v.sizes, "1", "", at_least(1),
      "Numbers of spheres to compare. Empty: Specimen/Particles. The law is taken from the "
      "largest.");
  s.number("Accuracy", v.accuracy, "0.05", Bounds{0, 1, false, false},
           "Of the stiffness: the verdict says whether the volume is large enough for it.");
}

} // namespace

void declare(Schema& s, VolumeElementInput& v)
{
  declare_element(s, v);
  s.choice<LawSymmetry>("Symmetry", v.symmetry,
                        {{"full", LawSymmetry::full},
                         {"orthotropic", LawSymmetry::orthotropic},
                         {"transversely isotropic", LawSymmetry::transversely_isotropic},
                         {"isotropic", LawSymmetry::isotropic}},
                        "full",
                        "Of the law that is written: the nearest of that symmetry. Its distance is "
                        "reported for all.");
  s.quantity("First time", v.first_time, "s", "1e-3 s", above(0), "Of the law's table and plots.");
  s.quantity("Last time", v.last_time, "s", "1e4 s", above(0), "Of the law's table and plots.");
  s.integer("Times", v.n_times, "61", between(3, 100000), "Evenly over the logarithm.");
  s.integer("Terms", v.n_terms, "0", between(0, 60),
            "Retardation times of a law that has to be fitted (several bond laws that are not "
            "proportional); 0: as many as the data show. Proportional laws need no fit.");
  s.number("Stepping tolerance", v.tolerance, "1e-5", Bounds{0, 0.1, false, true},
           "Of the time stepping for several bond laws, relative, per interval.");
  s.quantities("Modulus temperatures", v.temperatures, "degC", "", above(-273.15),
               "Of the complex modulus, with the shift of the section Temperature. Empty: that of "
               "the scene.");
}

dem::PeriodicCell cell_of(const std::vector<double>& e)
{
  if (e.size() == 3)
    return dem::make_periodic_cell(dem::Vec3(e[0], e[1], e[2]).asDiagonal());
  if (e.size() != 9)
    throw std::invalid_argument(fmt::format("give three lengths or nine components of three "
                                            "vectors, found {} numbers",
                                            e.size()));
  dem::Mat3 edges;
  edges << e[0], e[3], e[6], e[1], e[4], e[7], e[2], e[5], e[8];
  return dem::make_periodic_cell(edges);
}

} // namespace apps
