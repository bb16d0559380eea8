#include "bodies.h"
#include "fem/mandel.h"
#include "fem/mesh_parts.h"
#include "tests/fem/tables.h"

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <Eigen/Geometry>

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;

const std::map<std::string, dealii::types::boundary_id> box_sides{
    {"left", 0}, {"right", 1}, {"front", 2}, {"back", 3}, {"bottom", 4}, {"top", 5}};

/// A block whose points have been moved.
Mesh<3> moved_block(const std::function<Vec3(const Vec3&)>& motion)
{
  dealii::Triangulation<3> whole;
  dealii::GridGenerator::subdivided_hyper_rectangle(whole, {3, 2, 2}, dealii::Point<3>(),
                                                    dealii::Point<3>(1, 0.75, 0.5), true);
  dealii::GridTools::transform(
      [&](const dealii::Point<3>& p) {
        const Vec3 to = motion({p[0], p[1], p[2]});
        return dealii::Point<3>(to[0], to[1], to[2]);
      },
      whole);
  return distributed<3>(ranks, whole, {0, 1}, box_sides);
}

ComplianceLaw changed(const ComplianceLaw& law, const std::function<Mat6(const Mat6&)>& change,
                      double times = 1)
{
  std::vector<RetardationTerm> terms;
  for (const RetardationTerm& term : law.terms)
    terms.push_back({times * term.time, change(term.compliance)});
  return make_compliance_law(change(law.instantaneous), change(law.fluidity) / times, terms);
}

/// Force over displacement of a body pressed between rough platens.
template <int dim>
double platen_stiffness(const Mesh<dim>& mesh, int order)
{
  Body<dim> body(mesh, {order}, {{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}},
                 bodies::elastic(1e9, 0.35), TimeScheme::stress_linear, 1e-9);
  body.step({false, 1, 0}, 0);
  return body.specimen.drive_force();
}

} // namespace

TEST(Invariance, TurnedBodiesOfTurnedLawsAnswerTheSame)
{
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, 2, -0.7).normalized()).toRotationMatrix();
  const ComplianceLaw law = tables::anisotropic_law();
  const auto loads = [](const Mat3& r) {
    return BodyLoads{{{"bottom", {0, 0, 0}}},
                     {{"top", r * Vec3(2e5, 1e5, -1e6)}, {"left", Vec3::Zero(), 4e5}},
                     r * Vec3(0, 1e4, -2e4)};
  };
  for (const int order : {1, 2}) {
    Body<3> upright(moved_block([](const Vec3& p) { return p; }), {order}, loads(Mat3::Identity()),
                    law);
    Body<3> turned(moved_block([&](const Vec3& p) -> Vec3 { return turn * p; }), {order},
                   loads(turn), changed(law, [&](const Mat6& m) { return rotated(m, turn); }));
    double size = 0;
    for (const double h : {0., 5., 300.}) {
      upright.step({true, 0, 1}, h);
      turned.step({true, 0, 1}, h);
      for (const Vec6& s : upright.points.stress())
        size = std::max(size, s.norm());
      ASSERT_EQ(upright.points.size(), turned.points.size());
      for (std::size_t q = 0; q < turned.points.size(); ++q)
        EXPECT_LE(
            (turned.points.stress()[q] - mandel_rotation(turn) * upright.points.stress()[q]).norm(),
            1e-9 * size);
    }
  }
}

TEST(Invariance, OtherUnitsGiveTheSameNumbers)
{
  // powers of two scale without rounding; those of stiffness are even as roots of them are taken
  const double length = 1 << 7, stiffness = 1. / (1 << 20), time = 1 << 12;
  const ComplianceLaw law = tables::anisotropic_law();
  const BodyLoads loads{{{"bottom", {0, 0, 0}}, {"top", {0, loose, 1}}},
                        {{"left", Vec3::Zero(), 4e5}}};
  BodyLoads scaled_loads = loads;
  scaled_loads.surface[0].pressure *= stiffness;
  for (const TimeScheme scheme : {TimeScheme::stress_linear, TimeScheme::strain_linear}) {
    Body<3> one(moved_block([](const Vec3& p) { return p; }), {1}, loads, law, scheme);
    Body<3> other(moved_block([&](const Vec3& p) -> Vec3 { return length * p; }), {1}, scaled_loads,
                  changed(
                      law, [&](const Mat6& m) -> Mat6 { return m / stiffness; }, time),
                  scheme);
    for (const double h : {0., 5., 300.}) {
      one.step({true, 1e6, 1}, h);
      other.step({true, 1e6 * stiffness * length * length, 1}, h * time);
      EXPECT_NEAR(other.specimen.drive_displacement() / length / one.specimen.drive_displacement(),
                  1, 1e-11);
      for (std::size_t q = 0; q < one.points.size(); ++q)
        EXPECT_LE((other.points.stress()[q] / stiffness - one.points.stress()[q]).norm(), 1e-3);
      EXPECT_EQ(other.reports.back().n_iterations, one.reports.back().n_iterations);
    }
  }
}

TEST(Invariance, TetrahedraAndHexahedraAgree)
{
  const double hexahedra = platen_stiffness(box(ranks, {1, 1, 1}, {0.25}), 2);
  const double tetrahedra = platen_stiffness(box(ranks, {1, 1, 1}, {0.25, 0, true}), 2);
  EXPECT_NEAR(tetrahedra / hexahedra, 1, 3e-3);
}

TEST(Invariance, SectionsAndSolidsAgreeOnFineMeshes)
{
  const double exact = platen_stiffness(meridian(ranks, 1, 0, 1, {0.5, 4}), 3);
  double before = 0.03;
  for (const double h : {0.5, 0.25}) {
    const double section = platen_stiffness(meridian(ranks, 1, 0, 1, {h}), 2);
    const double solid = platen_stiffness(cylinder(ranks, 1, 1, {h}), 2);
    EXPECT_LT(std::abs(solid / exact - 1), before / 3);
    EXPECT_NEAR(section / exact, 1, 0.02 * h);
    before = std::abs(solid / exact - 1);
  }
}

TEST(Invariance, PinsOfRigidMotionsExertNoForce)
{
  for (const bool simplices : {false, true}) {
    const Mesh<3> mesh = cylinder(ranks, 0.1, 0.1, {0.05, 0, simplices});
    const BodyLoads loads{
        {}, {{"side", Vec3::Zero(), 1e6}, {"top", Vec3(0, 0, 2e6)}, {"bottom", Vec3(0, 0, -2e6)}}};
    Body<3> body(mesh, {2}, loads, tables::anisotropic_law());
    EXPECT_EQ(body.specimen.supports().n_pins, 6);
    body.step({true, 0, 1}, 0);
    body.step({true, 0, 1}, 40);
    const auto& elements = body.specimen.elements();
    Vector force = elements.internal_force(body.points.stress()), load = elements.zero();
    for (const SurfaceLoad& each : loads.surface)
      elements.add_surface_load(boundary_id(mesh, each.boundary), each.traction, each.pressure,
                                load);
    force -= load;
    const double size = load.l2_norm();
    for (const auto dof : body.specimen.supports().held)
      EXPECT_NEAR(force(dof), 0, 1e-10 * size);
    EXPECT_LE(force.l2_norm(), 1e-11 * size);
  }
}
