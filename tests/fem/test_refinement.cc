#include "fem/refinement.h"

#include "bodies.h"
#include "fem/cell_states.h"
#include "fem/mesh_parts.h"
#include "tests/fem/tables.h"

#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_generator.h>

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;

/// A square with a corner cut out (an L) as the section of a ring, pulled up at its top.
Mesh<2> corner(int n_refinements)
{
  dealii::Triangulation<2> whole;
  dealii::GridGenerator::hyper_L(whole, 10, 12);
  for (const auto& face : whole.active_face_iterators())
    if (face->at_boundary()) {
      const auto p = face->center();
      face->set_boundary_id(p[1] < 10 + 1e-9 ? 1 : p[1] > 12 - 1e-9 ? 2 : 0);
    }
  return distributed<2>(ranks, whole, {0, n_refinements}, {{"rest", 0}, {"bottom", 1}, {"top", 2}});
}

const BodyLoads pulled{{{"bottom", {0, loose, 0}}, {"top", {loose, loose, 1}}}, {}};

/// Displacement of the driven top under a force.
double stretch(const Mesh<2>& mesh, int order)
{
  Body<2> body(mesh, {order}, pulled, bodies::elastic(1e9, 0.3));
  body.step({true, 1e6, 0}, 0);
  return body.specimen.drive_displacement();
}

long n_unknowns(const Mesh<2>& mesh, int order)
{
  return long(Elements<2>(mesh, {order}).dofs().n_dofs());
}

std::vector<double> numbers(const MaterialPoints& points)
{
  std::vector<double> all;
  for (std::size_t q = 0; q < points.size(); ++q) {
    all.resize(all.size() + points.numbers_per_point());
    points.store(q, std::span(all).last(points.numbers_per_point()));
  }
  return all;
}

} // namespace

/// A column under its weight and a load on its top: the stress is linear in the height, and so is
/// the strain, which is sigma / E times the creep function.
struct Column {
  static constexpr double height = 2, weight = 2e4, load = 1e5;
  fem::CreepCompliance creep = fem::burgers_compliance(1e9, 1e11, 2e9, 1e10);
  ComplianceLaw law = fem::isotropic_law(creep, 0);
  BodyLoads loads{
      {{"bottom", {loose, loose, 0}}}, {{"top", Vec3(0, 0, -load)}}, Vec3(0, 0, -weight)};

  dealii::Tensor<1, 3> displacement(const dealii::Point<3>& p, double t) const
  {
    const double z = p[2];
    return dealii::Tensor<1, 3>(
        {0, 0, fem::value(creep, t) * (-load * z - weight * (height * z - z * z / 2))});
  }
};

TEST(Refinement, LinearStatesAreCarriedOverAndStay)
{
  const Column column;
  for (const Dilatation dilatation : {Dilatation::pointwise, Dilatation::projected}) {
    const Mesh<3> mesh = box(ranks, {1, 1, Column::height}, {0.5});
    Body<3> before(mesh, {2, dilatation}, column.loads, column.law);
    before.step({true, 0, 1}, 0);
    before.step({true, 0, 1}, 30);
    const auto states = refine(mesh, before.specimen, before.points, 0.3);
    EXPECT_GT(mesh.cells->n_global_active_cells(), 16U);
    EXPECT_TRUE(mesh.cells->has_hanging_nodes());

    Body<3> after(mesh, {2, dilatation}, column.loads, column.law);
    restore_cell_states(after.specimen, after.points, states, 0);
    const auto error = [&](double t) {
      return after.l2_error([&](const dealii::Point<3>& p) { return column.displacement(p, t); });
    };
    EXPECT_LE(error(30), 1e-8);
    const Vector displacement = after.specimen.displacement();
    after.step({true, 0, 1}, 0);
    EXPECT_EQ(after.reports.back().n_solves, 0) << "equilibrium was not carried over";
    Vector change = after.specimen.displacement();
    change -= displacement;
    EXPECT_EQ(change.l2_norm(), 0);
    after.step({true, 0, 1}, 500);
    EXPECT_LE(error(530), 1e-8);
  }
}

TEST(Refinement, CarriesHistoriesOverThatAreLinearInSpace)
{
  // strains of quadratic displacements are linear: any law, stress and internal variables are too
  const ComplianceLaw law = tables::anisotropic_law();
  for (const TimeScheme scheme : {TimeScheme::stress_linear, TimeScheme::strain_linear}) {
    const Mesh<3> mesh = box(ranks, {1, 1, 1}, {0.5});
    const auto lead = [](Body<3>& body, double factor, double h) {
      const auto& elements = body.specimen.elements();
      Vector u = elements.zero();
      const auto places = support_points(elements);
      for (const auto dof : elements.dofs().locally_owned_dofs()) {
        const auto& p = places.at(dof);
        u(dof) = factor * (p[0] * p[1] + 2 * p[2] * p[2] - 0.5 * p[0] * p[2] + p[1]);
      }
      u.update_ghost_values();
      std::vector<Vec6> strain(elements.n_points());
      elements.strains(u, strain);
      for (std::size_t q = 0; q < strain.size(); ++q)
        strain[q] -= body.points.strain()[q];
      body.points.evaluate(strain, h);
      body.points.commit();
    };
    Body<3> body(mesh, {2, Dilatation::pointwise}, {}, law, scheme);
    for (const double h : {0., 4., 60.})
      lead(body, 1e-3 * (1 + 0.1 * h), h);
    const auto states = refine(mesh, body.specimen, body.points, 0.4);
    Body<3> fine(mesh, {2, Dilatation::pointwise}, {}, law, scheme);
    restore_cell_states(fine.specimen, fine.points, states, 0);
    Body<3> direct(mesh, {2, Dilatation::pointwise}, {}, law, scheme);
    for (const double h : {0., 4., 60.})
      lead(direct, 1e-3 * (1 + 0.1 * h), h);
    const auto found = numbers(fine.points), wanted = numbers(direct.points);
    double difference = 0, size = 0;
    const std::size_t n = fine.points.numbers_per_point();
    for (std::size_t k = 0; k < n; ++k) { // kinds of numbers have sizes of their own
      for (std::size_t q = 0; q < fine.points.size(); ++q) {
        difference = std::max(difference, std::abs(found[q * n + k] - wanted[q * n + k]));
        size = std::max(size, std::abs(wanted[q * n + k]));
      }
      EXPECT_LE(difference, 1e-11 * size) << k;
      difference = size = 0;
    }
  }
}

TEST(Refinement, AdaptiveMeshesNeedFewerUnknownsAtACorner)
{
  for (const int order : {1, 2}) {
    const Mesh<2> best = corner(1);
    for (int k = 0; k < 12; ++k) {
      Body<2> body(best, {3}, pulled, bodies::elastic(1e9, 0.3));
      body.step({true, 1e6, 0}, 0);
      refine(best, body.specimen, body.points, 0.15);
    }
    const double exact = stretch(best, 3);
    const Mesh<2> uniform = corner(4);
    const long most = n_unknowns(uniform, order);
    const double error = std::abs(stretch(uniform, order) - exact);
    const Mesh<2> adaptive = corner(1);
    double adaptive_error = 0;
    while (true) {
      Body<2> body(adaptive, {order}, pulled, bodies::elastic(1e9, 0.3));
      if (long(body.specimen.elements().dofs().n_dofs()) > most)
        break;
      body.step({true, 1e6, 0}, 0);
      adaptive_error = std::abs(body.specimen.drive_displacement() - exact);
      refine(adaptive, body.specimen, body.points, 0.2);
    }
    EXPECT_LE(adaptive_error, error / (order == 1 ? 3 : 8)) << order;
    EXPECT_GT(adaptive_error, 0);
  }
}

TEST(Refinement, StoredCellsGoOnAsTheBodyThatWasStored)
{
  const ComplianceLaw law = bodies::burgers_in_shear();
  const BodyLoads loads{{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}};
  const Mesh<3> mesh = box(ranks, {1, 1, 1}, {0.5});
  {
    Body<3> first(mesh, {1}, loads, law);
    first.step({true, 1e6, 0}, 0);
    refine(mesh, first.specimen, first.points, 0.3);
  }
  Body<3> body(mesh, {1}, loads, law);
  body.step({true, 1e6, 0}, 0);
  body.step({true, 1e6, 0}, 10);
  StoredCells stored = gathered(mesh, cell_states(body.specimen, body.points));
  stored.names = dealii::Utilities::MPI::broadcast(ranks, stored.names);
  stored.states = dealii::Utilities::MPI::broadcast(ranks, stored.states);
  EXPECT_EQ(stored.names.size(), mesh.cells->n_global_active_cells());

  std::vector<std::unique_ptr<Body<3>>> restored;
  for (int k = 0; k < 2; ++k) {
    const Mesh<3> again = box(ranks, {1, 1, 1}, {0.5});
    refine_to(again, stored.names);
    restored.push_back(std::make_unique<Body<3>>(again, Discretisation{1}, loads, law));
    restore_cell_states(restored.back()->specimen, restored.back()->points,
                        own_states(again, stored), body.specimen.drive_displacement());
    restored.back()->points.set_last_step(body.points.last_step());
    EXPECT_EQ(numbers(restored.back()->points), numbers(body.points));
    Vector difference = restored.back()->specimen.displacement();
    difference -= body.specimen.displacement();
    EXPECT_EQ(difference.l2_norm(), 0);
    restored.back()->step({true, 1e6, 0}, 25);
  }
  EXPECT_EQ(numbers(restored[0]->points), numbers(restored[1]->points));
  body.step({true, 1e6, 0}, 25);
  for (std::size_t q = 0; q < body.points.size(); ++q)
    EXPECT_LE((body.points.stress()[q] - restored[0]->points.stress()[q]).norm(), 1e-3);
  EXPECT_NEAR(restored[0]->specimen.drive_displacement() / body.specimen.drive_displacement(), 1,
              1e-10);
}

TEST(Refinement, RefusesSimplicesAndCellsOfAnotherMesh)
{
  Body<3> body(box(ranks, {1, 1, 1}, {1, 0, true}), {1}, {}, bodies::elastic(1, 0));
  EXPECT_THROW(refine(box(ranks, {1, 1, 1}, {1, 0, true}), body.specimen, body.points, 0.5),
               std::invalid_argument);
  const Mesh<3> one = box(ranks, {1, 1, 1}, {0.5}), other = box(ranks, {1, 1, 1}, {0.25});
  StoredCells stored = gathered(
      other, std::vector<std::vector<double>>(other.cells->n_locally_owned_active_cells()));
  stored.names = dealii::Utilities::MPI::broadcast(ranks, stored.names);
  EXPECT_THROW(refine_to(one, stored.names), std::invalid_argument);
}
