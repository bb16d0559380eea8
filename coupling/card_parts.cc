#include "coupling/card_parts.h"

#include "fem/symmetry.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace coupling {

namespace {

const std::vector<fem::Vec3> directions{{1, 0, 0},  {0, 1, 0},  {0, 0, 1}, {0, 1, 1},  {0, 1, -1},
                                        {1, 0, 1},  {1, 0, -1}, {1, 1, 0}, {1, -1, 0}, {1, 1, 1},
                                        {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};

} // namespace

std::pair<double, double> valid_times(const fem::LawRecord& record)
{
  const fem::ComplianceLaw& law = record.law;
  const double flow_time =
      law.fluidity.norm() > 0 ? law.instantaneous.norm() / law.fluidity.norm() : 1;
  const double first = law.terms.empty() ? flow_time : law.terms.front().time;
  const double last = law.terms.empty() ? flow_time : law.terms.back().time;
  const double begin = record.first_time > 0 ? record.first_time : 0.01 * first;
  const double end = record.last_time > begin ? record.last_time : std::max(10 * last, 10 * begin);
  return {begin, end};
}

std::vector<double> times_between(std::pair<double, double> range, int count)
{
  std::vector<double> times;
  for (int i = 0; i < count; ++i)
    times.push_back(range.first * std::pow(range.second / range.first, double(i) / (count - 1)));
  times.back() = range.second;
  return times;
}

CreepCheck creep_check(const fem::LawRecord& record, const fem::ComplianceLaw& represented)
{
  CreepCheck check{1e5, times_between(valid_times(record), 7), {}, {}, {}};
  for (const double t : check.times) {
    const fem::Mat6 compliance = fem::compliance(represented, t);
    check.axial.push_back(check.stress * compliance(0, 0));
    check.lateral.push_back(check.stress * compliance(1, 0));
    check.law_strain.push_back(check.stress * fem::compliance(record.law, t)(0, 0));
  }
  return check;
}

double creep_error(const fem::ComplianceLaw& found, const fem::ComplianceLaw& exact,
                   std::pair<double, double> range)
{
  double largest = 0;
  for (const double t : times_between(range, 200))
    for (const fem::Vec3& direction : directions)
      largest = std::max(largest, std::abs(fem::uniaxial_compliance(found, direction, t) /
                                               fem::uniaxial_compliance(exact, direction, t) -
                                           1));
  return largest;
}

std::string digits(double value)
{
  return fmt::format("{:.12e}", value);
}

YoungPoisson young_poisson(double shear_modulus, double bulk_modulus)
{
  const double young = 9 * bulk_modulus * shear_modulus / (3 * bulk_modulus + shear_modulus);
  return {young, young / (2 * shear_modulus) - 1};
}

std::string header(const fem::LawRecord& record, const CardUnits& units, const std::string& comment,
                   const std::string& what, const std::string& limits)
{
  const auto [begin, end] = valid_times(record);
  std::string text =
      fmt::format("{0} {1}\n{0} Units: {2}; tension is positive.\n"
                  "{0} Reference temperature {3:g} K; valid for reduced times from "
                  "{4:g} s to {5:g} s.\n",
                  comment, what, units.words, record.reference_temperature, begin, end);
  std::istringstream words(limits);
  std::string line, word;
  while (words >> word) {
    if (line.size() + word.size() > 90) {
      text += comment + line + "\n";
      line.clear();
    }
    line += " " + word;
  }
  text += line.empty() ? "" : comment + line + "\n";
  for (const std::string& source : record.provenance)
    text += comment + " Source: " + source.substr(0, 200) + "\n";
  return text;
}

std::string expected_table(const CreepCheck& check, const std::string& comment)
{
  std::string text =
      fmt::format("{0} Uniaxial stress {1:g} Pa along axis 1, applied at once at t = 0 and kept.\n"
                  "{0} Expected strains in closed form; the last column is the law before it was "
                  "fitted to this format.\n{0} {2:>14} {3:>20} {4:>20} {5:>20}\n",
                  comment, check.stress, "time_s", "strain_11", "strain_22", "strain_11_of_law");
  for (std::size_t i = 0; i < check.times.size(); ++i)
    text += fmt::format("{} {:14.6e} {:20.12e} {:20.12e} {:20.12e}\n", comment, check.times[i],
                        check.axial[i], check.lateral[i], check.law_strain[i]);
  return text;
}

std::string isotropy_note(const fem::LawRecord& record)
{
  const auto range = valid_times(record);
  const IsotropicCreep creep = isotropic_creep(record.law);
  const fem::ComplianceLaw nearest = compliance_law(creep);
  const fem::ComplianceLaw constant_bulk =
      compliance_law({creep.shear, {creep.bulk.instantaneous, 0, {}}});
  const double apart = fem::distance(record.law, fem::Symmetry{});
  const std::string anisotropy =
      apart < 1e-12 ? ", as this law is"
                    : fmt::format(": this law is {:.2g} % from the nearest isotropic one, which "
                                  "changes the uniaxial creep compliance D(t) by up to {:.2g} %",
                                  100 * apart, 100 * creep_error(nearest, record.law, range));
  return fmt::format("The format is isotropic{}. Both shear and bulk modulus relax in the card; a "
                     "constant bulk modulus would change D(t) by up to {:.2g} %.",
                     anisotropy, 100 * creep_error(constant_bulk, nearest, range));
}

std::string shift_note(const fem::LawRecord& record, bool carried)
{
  if (std::holds_alternative<std::monostate>(record.shift))
    return " The law has no temperature shift: the card holds at its reference temperature.";
  if (carried)
    return {};
  return fmt::format(" The temperature shift is not in the card, which holds at {:g} K; elsewhere "
                     "multiply all its times by the shift factor a_T.",
                     record.reference_temperature);
}

PronyCard prony_card(const fem::LawRecord& record)
{
  const auto range = valid_times(record);
  const IsotropicCreep creep = isotropic_creep(record.law);
  PronyCard card;
  card.series = prony_series(isotropic_relaxation(creep), range.second);
  card.represented = compliance_law(isotropic_creep(isotropic_relaxation(card.series)));
  card.creep_error = creep_error(card.represented, record.law, range);
  card.limits = isotropy_note(record);
  const double flow = creep.shear.fluidity + creep.bulk.fluidity;
  if (flow > 0)
    card.limits += fmt::format(
        " The format asks for long-term moduli: this law flows, and a small residual modulus "
        "changes D(t) by up to {:.2g} %.",
        100 * creep_error(card.represented, compliance_law(creep), range));
  return card;
}

} // namespace coupling
