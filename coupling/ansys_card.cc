#include "coupling/card_parts.h"

#include <fmt/format.h>

namespace coupling {

namespace {

constexpr const char* card_name = "mastic_ansys.inp";

/// TB,PRONY of one modulus; two pairs a line.
std::string prony_table(const PronySeries& series, double PronyTerm::*part, const char* option)
{
  std::vector<std::pair<double, double>> pairs;
  for (const PronyTerm& term : series.terms)
    if (term.*part > 0)
      pairs.emplace_back(term.*part, term.time);
  if (pairs.empty())
    return {};
  std::string text = fmt::format("TB,PRONY,1,1,{},{}\n", pairs.size(), option);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    text += fmt::format("TBDATA,{},{},{}\n", 2 * i + 1, digits(pairs[i].first),
                        digits(pairs[i].second));
  return text;
}

std::string shift_table(const fem::LawRecord& record)
{
  if (const auto* wlf = std::get_if<fem::WlfShift>(&record.shift))
    return fmt::format("TB,SHIFT,1,1,3,WLF\nTBDATA,1,{},{},{}\n",
                       digits(wlf->reference_temperature), digits(wlf->c1), digits(wlf->c2));
  if (const auto* arrhenius = std::get_if<fem::ArrheniusShift>(&record.shift))
    return fmt::format("! Tool-Narayanaswamy: reference temperature, activation energy over gas "
                       "constant [K].\nTB,SHIFT,1,1,2,TN\nTBDATA,1,{},{}\n",
                       digits(arrhenius->reference_temperature),
                       digits(arrhenius->activation_energy / 8.314462618));
  return {};
}

std::string card_text(const fem::LawRecord& record, const CardUnits& units, const PronyCard& card,
                      const std::string& limits)
{
  const YoungPoisson elastic = young_poisson(card.series.shear_modulus, card.series.bulk_modulus);
  std::string text =
      header(record, units, "!", "Creep law as an Ansys Mechanical APDL material.", limits);
  text += fmt::format("! Material 1; to be read in /PREP7. The elastic constants are instantaneous."
                      "\nMP,EX,1,{}\nMP,PRXY,1,{}\n",
                      digits(elastic.young / units.stress), digits(elastic.poisson));
  return text + prony_table(card.series, &PronyTerm::shear, "SHEAR") +
         prony_table(card.series, &PronyTerm::bulk, "BULK") + shift_table(record);
}

std::string deck_text(const fem::LawRecord& record, const CardUnits& units, const CreepCheck& check)
{
  std::string text = header(record, units, "!", "Check of " + std::string(card_name) + ".", "") +
                     expected_table(check, "!");
  text += fmt::format("/PREP7\nET,1,SOLID185\n/INPUT,mastic_ansys,inp\n"
                      "N,1,0,0,0\nN,2,1,0,0\nN,3,1,1,0\nN,4,0,1,0\n"
                      "N,5,0,0,1\nN,6,1,0,1\nN,7,1,1,1\nN,8,0,1,1\nE,1,2,3,4,5,6,7,8\n"
                      "NSEL,S,LOC,X,0\nD,ALL,UX,0\nNSEL,S,LOC,Y,0\nD,ALL,UY,0\n"
                      "NSEL,S,LOC,Z,0\nD,ALL,UZ,0\nALLSEL\nTREF,{0:.6f}\nTUNIF,{0:.6f}\n"
                      "NSEL,S,LOC,X,1\nF,ALL,FX,{1}\nALLSEL\nFINISH\n",
                      record.reference_temperature, digits(check.stress / units.stress / 4));
  text += "/SOLU\nANTYPE,STATIC\nNLGEOM,OFF\nKBC,1\nOUTRES,ALL,LAST\n";
  for (const double until : check.times)
    text += fmt::format("TIME,{}\nNSUBST,200,100000,100\nSOLVE\n", digits(until));
  return text + "FINISH\n/POST26\nNSOL,2,2,U,X,STRAIN11\nNSOL,3,4,U,Y,STRAIN22\nPRVAR,2,3\n"
                "FINISH\n";
}

} // namespace

MaterialCard ansys_card(const fem::LawRecord& record, const CardUnits& units)
{
  const PronyCard prony = prony_card(record);
  const bool carried = !std::holds_alternative<fem::FreeShift>(record.shift);
  const std::string limits = prony.limits + shift_note(record, carried);
  const CreepCheck check = creep_check(record, prony.represented);
  return {{{card_name, card_text(record, units, prony, limits)},
           {"mastic_ansys_check.inp", deck_text(record, units, check)}},
          prony.represented,
          prony.creep_error,
          limits};
}

} // namespace coupling
