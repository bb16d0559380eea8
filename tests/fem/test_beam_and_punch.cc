#include "bodies.h"
#include "fem/cell_states.h"
#include "fem/mesh_parts.h"
#include "fem/probes.h"
#include "fem/refinement.h"
#include "tests/reference.h"

#include <deal.II/grid/grid_generator.h>

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;

/// 100 N on the free end of a beam of 1 m x 0.1 m x 0.1 m.
const BodyLoads tip_load{{{"left", {0, 0, 0}}}, {{"right", Vec3(0, 0, 1e4)}}};

/// Section of a body of a radius and height that are many radii of the punch on its top, with cells
/// that grow away from the punch.
Mesh<2> half_space(double punch, double size)
{
  std::vector<double> outward{punch / 2, punch / 2}, downward;
  for (double at = punch, step = punch / 2; at < size * (1 - 1e-9); at += step) {
    step = std::min(1.6 * step, size - at);
    if (size - at - step < step)
      step = size - at;
    outward.push_back(step);
  }
  downward.assign(outward.rbegin(), outward.rend());
  dealii::Triangulation<2> whole;
  dealii::GridGenerator::subdivided_hyper_rectangle(whole, {outward, downward}, dealii::Point<2>(),
                                                    dealii::Point<2>(size, size), true);
  for (const auto& face : whole.active_face_iterators())
    if (face->at_boundary() && face->boundary_id() == 3 && face->center()[0] < punch)
      face->set_boundary_id(4);
  return distributed<2>(ranks, whole, {0},
                        {{"axis", 0}, {"side", 1}, {"bottom", 2}, {"top", 3}, {"punch", 4}});
}

/// Depth of a flat punch over time, on a mesh refined where the displacement bends.
std::vector<double> punch_depths(double size_over_radius, int n_refinements, double force,
                                 std::span<const double> times)
{
  const double radius = 5e-3;
  const BodyLoads loads{{{"punch", {loose, loose, 1}}, {"bottom", {loose, loose, 0}}}, {}};
  const Mesh<2> mesh = half_space(radius, size_over_radius * radius);
  const ComplianceLaw law = bodies::proportional_burgers();
  for (int k = 0; k < n_refinements; ++k) {
    Body<2> body(mesh, {2}, loads, law);
    body.step({true, -force, 0}, 0);
    refine(mesh, body.specimen, body.points, 0.15);
  }
  Body<2> body(mesh, {2}, loads, law);
  std::vector<double> depths;
  double t = 0;
  for (const double end : times) {
    body.step({true, -force, 0}, end - t);
    t = end;
    depths.push_back(-body.specimen.drive_displacement());
  }
  return depths;
}

} // namespace

TEST(Cantilever, CreepsInProportionAsTheTable)
{
  const auto table = reference::table("cantilever_beam.csv");
  Body<3> body(box(ranks, {1, 0.1, 0.1}, {0.1}), {2}, tip_load, bodies::proportional_burgers());
  const Probes<3> tip(body.specimen, {{1, 0.05, 0.05}});
  double t = 0, first = 0;
  for (const auto& row : table) {
    const double end = reference::number(row, "t");
    body.step({true, 0, 1}, end - t);
    t = end;
    const double w = tip.read(body.specimen, body.points)[0].displacement[2];
    if (t == 0)
      first = w;
    const double ratio =
        reference::number(row, "tip_timoshenko") / reference::number(table[0], "tip_timoshenko");
    EXPECT_NEAR(w / first / ratio, 1, 1e-9) << t;
    EXPECT_NEAR(w / reference::number(row, "tip_timoshenko"), 1, 0.01) << t;
  }
}

TEST(Cantilever, BendsAsABeamWhereTheClampDoesNotHinderContraction)
{
  const double young = 200e6, force = 100, area = 0.01, inertia = 1e-4 / 12;
  const double beam = force / (3 * young * inertia) + force / (5. / 6 * young / 2 * area);
  Body<3> body(box(ranks, {1, 0.1, 0.1}, {0.05}), {2}, tip_load, bodies::elastic(young, 0));
  body.step({true, 0, 1}, 0);
  const Probes<3> tip(body.specimen, {{1, 0.05, 0.05}});
  EXPECT_NEAR(tip.read(body.specimen, body.points)[0].displacement[2] / beam, 1, 1e-3);
}

TEST(FlatPunch, SinksInProportionAndAsDeepAsOnAHalfSpace)
{
  std::vector<double> times, exact;
  for (const auto& row : reference::table("indentation.csv")) {
    times.push_back(reference::number(row, "t"));
    exact.push_back(reference::number(row, "flat_punch_depth"));
  }
  const std::vector<double> smaller = punch_depths(50, 5, 10, std::span(times).first(1));
  const std::vector<double> larger = punch_depths(100, 5, 10, times);
  for (std::size_t k = 0; k < times.size(); ++k)
    EXPECT_NEAR(larger[k] / larger[0] / (exact[k] / exact[0]), 1, 1e-9) << times[k];
  // the missing rest of the half space makes a difference in proportion to punch over body
  const double extrapolated = 2 * larger[0] - smaller[0];
  EXPECT_NEAR(larger[0] / exact[0], 1, 0.02);
  EXPECT_NEAR(extrapolated / exact[0], 1, 2e-3);
}
