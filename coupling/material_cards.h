#pragma once
#include "dem/bonds.h"
#include "fem/law_file.h"

#include <string>
#include <vector>

/// Laws as input of other programs. Each card comes with a deck of one cube under uniaxial creep
/// and the answer to expect, and says what its format cannot represent and what that costs.
namespace coupling {

/// Programs that a creep law can be written for.
enum class CardFormat { abaqus, ansys, ls_dyna, mfront, moose, tables };

/// A format and how a user names it.
struct NamedCardFormat {
  std::string name;
  CardFormat format;
  std::string program; ///< as its makers write it
};

/// All formats, by name.
std::vector<NamedCardFormat> card_formats();

/// Consistent units of a card; time is in s, force in N and temperature in K.
struct CardUnits {
  std::string name;  ///< "si" or "mm"
  std::string words; ///< for comments: "m, kg, s, N, Pa, K"
  double length;     ///< [m]
  double stress;     ///< [Pa]
  double density;    ///< [kg/m^3]
};

/// m, kg, s, N, Pa.
CardUnits si_units();

/// mm, t, s, N, MPa.
CardUnits millimetre_units();

/// A file to be written.
struct CardFile {
  std::string name, text;
};

/// A law for another program.
struct MaterialCard {
  std::vector<CardFile> files;    ///< card, check deck and note
  fem::ComplianceLaw represented; ///< what the numbers of the card say, before they are rounded
  double creep_error = 0; ///< largest relative error of D(t) of it in the range of validity, along
                          ///< edges, face and body diagonals of the material axes [-]
  std::string limits;     ///< what the format cannot represent and the error that this causes
};

/// The law as input of a program. Isotropic formats carry the nearest isotropic law; formats of
/// Prony series carry its exact relaxation form. The temperature shift is written where the format
/// has it; the note says so where not.
/// \throws std::invalid_argument for a law that does not creep, and for LS-DYNA if the relaxation
///         form has more than 18 terms
MaterialCard material_card(const fem::LawRecord& record, CardFormat format, const CardUnits& units);

/// A bond law as the contact model `burger` of PFC.
struct ContactCard {
  std::vector<CardFile> files;
  double creep_error = 0; ///< largest relative error of J(t) up to the given time [-]
  std::string limits;     ///< as in MaterialCard
};

/// \param friction   coefficient of the contact [-]
/// \param last_time  until when the law is used [s], > 0
/// \throws std::invalid_argument if the law has more than one Kelvin branch
ContactCard pfc_card(const dem::BondLaw& law, double friction, double last_time);

} // namespace coupling
