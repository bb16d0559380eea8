#include "bodies.h"
#include "fem/march.h"
#include "fem/probes.h"
#include "tests/reference.h"

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;
constexpr double inner = 1, outer = 2, pressure = 1e6;

/// Inner pressure, no strain along the axis.
const BodyLoads plane_strain{{{"bottom", {loose, loose, 0}}, {"top", {loose, loose, 0}}},
                             {{"inner", Vec3::Zero(), pressure}}};

Mesh<2> section(double cell_size, bool simplices = false)
{
  return meridian(ranks, 2 * outer, 2 * inner, cell_size, {cell_size, 0, simplices});
}

Mesh<3> solid(double cell_size, bool simplices = false)
{
  return hollow_cylinder(ranks, 2 * outer, 2 * inner, cell_size, {cell_size, 0, simplices});
}

/// u_r = linear r + inverse / r.
template <int dim>
bodies::Field<dim> radial(double linear, double inverse)
{
  return [=](const dealii::Point<dim>& p) {
    dealii::Tensor<1, dim> u;
    const double r = dim == 2 ? p[0] : std::hypot(p[0], p[1]);
    for (unsigned k = 0; k < (dim == 2 ? 1 : 2); ++k)
      u[k] = p[k] * (linear + inverse / (r * r));
    return u;
  };
}

/// The field through two values, at the inner and the outer radius.
template <int dim>
bodies::Field<dim> through(double at_inner, double at_outer)
{
  const double inverse = (at_inner * outer - at_outer * inner) / (outer / inner - inner / outer);
  return radial<dim>(at_inner / inner - inverse / (inner * inner), inverse);
}

/// Rows of thick_cylinder.csv at a time.
std::vector<reference::Row> cylinder_rows(double t)
{
  std::vector<reference::Row> rows;
  for (const auto& row : reference::table("thick_cylinder.csv"))
    if (reference::number(row, "t") == t)
      rows.push_back(row);
  return rows;
}

template <int dim>
bodies::Field<dim> cylinder_field(double t)
{
  const auto rows = cylinder_rows(t);
  return through<dim>(reference::number(rows.at(0), "u_r"), reference::number(rows.at(2), "u_r"));
}

/// Steps of one size from the jump at 0 to a time.
template <int dim>
void creep(Body<dim>& body, double end, int n_steps)
{
  body.step({true, 0, 1}, 0);
  for (int k = 0; k < n_steps; ++k)
    body.step({true, 0, 1}, end / n_steps);
}

/// Errors of a body of one law just loaded on meshes of halved cells.
template <int dim>
std::vector<double> elastic_errors(const std::function<Mesh<dim>(double)>& mesh,
                                   const Discretisation& discretisation, const ComplianceLaw& law,
                                   const bodies::Field<dim>& exact, std::vector<double> cell_sizes)
{
  std::vector<double> errors;
  for (const double h : cell_sizes) {
    Body<dim> body(mesh(h), discretisation, plane_strain, law, TimeScheme::stress_linear, 1e-11);
    creep(body, 0, 0);
    errors.push_back(body.l2_error(exact));
  }
  return errors;
}

template <int dim>
std::vector<double> errors_at(double t, int n_steps, int order, TimeScheme scheme,
                              const std::function<Mesh<dim>(double)>& mesh,
                              std::vector<double> cell_sizes)
{
  std::vector<double> errors;
  for (const double h : cell_sizes) {
    Body<dim> body(mesh(h), {order}, plane_strain, bodies::burgers_in_shear(), scheme, 1e-11);
    creep(body, t, n_steps);
    errors.push_back(body.l2_error(cylinder_field<dim>(t)));
  }
  return errors;
}

/// Displacement of the incompressible-limit table.
template <int dim>
bodies::Field<dim> limit_field(double poisson)
{
  for (const auto& row : reference::table("cylinder_incompressible_limit.csv"))
    if (reference::number(row, "nu") == poisson)
      return through<dim>(reference::number(row, "u_r_inner"), reference::number(row, "u_r_outer"));
  throw std::runtime_error("no such row");
}

struct Limit {
  double error;
  int n_iterations;
};

template <int dim>
Limit limit(const Mesh<dim>& mesh, int order, Dilatation dilatation, double poisson)
{
  Body<dim> body(mesh, {order, dilatation}, plane_strain, bodies::elastic(1e9, poisson),
                 TimeScheme::stress_linear, 1e-10);
  creep(body, 0, 0);
  return {body.l2_error(limit_field<dim>(poisson)), body.reports.back().n_iterations};
}

} // namespace

TEST(ThickCylinder, MarchFollowsTheTableAtAllTimes)
{
  Specimen<2> specimen(section(0.25), {3}, plane_strain, 1e-12);
  const ComplianceLaw law = bodies::burgers_in_shear();
  LawPoints points(std::span(&law, 1), std::vector<int>(specimen.elements().n_points(), 0),
                   TimeScheme::stress_linear);
  const Probes<2> probes(specimen, {{inner, 0, 0.1}, {0, 1.5, 0.1}, {outer, 0, 0.1}});
  const auto loads = [](double) { return LoadState{true, 0, 1}; };
  const History history{loads, loads, [](double t) { return t; }};
  const StepSettings settings{1e-7, 1e-3, 3};
  MarchState state;
  apply_jump(specimen, points, state, history);
  for (const double t : {0., 0.2, 2., 10., 20., 40., 100., 200., 1000., 2000., 20000.}) {
    while (state.time < t)
      march_step(specimen, points, state, history, settings, t);
    const auto rows = cylinder_rows(t);
    ASSERT_EQ(rows.size(), 3U);
    const auto readings = probes.read(specimen, points);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto number = [&](const char* name) { return reference::number(rows[k], name); };
      EXPECT_NEAR(readings[k].displacement[0] / number("u_r"), 1, 2e-7) << t;
      EXPECT_NEAR(readings[k].displacement[2], 0, 1e-12);
      EXPECT_NEAR(readings[k].stress[0], number("sigma_rr"), 2e-3 * pressure) << t;
      EXPECT_NEAR(readings[k].stress[1], number("sigma_tt"), 2e-3 * pressure) << t;
      EXPECT_NEAR(readings[k].stress[2], number("sigma_zz"), 2e-3 * pressure) << t;
    }
  }
}

TEST(ThickCylinder, SectionConvergesWithOrderPPlusOne)
{
  for (const int order : {1, 2, 3}) {
    const auto errors =
        elastic_errors<2>([](double h) { return section(h); }, {order}, bodies::burgers_in_shear(),
                          cylinder_field<2>(0), {0.25, 0.125, 0.0625});
    EXPECT_NEAR(bodies::last_order(errors), order + 1, 0.15) << order;
  }
  for (const int order : {1, 2}) {
    const auto errors =
        elastic_errors<2>([](double h) { return section(h, true); }, {order},
                          bodies::burgers_in_shear(), cylinder_field<2>(0), {0.25, 0.125, 0.0625});
    EXPECT_GT(bodies::last_order(errors), order + 1 - 0.15) << order;
  }
}

TEST(ThickCylinder, SolidConvergesWithOrderPPlusOne)
{
  for (const bool simplices : {false, true})
    for (const int order : {1, 2}) {
      std::vector<double> sizes{0.5, 0.25, 0.125};
      if (order == 2)
        sizes = {1, 0.5, 0.25};
      const auto errors =
          elastic_errors<3>([=](double h) { return solid(h, simplices); }, {order},
                            bodies::burgers_in_shear(), cylinder_field<3>(0), sizes);
      EXPECT_GT(bodies::last_order(errors), order + 1 - 0.15) << order;
    }
}

TEST(ThickCylinder, SpaceConvergesAtLateTimesToo)
{
  for (const int order : {1, 2, 3}) {
    const auto errors = errors_at<2>(200, 200, order, TimeScheme::stress_linear,
                                     [](double h) { return section(h); }, {0.5, 0.25});
    EXPECT_GT(bodies::last_order(errors), order + 1 - 0.25) << order;
  }
}

TEST(ThickCylinder, TimeConvergesWithSecondOrder)
{
  for (const TimeScheme scheme : {TimeScheme::stress_linear, TimeScheme::strain_linear}) {
    std::vector<double> errors;
    for (const int n : {8, 16, 32})
      errors.push_back(
          errors_at<2>(20, n, 3, scheme, [](double) { return section(0.0625); }, {0}).at(0));
    EXPECT_NEAR(bodies::last_order(errors), 2, 0.1);
    EXPECT_LT(errors.back(), 1e-3);
  }
}

TEST(ThickCylinder, NearlyIncompressibleIsAsGoodAsCompressible)
{
  // a multigrid that knows no pressure takes more iterations where it does not solve directly
  const auto check = [](const auto& mesh, int order, const char* name, double most_error,
                        int most_iterations) {
    const Limit easy = limit(mesh, order, Dilatation::projected, 0.3);
    const Limit hard = limit(mesh, order, Dilatation::projected, 0.4999);
    EXPECT_LE(hard.error, most_error * easy.error) << name << order;
    EXPECT_LE(hard.n_iterations, most_iterations * easy.n_iterations) << name << order;
  };
  for (const int order : {1, 2, 3})
    check(section(0.125), order, "section", 2, 3);
  check(section(0.125, true), 2, "triangles", 2, 3);
  check(solid(0.25), 1, "solid", 2, 25);
  check(solid(0.25), 2, "solid", 2, 45);
  check(solid(0.5, true), 2, "tetrahedra", 2.5, 60); // their dilatation is of one degree less
}

TEST(ThickCylinder, PointwiseDilatationLocks)
{
  EXPECT_GT(limit(solid(0.25), 1, Dilatation::pointwise, 0.4999).error, 0.5);
  EXPECT_LT(limit(solid(0.25), 1, Dilatation::projected, 0.4999).error, 0.01);
}
