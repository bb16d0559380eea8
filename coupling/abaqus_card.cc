#include "coupling/card_parts.h"

#include <fmt/format.h>

namespace coupling {

namespace {

constexpr const char* card_name = "mastic_abaqus.inp";

std::string shift_keyword(const fem::LawRecord& record)
{
  if (const auto* wlf = std::get_if<fem::WlfShift>(&record.shift))
    return fmt::format("*TRS, DEFINITION=WLF\n{}, {}, {}\n", digits(wlf->reference_temperature),
                       digits(wlf->c1), digits(wlf->c2));
  if (const auto* arrhenius = std::get_if<fem::ArrheniusShift>(&record.shift))
    return fmt::format("** The model needs *PHYSICAL CONSTANTS with absolute zero and the gas "
                       "constant, as the check deck has.\n*TRS, DEFINITION=ARRHENIUS\n{}, {}\n",
                       digits(arrhenius->reference_temperature),
                       digits(arrhenius->activation_energy));
  return {};
}

std::string card_text(const fem::LawRecord& record, const CardUnits& units, const PronyCard& card,
                      const std::string& limits)
{
  const YoungPoisson elastic = young_poisson(card.series.shear_modulus, card.series.bulk_modulus);
  std::string text = header(record, units, "**", "Creep law as an Abaqus material.", limits);
  text += fmt::format("*MATERIAL, NAME=MASTIC\n*ELASTIC, MODULI=INSTANTANEOUS\n{}, {}\n"
                      "*VISCOELASTIC, TIME=PRONY\n",
                      digits(elastic.young / units.stress), digits(elastic.poisson));
  for (const PronyTerm& term : card.series.terms)
    text += fmt::format("{}, {}, {}\n", digits(term.shear), digits(term.bulk), digits(term.time));
  return text + shift_keyword(record);
}

std::string deck_text(const fem::LawRecord& record, const CardUnits& units, const CreepCheck& check)
{
  const double force = check.stress / units.stress / 4; // on each of four nodes of a unit square
  std::string text = "*HEADING\nOne cube with edges of unit length, uniaxial creep along axis 1\n" +
                     header(record, units, "**", "Check of " + std::string(card_name) + ".", "") +
                     expected_table(check, "**");
  text += "*NODE, NSET=ALLNODES\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n"
          "5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n"
          "*ELEMENT, TYPE=C3D8, ELSET=CUBE\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
          "*NSET, NSET=LOADED\n2, 3, 6, 7\n"
          "*NSET, NSET=FACE1\n1, 4, 5, 8\n*NSET, NSET=FACE2\n1, 2, 5, 6\n"
          "*NSET, NSET=FACE3\n1, 2, 3, 4\n";
  text +=
      fmt::format("*INCLUDE, INPUT={}\n*SOLID SECTION, ELSET=CUBE, MATERIAL=MASTIC\n", card_name);
  if (std::holds_alternative<fem::ArrheniusShift>(record.shift))
    text += "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0, UNIVERSAL GAS=8.314462618\n";
  text += fmt::format("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALLNODES, {:.6f}\n"
                      "*BOUNDARY\nFACE1, 1, 1\nFACE2, 2, 2\nFACE3, 3, 3\n"
                      "** Instantaneous answer.\n*STEP\n*STATIC\n{}, {}\n*CLOAD\nLOADED, 1, {}\n"
                      "*END STEP\n",
                      record.reference_temperature, digits(1e-6 * check.times.front()),
                      digits(1e-6 * check.times.front()), digits(force));
  double from = 0;
  for (const double until : check.times) {
    text +=
        fmt::format("** Until t = {:g} s.\n*STEP, INC=100000\n*VISCO, CETOL=1.0e-6\n"
                    "{}, {}, {}, {}\n*CLOAD\nLOADED, 1, {}\n"
                    "*NODE PRINT, NSET=LOADED, FREQUENCY=100000\nU\n*END STEP\n",
                    until, digits(1e-3 * (until - from)), digits(until - from),
                    digits(1e-9 * (until - from)), digits(0.05 * (until - from)), digits(force));
    from = until;
  }
  return text;
}

} // namespace

MaterialCard abaqus_card(const fem::LawRecord& record, const CardUnits& units)
{
  const PronyCard prony = prony_card(record);
  const bool carried = !std::holds_alternative<fem::FreeShift>(record.shift);
  const std::string limits = prony.limits + shift_note(record, carried);
  const CreepCheck check = creep_check(record, prony.represented);
  return {{{card_name, card_text(record, units, prony, limits)},
           {"mastic_abaqus_check.inp", deck_text(record, units, check)}},
          prony.represented,
          prony.creep_error,
          limits};
}

} // namespace coupling
