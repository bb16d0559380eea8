#include "tests/coupling/card_reading.h"

#include "fem/relaxation_law.h"
#include "fem/symmetry.h"

using namespace coupling;

namespace {

const std::vector<fem::LawRecord> records{
    cards::anisotropic_record(), cards::isotropic_record(true), cards::isotropic_record(false)};

} // namespace

TEST(IsotropicRelaxation, IsThatOfTheNearestIsotropicLaw)
{
  for (const fem::LawRecord& record : records) {
    const fem::ComplianceLaw nearest = fem::nearest(record.law, fem::Symmetry{});
    const fem::RelaxationLaw tensor = fem::relaxation_law(nearest);
    const IsotropicRelaxation found = isotropic_relaxation(isotropic_creep(record.law));
    const double shear = fem::value(found.shear, 0), bulk = fem::value(found.bulk, 0);
    for (double t = 1e-4; t < 1e5; t *= 1.3) {
      const fem::Mat6 stiffness = fem::stiffness(tensor, t);
      const double mean = stiffness.topLeftCorner<3, 3>().sum() / 9;
      EXPECT_NEAR(fem::value(found.shear, t), stiffness(3, 3) / 2, 1e-12 * shear) << t;
      EXPECT_NEAR(fem::value(found.bulk, t), mean, 1e-12 * bulk) << t;
    }
  }
}

TEST(IsotropicRelaxation, CoefficientsOfThePronySeriesSumToOne)
{
  for (const fem::LawRecord& record : records) {
    const IsotropicRelaxation exact = isotropic_relaxation(isotropic_creep(record.law));
    const PronySeries series = prony_series(exact, record.last_time);
    const IsotropicRelaxation again = isotropic_relaxation(series);
    double shear = again.shear.equilibrium / series.shear_modulus;
    double bulk = again.bulk.equilibrium / series.bulk_modulus;
    EXPECT_GT(shear, 0);
    EXPECT_GT(bulk, 0);
    for (const PronyTerm& term : series.terms) {
      shear += term.shear;
      bulk += term.bulk;
    }
    EXPECT_NEAR(shear, 1, 1e-14);
    EXPECT_NEAR(bulk, 1, 1e-14);
  }
}

TEST(IsotropicRelaxation, PronySeriesOfASolidIsExact)
{
  const fem::LawRecord record = cards::isotropic_record(true);
  const IsotropicRelaxation exact = isotropic_relaxation(isotropic_creep(record.law));
  const IsotropicRelaxation found = isotropic_relaxation(prony_series(exact, record.last_time));
  for (double t = 1e-4; t < 1e6; t *= 1.3) {
    EXPECT_NEAR(fem::value(found.shear, t), fem::value(exact.shear, t),
                1e-12 * fem::value(exact.shear, 0));
    EXPECT_NEAR(fem::value(found.bulk, t), fem::value(exact.bulk, t),
                1e-12 * fem::value(exact.bulk, 0));
  }
  EXPECT_LT(cards::creep_difference(found, record.law), 1e-12);
}

TEST(IsotropicRelaxation, ResidualModulusOfAFluidCostsLittleUntilTheEnd)
{
  const fem::LawRecord record = cards::isotropic_record(false);
  const IsotropicRelaxation exact = isotropic_relaxation(isotropic_creep(record.law));
  EXPECT_EQ(exact.shear.equilibrium, 0);
  const PronySeries series = prony_series(exact, record.last_time);
  EXPECT_LT(cards::creep_difference(isotropic_relaxation(series), record.law), 1.1e-4);
}

TEST(IsotropicRelaxation, HoldsForThirteenDecadesAndStrongFlow)
{
  IsotropicCreep creep{{1e-10, 1e-11, {}}, {5e-11, 0, {}}};
  for (int k = -6; k <= 6; ++k) {
    creep.shear.parts.push_back({std::pow(10.0, k), 1e-10 * std::pow(10.0, 0.4 * (k + 6))});
    creep.bulk.parts.push_back({std::pow(10.0, k), 2e-11 * std::pow(10.0, 0.1 * (k + 6))});
  }
  const PronySeries series = prony_series(isotropic_relaxation(creep), 1e7);
  const IsotropicCreep again = isotropic_creep(isotropic_relaxation(series));
  for (double t = 1e-6; t < 1e7; t *= 2)
    EXPECT_NEAR(fem::value(again.shear, t) / fem::value(creep.shear, t), 1, 1e-4) << t;
}

TEST(IsotropicRelaxation, ComesBackAsTheSameLaw)
{
  for (const fem::LawRecord& record : records) {
    const IsotropicCreep creep = isotropic_creep(record.law);
    const fem::ComplianceLaw law = compliance_law(creep);
    const fem::ComplianceLaw again = compliance_law(isotropic_creep(isotropic_relaxation(creep)));
    for (double t = 1e-4; t < 1e5; t *= 3)
      EXPECT_LT(tables::difference(fem::compliance(again, t), fem::compliance(law, t)), 1e-11);
  }
}
