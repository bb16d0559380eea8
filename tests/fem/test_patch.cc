#include "bodies.h"
#include "fem/mandel.h"
#include "fem/mesh_parts.h"
#include "fem/refinement.h"
#include "tests/fem/tables.h"

#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <fmt/format.h>

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;

const std::map<std::string, dealii::types::boundary_id> box_sides{
    {"left", 0}, {"right", 1}, {"front", 2}, {"back", 3}, {"bottom", 4}, {"top", 5}};

struct Kind {
  bool simplices, hanging;
  int order;
  Dilatation dilatation;
};

const std::vector<Kind> kinds = [] {
  std::vector<Kind> all;
  for (const Dilatation dilatation : {Dilatation::pointwise, Dilatation::projected})
    for (const int order : {1, 2}) {
      all.push_back({false, false, order, dilatation});
      all.push_back({false, true, order, dilatation});
      all.push_back({true, false, order, dilatation});
    }
  return all;
}();

std::string name(const Kind& kind)
{
  return fmt::format("{}{} of order {}, {}", kind.hanging ? "refined " : "",
                     kind.simplices ? "tetrahedra" : "hexahedra", kind.order,
                     kind.dilatation == Dilatation::projected ? "projected" : "pointwise");
}

/// A box of edges 1, 1.2 and 0.8 m; vertices inside are moved at random, and those on the sides
/// within their sides.
Mesh<3> distorted_box(const Kind& kind, double share)
{
  dealii::Triangulation<3> whole, split;
  const dealii::Point<3> corner(1, 1.2, 0.8);
  const std::vector<unsigned> cells{3, 3, 2};
  dealii::GridGenerator::subdivided_hyper_rectangle(whole, cells, dealii::Point<3>(), corner, true);
  if (kind.simplices) {
    dealii::GridGenerator::convert_hypercube_to_simplex_mesh(whole, split);
    whole.clear();
    whole.copy_triangulation(split);
  }
  std::mt19937_64 random(3);
  dealii::GridTools::transform(
      [&](const dealii::Point<3>& p) {
        dealii::Point<3> moved = p;
        for (unsigned k = 0; k < 3; ++k) {
          const double by = double(random() % 2001) / 1e3 - 1;
          if (p[k] > 1e-9 && p[k] < corner[k] - 1e-9)
            moved[k] += share * by * corner[k] / cells[k];
        }
        return moved;
      },
      whole);
  Mesh<3> mesh = distributed<3>(ranks, whole, {0}, box_sides);
  if (kind.hanging) {
    for (const auto& cell : mesh.cells->active_cell_iterators())
      if (cell->is_locally_owned() && cell->center()[0] + cell->center()[2] < 0.8)
        cell->set_refine_flag();
    mesh.cells->execute_coarsening_and_refinement();
  }
  return mesh;
}

/// Tractions of a constant stress on all sides of a box.
BodyLoads tractions(const Mat3& stress)
{
  BodyLoads loads;
  for (const auto& [side, id] : box_sides)
    loads.surface.push_back({side, (id % 2 == 0 ? -1 : 1) * stress.col(int(id / 2))});
  return loads;
}

/// Largest relative difference of the states at the points from one.
double spread(std::span<const Vec6> states, const Vec6& expected)
{
  double worst = 0;
  for (const Vec6& each : states)
    worst = std::max(worst, (each - expected).norm() / expected.norm());
  return dealii::Utilities::MPI::max(worst, ranks);
}

Mat3 some_stress()
{
  Mat3 stress;
  stress << 1, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.7;
  return 1e6 * stress;
}

/// The anisotropic law of the table with all of it creeping as the Burgers element of unit
/// instantaneous compliance.
constexpr double maxwell_time = 200, kelvin_share = 5. / 3, kelvin_time = 20;

ComplianceLaw proportional_anisotropic()
{
  const Mat6 shape = compliance(tables::anisotropic_law(), 30);
  const RetardationTerm kelvin{kelvin_time, kelvin_share * shape};
  return make_compliance_law(shape, shape / maxwell_time, std::span(&kelvin, 1));
}

double creep_function(double t)
{
  return 1 + t / maxwell_time - kelvin_share * std::expm1(-t / kelvin_time);
}

} // namespace

TEST(Patch, ConstantStressIsExactOnDistortedCells)
{
  const ComplianceLaw law = tables::anisotropic_law();
  const Vec6 stress = mandel_vector(some_stress());
  for (const Kind& kind : kinds) {
    Body<3> body(distorted_box(kind, 0.25), {kind.order, kind.dilatation}, tractions(some_stress()),
                 law, TimeScheme::stress_linear, 1e-13);
    EXPECT_EQ(body.specimen.supports().n_pins, 6) << name(kind);
    double t = 0;
    for (const double h : {0., 3., 500.}) {
      body.step({true, 0, 1}, h);
      t += h;
      const double tolerance = kind.order == 1 ? 1e-12 : 5e-12;
      EXPECT_LE(spread(body.points.stress(), stress), tolerance) << name(kind) << ' ' << t;
      EXPECT_LE(spread(body.points.strain(), compliance(law, t) * stress), tolerance)
          << name(kind) << ' ' << t;
    }
  }
}

TEST(Patch, PlatensGiveAConstantStretchOnDistortedCells)
{
  const BodyLoads platens{{{"bottom", {loose, loose, 0}},
                           {"top", {loose, loose, 1}},
                           {"left", {0, loose, loose}},
                           {"right", {0, loose, loose}},
                           {"front", {loose, 0, loose}},
                           {"back", {loose, 0, loose}}},
                          {}};
  const ComplianceLaw law = bodies::elastic(3e9, 0.35);
  const Vec6 strain = -1e-3 / 0.8 * Vec6::Unit(2);
  for (const Kind& kind : kinds) {
    Body<3> body(distorted_box(kind, 0.25), {kind.order, kind.dilatation}, platens, law,
                 TimeScheme::stress_linear, 1e-13);
    body.step({false, -1e-3, 0}, 0);
    EXPECT_LE(spread(body.points.strain(), strain), 1e-12) << name(kind);
    EXPECT_LE(body.displacement_error([](const dealii::Point<3>& p) {
      return dealii::Tensor<1, 3>({0, 0, -1e-3 / 0.8 * p[2]});
    }),
              1e-15)
        << name(kind);
    const double stiffness = 3e9 * 0.65 / (1.35 * 0.3) * 1.2; // of the plate, times its area
    EXPECT_NEAR(body.specimen.drive_force() / (-1e-3 / 0.8 * stiffness), 1, 1e-12) << name(kind);
  }
}

TEST(Patch, MeridianKeepsConstantStates)
{
  for (const bool simplices : {false, true})
    for (const int order : {1, 2})
      for (const Dilatation dilatation : {Dilatation::pointwise, Dilatation::projected})
        for (const double inner : {0., 0.3}) {
          const Mesh<2> mesh = meridian(ranks, 2, 2 * inner, 1, {0.4, 0, simplices});
          BodyLoads loads{
              {},
              {{"side", Vec3(2e6, 0, 0)}, {"top", Vec3(0, 0, -1e6)}, {"bottom", Vec3(0, 0, 1e6)}}};
          if (inner > 0)
            loads.surface.push_back({"inner", Vec3::Zero(), -2e6});
          Body<2> body(mesh, {order, dilatation}, loads, bodies::burgers_in_shear(),
                       TimeScheme::stress_linear, 1e-13);
          EXPECT_EQ(body.specimen.supports().n_pins, 1);
          Vec6 stress;
          stress << 2e6, 2e6, -1e6, 0, 0, 0;
          for (const double h : {0., 100.}) {
            body.step({true, 0, 1}, h);
            EXPECT_LE(spread(body.points.stress(), stress), order == 1 ? 1e-12 : 1e-11)
                << order << inner;
          }
        }
}

TEST(Patch, ProportionalLawGivesTheElasticAnswerTimesTheCreepFunction)
{
  const ComplianceLaw law = proportional_anisotropic();
  const BodyLoads by_force{{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}};
  const BodyLoads by_traction{{{"bottom", {0, 0, 0}}},
                              {{"top", Vec3(1e6, 0, -2e6)}, {"left", Vec3::Zero(), 3e6}}};
  for (const Kind& kind : kinds) {
    for (const bool forced : {true, false}) {
      Body<3> body(distorted_box(kind, 0.25), {kind.order, kind.dilatation},
                   forced ? by_force : by_traction, law);
      const LoadState load{true, forced ? 1e6 : 0., 1};
      body.step(load, 0);
      const Vector elastic = body.specimen.displacement();
      const std::vector<Vec6> stress(body.points.stress().begin(), body.points.stress().end());
      double t = 0;
      for (const double h : {1e-3, 10., 1000.}) {
        body.step(load, h);
        t += h;
        Vector difference = elastic;
        difference *= -creep_function(t);
        difference += body.specimen.displacement();
        EXPECT_LE(difference.l2_norm(), 1e-10 * creep_function(t) * elastic.l2_norm())
            << name(kind) << t;
        double change = 0, size = 0;
        for (std::size_t q = 0; q < stress.size(); ++q) {
          change = std::max(change, (body.points.stress()[q] - stress[q]).norm());
          size = std::max(size, stress[q].norm());
        }
        EXPECT_LE(change, 1e-9 * size) << name(kind) << t;
      }
      EXPECT_FALSE(body.reports.back().assembled) << "one matrix serves all steps";
      EXPECT_LE(body.reports.back().n_iterations, 3) << "the answer is a multiple of the last";
    }
  }
}

TEST(Patch, ProportionalLawHoldsOnAdaptivelyRefinedMeshes)
{
  const ComplianceLaw law = proportional_anisotropic();
  const BodyLoads loads{{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}};
  const Mesh<3> mesh = distorted_box({false, false, 1, Dilatation::projected}, 0.25);
  for (int k = 0; k < 2; ++k) {
    Body<3> body(mesh, {1}, loads, law);
    body.step({true, -1e6, 0}, 0);
    refine(mesh, body.specimen, body.points, 0.2);
  }
  Body<3> body(mesh, {1}, loads, law);
  body.step({true, -1e6, 0}, 0);
  const double first = body.specimen.drive_displacement();
  body.step({true, -1e6, 0}, 50);
  EXPECT_NEAR(body.specimen.drive_displacement() / first / creep_function(50), 1, 1e-10);
}

TEST(Patch, BodiesAreStillRightAfterABillionSeconds)
{
  const ComplianceLaw law = bodies::burgers_in_shear();
  const double stress = 1, end = 1e9;
  Body<3> body(distorted_box({false, false, 1, Dilatation::projected}, 0.25), {1},
               tractions(stress * Mat3(Vec3(0, 0, 1).asDiagonal())), law, TimeScheme::stress_linear,
               1e-9);
  body.step({true, 0, 1}, 0);
  for (const double h : {1., 1e3, 1e6, end - 1001001})
    body.step({true, 0, 1}, h);
  const double strain = stress * compliance(law, end)(2, 2);
  for (const Vec6& each : body.points.strain())
    EXPECT_NEAR(each[2] / strain, 1, 1e-9);
  double kept = strain - stress * law.instantaneous(2, 2); // and given back by the Kelvin element
  body.step({true, 0, 0}, 0);
  for (const Vec6& each : body.points.strain())
    EXPECT_NEAR(each[2], kept, 1e-9 * strain);
  body.step({true, 0, 0}, 1000);
  kept = stress * end * law.fluidity(2, 2);
  for (const Vec6& each : body.points.strain())
    EXPECT_NEAR(each[2], kept, 1e-9 * strain);
}
