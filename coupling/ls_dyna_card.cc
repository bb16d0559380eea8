#include "coupling/card_parts.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace coupling {

namespace {

constexpr const char* card_name = "mastic_ls_dyna.k";
constexpr std::size_t most_terms = 18;

/// A number in a field of ten columns with as many digits as fit: "1.23456E-7".
std::string field(double value)
{
  if (value == 0)
    return fmt::format("{:>10}", "0.0");
  std::string text;
  for (int places = 8; places >= 0; --places) {
    const std::string scientific = fmt::format("{:.{}e}", value, places);
    const std::size_t mark = scientific.find('e');
    text = scientific.substr(0, mark) + fmt::format("E{}", std::stoi(scientific.substr(mark + 1)));
    if (text.size() <= 9) // one column stays free between fields
      break;
  }
  return fmt::format("{:>10}", text);
}

/// The value that `field` writes.
double written(double value)
{
  return std::stod(field(value));
}

std::string field(int value)
{
  return fmt::format("{:>10}", value);
}

/// One line of the material: G_i, BETA_i, K_i, BETAK_i, in the units of the card.
struct Term {
  double shear = 0, shear_rate = 0, bulk = 0, bulk_rate = 0;
};

/// Terms of a modulus with their decay rates; the long-term part is one that does not decay.
std::vector<std::pair<double, double>> terms_of(const fem::RelaxationModulus& modulus)
{
  std::vector<std::pair<double, double>> terms;
  for (const fem::RelaxationPart& part : modulus.parts)
    terms.emplace_back(part.modulus, 1 / part.time);
  if (modulus.equilibrium > 1e-12 * fem::value(modulus, 0))
    terms.emplace_back(modulus.equilibrium, 0);
  return terms;
}

std::vector<Term> terms_of(const IsotropicRelaxation& relaxation)
{
  const auto shear = terms_of(relaxation.shear), bulk = terms_of(relaxation.bulk);
  std::vector<Term> terms(std::max(shear.size(), bulk.size()));
  if (terms.size() > most_terms)
    throw std::invalid_argument(
        fmt::format("LS-DYNA takes {} relaxation terms and this law has {}; fit a law with fewer "
                    "retardation times",
                    most_terms, terms.size()));
  for (std::size_t i = 0; i < shear.size(); ++i)
    std::tie(terms[i].shear, terms[i].shear_rate) = shear[i];
  for (std::size_t i = 0; i < bulk.size(); ++i)
    std::tie(terms[i].bulk, terms[i].bulk_rate) = bulk[i];
  return terms;
}

/// The moduli that the rounded fields make.
IsotropicRelaxation as_written(const std::vector<Term>& terms)
{
  IsotropicRelaxation result;
  const auto add = [](fem::RelaxationModulus& modulus, double part, double rate) {
    if (part > 0 && rate > 0)
      modulus.parts.push_back({1 / written(rate), written(part)});
    else if (part > 0)
      modulus.equilibrium = written(part);
  };
  for (const Term& term : terms) {
    add(result.shear, term.shear, term.shear_rate);
    add(result.bulk, term.bulk, term.bulk_rate);
  }
  return result;
}

std::string card_text(const fem::LawRecord& record, const CardUnits& units,
                      const std::vector<Term>& terms, double bulk_modulus,
                      const std::string& limits)
{
  const double density = 2400 / units.density;
  std::string text =
      "*KEYWORD\n" + header(record, units, "$", "Creep law as an LS-DYNA material.", limits) +
      "$ The density is a placeholder: the law has none.\n*MAT_GENERAL_VISCOELASTIC\n"
      "$      mid        ro      bulk       pcf        ef      tref         a         b\n" +
      field(1) + field(density) + field(bulk_modulus / units.stress) + field(0) + field(0) +
      field(0) + field(0) + field(0) + "\n" +
      "$     lcid        nt    bstart     tramp     lcidk       ntk   bstartk    trampk\n";
  for (int i = 0; i < 8; ++i)
    text += field(0);
  text += "\n$       gi     betai        ki    betaki\n";
  for (const Term& term : terms)
    text += field(term.shear / units.stress) + field(term.shear_rate) +
            field(term.bulk / units.stress) + field(term.bulk_rate) + "\n";
  return text + "*END\n";
}

std::string deck_text(const fem::LawRecord& record, const CardUnits& units, const CreepCheck& check)
{
  const double end = check.times.back();
  std::string text = "*KEYWORD\n" +
                     header(record, units, "$", "Check of " + std::string(card_name) + ".", "") +
                     expected_table(check, "$") + "*INCLUDE\n" + card_name + "\n";
  text += "*CONTROL_TERMINATION\n" + field(end) + "\n*CONTROL_IMPLICIT_GENERAL\n" + field(1) +
          field(1e-3 * check.times.front()) + "\n*CONTROL_IMPLICIT_AUTO\n" + field(1) + field(11) +
          field(5) + field(0) + field(0.01 * end) + "\n";
  text += "*NODE\n";
  const int corner[8][3]{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                         {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (int i = 0; i < 8; ++i) {
    const auto& at = corner[i];
    const int code = (at[0] ? 0 : 1) + (at[1] ? 0 : 2) + (at[2] ? 0 : 4); // held directions
    const int constraint[8]{0, 1, 2, 4, 3, 6, 5, 7}; // x, y, xy, z, zx, yz, xyz
    text += fmt::format("{:>8}{:>16.1f}{:>16.1f}{:>16.1f}{:>8}{:>8}\n", i + 1, double(at[0]),
                        double(at[1]), double(at[2]), constraint[code], 0);
  }
  text += "*ELEMENT_SOLID\n";
  for (const int number : {1, 1, 1, 2, 3, 4, 5, 6, 7, 8})
    text += fmt::format("{:>8}", number);
  text += "\n*PART\ncube\n" + field(1) + field(1) + field(1) + "\n*SECTION_SOLID\n" + field(1) +
          field(2) + "\n*DEFINE_CURVE\n" + field(1) + "\n";
  for (const auto& [time, factor] :
       {std::pair{0.0, 0.0}, {1e-3 * check.times.front(), 1.0}, {2 * end, 1.0}})
    text += fmt::format("{:>20.12e}{:>20.12e}\n", time, factor);
  text += "*SET_NODE_LIST\n" + field(1) + "\n" + field(2) + field(3) + field(6) + field(7) +
          "\n*LOAD_NODE_SET\n" + field(1) + field(1) + field(1) +
          field(check.stress / units.stress / 4) + "\n*DATABASE_NODOUT\n" +
          field(check.times.front()) + "\n*DATABASE_HISTORY_NODE\n" + field(7) + "\n";
  return text + "*END\n";
}

} // namespace

MaterialCard ls_dyna_card(const fem::LawRecord& record, const CardUnits& units)
{
  const IsotropicRelaxation relaxation = isotropic_relaxation(isotropic_creep(record.law));
  const std::vector<Term> terms = terms_of(relaxation);
  const fem::ComplianceLaw represented = compliance_law(isotropic_creep(relaxation));
  const auto range = valid_times(record);
  const double rounding =
      creep_error(compliance_law(isotropic_creep(as_written(terms))), represented, range);
  const std::string limits =
      isotropy_note(record) +
      fmt::format(" Fields of ten columns round the constants, which changes D(t) by up to {:.2g} "
                  "%.",
                  100 * rounding) +
      shift_note(record, false);
  return {{{card_name, card_text(record, units, terms, fem::value(relaxation.bulk, 0), limits)},
           {"mastic_ls_dyna_check.k", deck_text(record, units, creep_check(record, represented))}},
          represented,
          creep_error(represented, record.law, range),
          limits};
}

} // namespace coupling
