#include "coupling/material_cards.h"

#include "coupling/card_parts.h"

#include <fmt/format.h>

#include <stdexcept>

namespace coupling {

std::vector<NamedCardFormat> card_formats()
{
  return {{"abaqus", CardFormat::abaqus, "Abaqus"},
          {"ansys", CardFormat::ansys, "Ansys Mechanical APDL"},
          {"ls-dyna", CardFormat::ls_dyna, "LS-DYNA"},
          {"mfront", CardFormat::mfront, "MFront"},
          {"moose", CardFormat::moose, "MOOSE"},
          {"tables", CardFormat::tables, "tables as CSV"}};
}

CardUnits si_units()
{
  return {"si", "m, kg, s, N, Pa, K", 1, 1, 1};
}

CardUnits millimetre_units()
{
  return {"mm", "mm, t, s, N, MPa, K", 1e-3, 1e6, 1e12};
}

namespace {

MaterialCard card_of(const fem::LawRecord& record, CardFormat format, const CardUnits& units)
{
  switch (format) {
  case CardFormat::abaqus:
    return abaqus_card(record, units);
  case CardFormat::ansys:
    return ansys_card(record, units);
  case CardFormat::ls_dyna:
    return ls_dyna_card(record, units);
  case CardFormat::mfront:
    return mfront_card(record, units);
  case CardFormat::moose:
    return moose_card(record, units);
  case CardFormat::tables:
    break;
  }
  return law_tables(record, units);
}

} // namespace

MaterialCard material_card(const fem::LawRecord& record, CardFormat format, const CardUnits& units)
{
  if (record.law.terms.empty() && record.law.fluidity.isZero(0))
    throw std::invalid_argument("the law is elastic: it has neither retardation terms nor flow, so "
                                "there is no creep to write a card for");
  MaterialCard card = card_of(record, format, units);
  card.files.push_back(
      {"note.txt",
       card.limits + fmt::format("\nLargest error of D(t) of the card in the range of validity: "
                                 "{:.3g} %.\n",
                                 100 * card.creep_error)});
  return card;
}

} // namespace coupling
