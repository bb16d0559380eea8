#include "tests/coupling/card_reading.h"

using namespace coupling;

/// A finite-element program in miniature: one cube, the numbers of the card, steps in time.
namespace {

/// One modulus integrated as the manuals describe: strain changes evenly over a step.
struct Branches {
  fem::RelaxationModulus modulus;
  std::vector<double> stress = std::vector<double>(modulus.parts.size(), 0.0);
  double strain = 0;

  /// Strain increment that brings the stress to a target, applied.
  void step(double target, double dt)
  {
    double rest = modulus.equilibrium * strain, stiffness = modulus.equilibrium;
    for (std::size_t k = 0; k < stress.size(); ++k) {
      const double x = dt / modulus.parts[k].time;
      stress[k] *= std::exp(-x);
      rest += stress[k];
      stiffness -= modulus.parts[k].modulus * std::expm1(-x) / x;
    }
    const double increment = (target - rest) / stiffness;
    for (std::size_t k = 0; k < stress.size(); ++k) {
      const double x = dt / modulus.parts[k].time;
      stress[k] -= modulus.parts[k].modulus * std::expm1(-x) / x * increment;
    }
    strain += increment;
  }
};

} // namespace

TEST(CheckDecks, StepsWithTheNumbersOfTheCardGiveTheTable)
{
  for (const fem::LawRecord& record :
       {cards::isotropic_record(true), cards::isotropic_record(false),
        cards::anisotropic_record()}) {
    const MaterialCard card = material_card(record, CardFormat::abaqus, si_units());
    const IsotropicRelaxation read =
        cards::read_abaqus(cards::text_of(card.files, "mastic_abaqus.inp"), 1);
    Branches shear{read.shear}, bulk{read.bulk};
    const auto lines = cards::lines_of(cards::text_of(card.files, "mastic_abaqus_check.inp"));
    double t = 0;
    for (std::size_t i = cards::find(lines, "**         time_s") + 1; lines[i][0] == '*'; ++i) {
      if (lines[i].starts_with("*NODE"))
        break;
      const auto row = cards::numbers(lines[i].substr(2));
      const double dt = (row.at(0) - t) / 400;
      for (int step = 0; step < 400; ++step) {
        shear.step(1e5 / 3, dt); // shear strain per shear stress, of the deviator's axial part
        bulk.step(1e5 / 3, dt);
      }
      t = row.at(0);
      EXPECT_NEAR((shear.strain + bulk.strain / 3) / row.at(1), 1, 5e-4) << t;
      EXPECT_NEAR((-shear.strain / 2 + bulk.strain / 3) / row.at(2), 1, 5e-4) << t;
    }
    EXPECT_EQ(t, record.last_time);
  }
}
