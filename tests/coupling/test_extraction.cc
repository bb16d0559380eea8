#include "coupling/calibration.h"
#include "coupling/extraction.h"
#include "dem/crystals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace {

constexpr double diameter = 4e-3;

dem::BondLaw bond(const dem::CreepLaw& law)
{
  return {law, 11, 1};
}

/// Two Kelvin branches and a dashpot.
dem::CreepLaw binder()
{
  const std::vector<dem::KelvinBranch> branches{{5e5, 5e5}, {2e5, 8e6}};
  return dem::make_creep_law(1e6, 4e8, branches);
}

/// Spheres of two classes in turn along x, y and z: springs between unlike ones, binder between
/// like ones does not occur; both classes of a chain in series.
dem::VolumeElement two_law_element()
{
  const double d = diameter;
  dem::Particles particles;
  particles.centre = {dem::Vec3::Zero(), dem::Vec3(d, 0, 0)};
  particles.radius = {d / 2, d / 2};
  particles.material_class = {0, 1};
  const dem::PeriodicCell cell = dem::box_cell(dem::Vec3(2 * d, d, d));
  const std::vector<dem::BondLaw> laws{bond(binder()), bond(dem::make_creep_law(3e6, {}, {}))};
  return dem::make_volume_element(cell, particles,
                                  dem::periodic_contacts_within(cell, particles, 1e-6), laws,
                                  {{0, 0, 0}, {0, 1, 0}, {1, 1, 1}});
}

} // namespace

TEST(Extraction, ProportionalLawIsThatOfTheBondsAtAllTimes)
{
  const dem::VolumeElement element =
      dem::bonded_crystal(dem::face_centred_cubic(diameter), diameter, bond(binder()));
  const fem::Mat6 elastic = dem::compliance(dem::homogenize(element).stiffness);
  const fem::ComplianceLaw law = coupling::proportional_law(elastic, binder());
  EXPECT_EQ(law.terms.size(), 2u);
  for (const double t : {0.0, 1e-3, 0.7, 20.0, 1e4, 1e9}) {
    const fem::Mat6 exact = dem::creep_compliance(element, elastic, t);
    EXPECT_LT((fem::compliance(law, t) - exact).norm(), 1e-14 * exact.norm()) << t;
  }
  for (const double omega : {1e-6, 0.3, 1e5}) {
    const auto exact = dem::complex_compliance(element, elastic, omega);
    EXPECT_LT((fem::complex_compliance(law, omega) - exact).norm(), 1e-13 * exact.norm()) << omega;
  }
}

TEST(Extraction, SampledLawOfSeveralBondLawsFindsTheClosedForm)
{
  // Along x only bonds between unlike spheres carry, all of binder; along y binder and stone side
  // by side: 1 / S is not the compliance of either.
  const dem::VolumeElement element = two_law_element();
  const coupling::SamplingOptions options{1e-2, 1e3, 31, 1e-8, 21};
  const coupling::MeanCompliance samples = coupling::sampled_compliance(element, options);
  const double d = diameter;
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    const double along_x = d * dem::creep_compliance(binder(), samples.time[k]);
    EXPECT_NEAR(samples.compliance[k](0, 0) / along_x, 1, 1e-7) << samples.time[k];
  }
  EXPECT_LE(samples.stepping_error, 1e-8);
  const coupling::ExtractedLaw law = coupling::fitted_law(samples, options);
  EXPECT_FALSE(law.is_exact);
  EXPECT_LT(law.optimality_gap, 1e-10);
  EXPECT_LT(law.largest_error,
            5e-3); // of a grid of four times per decade that misses the true ones
  for (std::size_t k = 0; k < samples.time.size(); ++k)
    EXPECT_LE((fem::compliance(law.law, samples.time[k]) - samples.compliance[k]).norm(),
              1.0001 * law.largest_error * samples.compliance[k].norm());
  coupling::SamplingOptions finer = options;
  finer.n_terms = 51;
  EXPECT_LT(coupling::fitted_law(samples, finer).largest_error, 0.3 * law.largest_error);
}

TEST(Extraction, TimeAndFrequencyRoutesAgree)
{
  const dem::VolumeElement element = two_law_element();
  const coupling::SamplingOptions options{1e-3, 1e4, 43, 1e-9, 0};
  const coupling::ExtractedLaw law =
      coupling::fitted_law(coupling::sampled_compliance(element, options), options);
  EXPECT_LT(law.relative_rms, 2 * coupling::sufficient_error);
  const std::vector<double> omega{1e-2, 0.1, 1, 10};
  const auto direct = coupling::complex_compliances(element, omega);
  for (std::size_t k = 0; k < omega.size(); ++k) { // along x: binder only
    const std::complex<double> exact = diameter * dem::complex_compliance(binder(), omega[k]);
    EXPECT_LT(std::abs(direct[k](0, 0) - exact), 1e-8 * std::abs(exact));
  }
  EXPECT_LT(coupling::frequency_difference(law.law, omega, direct), 1e-2);
}

TEST(Extraction, RefusesTimesThatAreNone)
{
  const dem::VolumeElement element = two_law_element();
  EXPECT_THROW(coupling::sampled_compliance(element, {1, 1, 5, 1e-3, 0}), std::invalid_argument);
  EXPECT_THROW(coupling::sampled_compliance(element, {0, 1, 5, 1e-3, 0}), std::invalid_argument);
}

TEST(Calibration, GivesTheMeasuredCurveBack)
{
  const fem::CreepCompliance measured{2e-10, 3e-13, {{0.4, 5e-10}, {30, 2e-9}}};
  const double factor = coupling::geometry_factor(7e-9, dem::make_creep_law(2e6, {}, {}));
  EXPECT_DOUBLE_EQ(factor, 0.014);
  const dem::CreepLaw law = coupling::calibrated_law(measured, factor);
  for (const double t : {0.0, 0.1, 3.0, 1e3})
    EXPECT_NEAR(factor * dem::creep_compliance(law, t) / fem::value(measured, t), 1, 1e-14);
  EXPECT_THROW(coupling::calibrated_law(measured, 0), std::invalid_argument);
}
