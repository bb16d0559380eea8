#include "fem/frequency.h"

#include "layers.h"
#include "tests/fem/tables.h"

using namespace fem;
using bodies::Body;
using bodies::ranks;

namespace {

constexpr std::optional<double> loose;
const std::vector<double> omegas{1e-4, 1e-2, 0.3, 1, 40, 1e4};

} // namespace

TEST(Frequency, BarOfAStandardSolidFollowsTheClosedForm)
{
  const double spring = 2e9, kelvin = 5e8, viscosity = 3e9;
  const CreepCompliance uniaxial{1 / spring, 0, {{viscosity / kelvin, 1 / kelvin}}};
  const std::vector<ComplianceLaw> laws{isotropic_law(uniaxial, 0.3)};
  const Mesh<3> mesh = box(ranks, {2, 1, 3}, {0.5});
  const Specimen<3> bar(mesh, {1},
                        {{{"bottom", {loose, loose, 0}}, {"top", {loose, loose, 1}}}, {}}, 1e-10);
  const std::vector<int> which(bar.elements().n_points(), 0);
  const auto found = drive_stiffness<3>(bar, laws, which, omegas, 1e-12);
  ASSERT_EQ(found.size(), omegas.size());
  for (const ComplexStiffness& each : found) {
    const std::complex<double> compliance =
        1 / spring + 1. / std::complex<double>(kelvin, each.omega * viscosity);
    const std::complex<double> exact = 2. / 3 / compliance;
    EXPECT_LE(std::abs(each.value - exact), 1e-9 * std::abs(exact)) << each.omega;
  }
}

TEST(Frequency, ProportionalLawScalesTheElasticStiffness)
{
  const Mat6 shape = compliance(tables::anisotropic_law(), 30);
  const RetardationTerm kelvin{20, 5. / 3 * shape};
  const std::vector<ComplianceLaw> laws{
      make_compliance_law(shape, shape / 200, std::span(&kelvin, 1))};
  for (const bool simplices : {false, true}) {
    const Mesh<3> mesh = cylinder(ranks, 0.1, 0.1, {0.05, 0, simplices});
    const BodyLoads loads{{{"bottom", {0, 0, 0}}, {"top", {0, 0, 1}}}, {}};
    Body<3> elastic(mesh, {1}, loads, make_compliance_law(shape, Mat6::Zero(), {}));
    elastic.step({false, 1, 0}, 0);
    const std::vector<int> which(elastic.points.size(), 0);
    for (const auto& each : drive_stiffness<3>(elastic.specimen, laws, which, omegas, 1e-10)) {
      const std::complex<double> creep = 1. + 1. / std::complex<double>(0, 200 * each.omega) +
                                         5. / 3 / std::complex<double>(1, 20 * each.omega);
      const std::complex<double> exact = elastic.specimen.drive_force() / creep;
      EXPECT_LE(std::abs(each.value - exact), 1e-8 * std::abs(exact)) << each.omega;
    }
  }
}

TEST(Frequency, LaminateShearsWithTheSumOfItsModuli)
{
  const double hard_shear = 2e9;
  const std::vector<ComplianceLaw> laws{bodies::elastic(2.5 * hard_shear, 0.25),
                                        bodies::burgers_in_shear()};
  for (const bool simplices : {false, true}) {
    const Mesh<3> mesh = bodies::layered_box(2, simplices);
    const Specimen<3> specimen(mesh, {1}, bodies::shear_along_layers(), 1e-10);
    const auto which = bodies::laws_by_region(specimen.elements());
    for (const auto& each : drive_stiffness<3>(specimen, laws, which, omegas, 1e-12)) {
      const std::complex<double> compliance = 1 / 100e6 +
                                              1. / std::complex<double>(0, each.omega * 2e10) +
                                              1. / std::complex<double>(60e6, each.omega * 1.2e9);
      const std::complex<double> exact = 0.4 * hard_shear + 0.6 / compliance;
      EXPECT_LE(std::abs(each.value - exact), 1e-9 * std::abs(exact)) << each.omega;
    }
  }
}

TEST(Frequency, NeedsABoundaryThatIsMoved)
{
  const Mesh<3> mesh = box(ranks, {1, 1, 1}, {1});
  const Specimen<3> held(mesh, {1}, {{{"bottom", {0, 0, 0}}}, {}}, 1e-10);
  const std::vector<ComplianceLaw> laws{bodies::burgers_in_shear()};
  const std::vector<int> which(held.elements().n_points(), 0);
  EXPECT_THROW(drive_stiffness<3>(held, laws, which, omegas, 1e-8), std::invalid_argument);
}
