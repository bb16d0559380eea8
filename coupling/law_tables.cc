#include "coupling/card_parts.h"

#include "fem/symmetry.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace coupling {

namespace {

const std::vector<fem::Vec3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// The three axes of the law, then the nearest isotropic law.
std::vector<fem::CreepCompliance> uniaxial_laws(const fem::LawRecord& record)
{
  std::vector<fem::CreepCompliance> laws;
  for (const fem::Vec3& axis : axes)
    laws.push_back(fem::uniaxial(record.law, axis));
  laws.push_back(fem::uniaxial(compliance_law(isotropic_creep(record.law)), axes[0]));
  return laws;
}

/// "D_1_1_per_GPa,D_2_1_per_GPa,...": a column for each of the uniaxial laws.
std::string columns(const std::string& quantity, const std::string& unit)
{
  std::string text;
  for (const char* which : {"1", "2", "3", "isotropic"})
    text += fmt::format(",{}_{}_{}", quantity, which, unit);
  return text;
}

std::string creep_table(const fem::LawRecord& record)
{
  std::string text = "reduced_time_s" + columns("D", "1_per_GPa") + "\n";
  const auto laws = uniaxial_laws(record);
  for (const double t : times_between(valid_times(record), 101)) {
    text += digits(t);
    for (const fem::CreepCompliance& law : laws)
      text += "," + digits(1e9 * fem::value(law, t));
    text += "\n";
  }
  return text;
}

std::string relaxation_table(const fem::LawRecord& record)
{
  std::string text = "reduced_time_s" + columns("E", "MPa") + "\n";
  std::vector<fem::RelaxationModulus> moduli;
  for (const fem::CreepCompliance& law : uniaxial_laws(record))
    moduli.push_back(fem::relaxation_modulus(law));
  for (const double t : times_between(valid_times(record), 101)) {
    text += digits(t);
    for (const fem::RelaxationModulus& modulus : moduli)
      text += "," + digits(1e-6 * fem::value(modulus, t));
    text += "\n";
  }
  return text;
}

/// Temperatures of the table: those of a usual dynamic modulus test within the range in which the
/// law was seen; the reference temperature alone if there is no shift or no range.
std::vector<double> temperatures(const fem::LawRecord& record)
{
  if (std::holds_alternative<std::monostate>(record.shift) || !record.temperatures)
    return {record.reference_temperature};
  std::vector<double> result{record.temperatures->first};
  for (const double celsius : {-10.0, 4.4, 21.1, 37.8, 54.4})
    if (const double kelvin = celsius + 273.15;
        kelvin > record.temperatures->first && kelvin < record.temperatures->second)
      result.push_back(kelvin);
  if (record.temperatures->second > record.temperatures->first)
    result.push_back(record.temperatures->second);
  return result;
}

std::string modulus_table(const fem::LawRecord& record)
{
  std::string text = "temperature_degC,frequency_Hz,reduced_frequency_Hz" +
                     columns("dynamic_modulus", "MPa") + columns("phase_angle", "deg") + "\n";
  const auto laws = uniaxial_laws(record);
  for (const double temperature : temperatures(record))
    for (const double frequency : {25.0, 10.0, 5.0, 1.0, 0.5, 0.1, 0.01}) {
      const double reduced = frequency * fem::shift_factor(record.shift, temperature);
      text += fmt::format("{:.4f},{:g},{}", temperature - 273.15, frequency, digits(reduced));
      std::string phases;
      for (const fem::CreepCompliance& law : laws) {
        const auto modulus = fem::complex_modulus(law, 2 * std::numbers::pi * reduced);
        text += "," + digits(1e-6 * std::abs(modulus));
        phases += "," + digits(180 / std::numbers::pi * std::arg(modulus));
      }
      text += phases + "\n";
    }
  return text;
}

/// E(t), G(t) and K(t) of the isotropic law; a row with an infinite time is the long-term part.
std::string prony_table(const fem::LawRecord& record)
{
  const auto laws = uniaxial_laws(record);
  const IsotropicRelaxation relaxation = isotropic_relaxation(isotropic_creep(record.law));
  std::string text = "modulus,relaxation_time_s,part_MPa,relative_part\n";
  const auto rows = [&](const char* name, const fem::RelaxationModulus& modulus) {
    const double initial = fem::value(modulus, 0);
    for (const fem::RelaxationPart& part : modulus.parts)
      text += fmt::format("{},{},{},{}\n", name, digits(part.time), digits(1e-6 * part.modulus),
                          digits(part.modulus / initial));
    text += fmt::format("{},inf,{},{}\n", name, digits(1e-6 * modulus.equilibrium),
                        digits(modulus.equilibrium / initial));
  };
  rows("E", fem::relaxation_modulus(laws.back()));
  rows("G", relaxation.shear);
  rows("K", relaxation.bulk);
  return text;
}

} // namespace

MaterialCard law_tables(const fem::LawRecord& record, const CardUnits&)
{
  const double apart = fem::distance(record.law, fem::Symmetry{});
  const std::string limits = fmt::format(
      "The tables give the axes 1, 2, 3 of the law and the nearest isotropic law, which is {:.2g} "
      "% away. Units are in the names of the columns, whatever units were asked for.",
      apart < 1e-12 ? 0 : 100 * apart);
  return {{{"creep_compliance.csv", creep_table(record)},
           {"relaxation_modulus.csv", relaxation_table(record)},
           {"dynamic_modulus.csv", modulus_table(record)},
           {"prony_series.csv", prony_table(record)}},
          record.law,
          0,
          limits};
}

} // namespace coupling
