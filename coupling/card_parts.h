#pragma once
#include "coupling/isotropic_relaxation.h"
#include "coupling/material_cards.h"

/// What the writers of the formats share.
namespace coupling {

/// Uniaxial creep of a cube: the answer that the deck of a card must give.
struct CreepCheck {
  double stress;                  ///< along axis 1, at once at t = 0 and kept [Pa]
  std::vector<double> times;      ///< of the answer, rising [s]
  std::vector<double> axial;      ///< strain along axis 1 of the card's law [-]
  std::vector<double> lateral;    ///< strain along axis 2 of the card's law [-]
  std::vector<double> law_strain; ///< strain along axis 1 of the law that was given [-]
};

/// Times over which the errors of a card are stated: those in which the law was seen, or from a
/// hundredth of the shortest to ten times the longest time of the law where nothing was noted [s].
std::pair<double, double> valid_times(const fem::LawRecord& record);

/// Times in equal ratios from the first to the last.
std::vector<double> times_between(std::pair<double, double> range, int count);

/// Creep at 100 kPa until the end of the valid times, answers at seven times.
CreepCheck creep_check(const fem::LawRecord& record, const fem::ComplianceLaw& represented);

/// Largest relative error of D(t) at 200 times in a range, along the three axes and the diagonals
/// of faces and body [-].
double creep_error(const fem::ComplianceLaw& found, const fem::ComplianceLaw& exact,
                   std::pair<double, double> range);

/// Twelve digits, as all programs read them: "1.234567890123e-05".
std::string digits(double value);

/// Young's modulus and Poisson's ratio of moduli in shear and bulk.
struct YoungPoisson {
  double young, poisson;
};
YoungPoisson young_poisson(double shear_modulus, double bulk_modulus);

/// Lines that begin with the comment sign: what the file is, units, temperature, limits, source.
std::string header(const fem::LawRecord& record, const CardUnits& units, const std::string& comment,
                   const std::string& what, const std::string& limits);

/// The answers of a check as comment lines.
std::string expected_table(const CreepCheck& check, const std::string& comment);

/// What the nearest isotropic law costs, and what a bulk modulus that does not relax would.
std::string isotropy_note(const fem::LawRecord& record);

/// What becomes of the temperature shift: empty if there is none, or if it is carried.
std::string shift_note(const fem::LawRecord& record, bool carried);

/// Card of a format; each in a file of its own.
MaterialCard abaqus_card(const fem::LawRecord& record, const CardUnits& units);
MaterialCard ansys_card(const fem::LawRecord& record, const CardUnits& units);
MaterialCard ls_dyna_card(const fem::LawRecord& record, const CardUnits& units);
MaterialCard mfront_card(const fem::LawRecord& record, const CardUnits& units);
MaterialCard moose_card(const fem::LawRecord& record, const CardUnits& units);
MaterialCard law_tables(const fem::LawRecord& record, const CardUnits& units);

/// The Prony series of the nearest isotropic law, the law that it makes, and the note about it.
struct PronyCard {
  PronySeries series;
  fem::ComplianceLaw represented;
  double creep_error;
  std::string limits;
};
PronyCard prony_card(const fem::LawRecord& record);

} // namespace coupling
