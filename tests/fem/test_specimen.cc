#include "bodies.h"

#include <deal.II/distributed/tria.h>
#include <deal.II/grid/grid_tools.h>

using bodies::Body;
using bodies::elastic;
using bodies::ranks;
using fem::Vec3;

namespace {

constexpr std::optional<double> loose;

/// Uniaxial test of a box between frictionless platens.
fem::BodyLoads frictionless_platens()
{
  return {{{"bottom", {loose, loose, 0}}, {"top", {loose, loose, 1}}}, {}};
}

TEST(Specimen, ElasticBoxUnderForceStretchesAsHookeSays)
{
  for (const bool simplices : {false, true})
    for (const int order : {1, 2}) {
      const fem::Mesh<3> mesh = fem::box(ranks, {1, 2, 3}, {1, 0, simplices});
      Body<3> body(mesh, {order}, frictionless_platens(), elastic(1e9, 0.3));
      body.step({true, -2e6, 0}, 0);
      const double strain = -1e6 / 1e9;
      EXPECT_NEAR(body.specimen.drive_displacement(), 3 * strain, 1e-14);
      for (const fem::Vec6& s : body.points.stress()) {
        EXPECT_NEAR(s[2], -1e6, 1e-5);
        EXPECT_NEAR(s[0], 0, 1e-5);
      }
      EXPECT_EQ(body.specimen.supports().n_pins, 3);
    }
}

TEST(Specimen, BarCreepsAsTheClosedFormAtAllTimes)
{
  const fem::Mesh<3> mesh = fem::box(ranks, {1, 1, 1}, {0.5});
  const fem::ComplianceLaw law = bodies::burgers_in_shear();
  Body<3> body(mesh, {1}, frictionless_platens(), law);
  double t = 0;
  body.step({true, 1e6, 0}, 0);
  for (const double h : {0.5, 1.5, 18., 180., 1800.}) {
    body.step({true, 1e6, 0}, h);
    t += h;
    const double strain = 1e6 * fem::compliance(law, t)(2, 2);
    EXPECT_NEAR(body.specimen.drive_displacement(), strain, 1e-10 * strain) << t;
  }
}

TEST(Specimen, UnloadedBodyIsAtRest)
{
  const fem::Mesh<3> mesh = fem::box(ranks, {1, 1, 1}, {0.5});
  for (const bool by_force : {true, false}) {
    Body<3> body(mesh, {1}, {{{"bottom", {0, 0, 0}}, {"top", {loose, loose, 1}}}, {}},
                 elastic(1e9, 0.3));
    for (const double full : {1., 0., 0.}) {
      body.step({by_force, full * (by_force ? 1e6 : 1e-3), 0}, 0);
      body.step({by_force, full * (by_force ? 1e6 : 1e-3), 0}, 10);
      EXPECT_NEAR(body.specimen.drive_displacement(), full * 1e-3, by_force ? 2e-4 : 1e-15);
      EXPECT_NEAR(body.specimen.drive_force(), full * 1e6, by_force ? 1e-5 : 2e5);
      if (full == 0) {
        EXPECT_LE(body.specimen.displacement().l2_norm(), 1e-12);
        EXPECT_NEAR(body.specimen.drive_force(), 0, 1e-5);
      }
    }
  }
}

} // namespace
