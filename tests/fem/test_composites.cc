#include "fem/march.h"
#include "fem/probes.h"
#include "layers.h"
#include "tests/reference.h"

#include <deal.II/grid/manifold_lib.h>

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;

/// A quarter of the meridian of a sphere of radius 1 with a core (region 0) of 40 % of its volume
/// in a coating (region 1).
Mesh<2> coated_sphere(int n_refinements)
{
  const double core = std::cbrt(0.4);
  dealii::Triangulation<2> ball, shell, whole;
  dealii::GridGenerator::quarter_hyper_ball(ball, {}, core);
  dealii::GridGenerator::quarter_hyper_shell(shell, {}, core, 1., 2);
  for (const auto& cell : shell.active_cell_iterators())
    cell->set_material_id(1);
  dealii::GridGenerator::merge_triangulations(ball, shell, whole, 1e-10);
  for (const auto& cell : whole.active_cell_iterators())
    if (cell->material_id() == 1)
      cell->set_all_manifold_ids(0);
  whole.set_manifold(0, dealii::SphericalManifold<2>());
  for (const auto& face : whole.active_face_iterators())
    if (face->at_boundary()) {
      const auto middle = face->center();
      face->set_boundary_id(middle[0] < 1e-9 ? 0 : middle[1] < 1e-9 ? 1 : 2);
    }
  return distributed<2>(ranks, whole, {0, n_refinements},
                        {{"axis", 0}, {"bottom", 1}, {"side", 2}});
}

/// Displacement of a hollow sphere of the radii 1 and 2 under inner pressure.
bodies::Field<3> hollow_sphere_field(double pressure, double bulk, double shear_compliance)
{
  return [=](const dealii::Point<3>& p) {
    const double r = p.norm();
    return dealii::Tensor<1, 3>(pressure / 7 *
                                (1 / (3 * bulk) + 8 * shear_compliance / (4 * r * r * r)) * p);
  };
}

/// Shear compliance and modulus of the tables at a time.
double shear_compliance(const reference::Row& bar)
{
  return 2 * (reference::number(bar, "axial_strain_per_stress") -
              reference::number(bar, "lateral_strain_per_stress"));
}

double shear_modulus(const reference::Row& oedometer)
{
  return (reference::number(oedometer, "axial_stress_per_strain") -
          reference::number(oedometer, "lateral_stress_per_strain")) /
         2;
}

const double hard_shear = 2e9;

ComplianceLaw hard_layer()
{
  return bodies::elastic(2 * 1.25 * hard_shear, 0.25);
}

/// Mean over a body of a field of its points.
template <int dim>
Vec6 mean(const Elements<dim>& elements, std::span<const Vec6> field)
{
  Vec6 sum = Vec6::Zero();
  for (std::size_t q = 0; q < field.size(); ++q)
    sum += elements.weights()[q] * field[q];
  std::vector<double> numbers(sum.data(), sum.data() + 6);
  dealii::Utilities::MPI::sum(numbers, elements.ranks(), numbers);
  return Eigen::Map<const Vec6>(numbers.data()) / elements.volume();
}

} // namespace

TEST(HollowSphere, ConvergesToTheClosedFormEarlyAndLate)
{
  const BodyLoads loads{
      {{"left", {0, loose, loose}}, {"front", {loose, 0, loose}}, {"bottom", {loose, loose, 0}}},
      {{"inner", Vec3::Zero(), 1e6}}};
  const auto bar = reference::table("bar_uniaxial_creep.csv");
  for (const int order : {1, 2}) {
    std::vector<double> early, late;
    for (const double h : {0.5, 0.25, 0.125}) {
      if (order == 2 && h < 0.2)
        continue;
      Body<3> body(hollow_sphere(ranks, 4, 2, {h}), {order}, loads, bodies::burgers_in_shear(),
                   TimeScheme::stress_linear, 1e-9);
      body.step({true, 0, 1}, 0);
      early.push_back(body.l2_error(hollow_sphere_field(1e6, 400e6, shear_compliance(bar[0]))));
      body.step({true, 0, 1}, 20);
      body.step({true, 0, 1}, 1980);
      late.push_back(body.l2_error(hollow_sphere_field(1e6, 400e6, shear_compliance(bar[9]))));
    }
    EXPECT_GT(bodies::last_order(early), order + 1 - 0.25) << order;
    EXPECT_GT(bodies::last_order(late), order + 1 - 0.25) << order;
    EXPECT_LT(late.back(), 0.004);
  }
}

TEST(CoatedSphere, SwellsAsHashinSaysAtAllTimes)
{
  const BodyLoads loads{{{"bottom", {loose, loose, 0}}}, {{"side", Vec3::Zero(), -1e6}}};
  const double young = 9 * 30e9 * 20e9 / (3 * 30e9 + 20e9);
  const std::vector<ComplianceLaw> laws{bodies::elastic(young, young / 40e9 - 1),
                                        bodies::burgers_in_shear()};
  const History history{[](double) {
                          return LoadState{true, 0, 1};
                        },
                        [](double) {
                          return LoadState{true, 0, 1};
                        },
                        [](double t) { return t; }};
  for (const TimeScheme scheme : {TimeScheme::stress_linear, TimeScheme::strain_linear}) {
    Body<2> body(coated_sphere(2), {3}, loads, laws, scheme);
    const Probes<2> probes(body.specimen, {{0, 0, 1}, {1, 0, 0}});
    MarchState state;
    apply_jump(body.specimen, body.points, state, history);
    for (const auto& row : reference::table("coated_sphere_bulk.csv")) {
      const double t = reference::number(row, "t");
      while (state.time < t)
        march_step(body.specimen, body.points, state, history, {3e-6, 1e-2, 3}, t);
      const double exact = 1e6 * reference::number(row, "bulk_creep_compliance") / 3;
      const auto readings = probes.read(body.specimen, body.points);
      EXPECT_NEAR(readings[0].displacement[2] / exact, 1, 2e-5) << t;
      EXPECT_NEAR(readings[1].displacement[0] / exact, 1, 2e-5) << t;
    }
  }
}

TEST(Laminate, ShearAcrossTheLayersAddsTheirCompliances)
{
  const double stress = 1e6;
  const BodyLoads loads{{},
                        {{"top", Vec3(0, stress, 0)},
                         {"bottom", Vec3(0, -stress, 0)},
                         {"back", Vec3(0, 0, stress)},
                         {"front", Vec3(0, 0, -stress)}}};
  for (const bool simplices : {false, true})
    for (const int order : {1, 2}) {
      Body<3> body(bodies::layered_box(2, simplices), {order}, loads,
                   {hard_layer(), bodies::burgers_in_shear()}, TimeScheme::stress_linear, 1e-11);
      EXPECT_EQ(body.specimen.supports().n_pins, 6);
      double t = 0;
      for (const auto& row : reference::table("bar_uniaxial_creep.csv")) {
        const double end = reference::number(row, "t");
        body.step({true, 0, 1}, end - t);
        t = end;
        const double exact = stress * (0.4 / hard_shear + 0.6 * shear_compliance(row));
        const Vec6 strain = mean<3>(body.specimen.elements(), body.points.strain());
        EXPECT_NEAR(std::sqrt(2) * strain[3] / exact, 1, 1e-10) << t;
        for (const Vec6& each : body.points.stress())
          EXPECT_NEAR(each[3] / std::sqrt(2), stress, 1e-9 * stress);
      }
    }
}

TEST(Laminate, ShearAlongTheLayersAddsTheirModuli)
{
  for (const bool simplices : {false, true}) {
    Body<3> body(bodies::layered_box(2, simplices), {1}, bodies::shear_along_layers(),
                 {hard_layer(), bodies::burgers_in_shear()}, TimeScheme::strain_linear);
    double t = 0;
    for (const auto& row : reference::table("oedometer_relaxation.csv")) {
      const double end = reference::number(row, "t");
      body.step({false, 1e-3, 0}, end - t);
      t = end;
      const double exact = 1e-3 * (0.4 * hard_shear + 0.6 * shear_modulus(row));
      EXPECT_NEAR(body.specimen.drive_force() / exact, 1, 1e-10) << t;
    }
  }
}
