#include "coupling/card_parts.h"

#include <fmt/format.h>

#include <array>

namespace coupling {

namespace {

/// Order of tensor components in TFEL (11 22 33 12 13 23) in terms of ours (11 22 33 23 13 12).
/// Both carry sqrt(2) in shear.
constexpr std::array<int, 6> tfel_order{0, 1, 2, 5, 4, 3};

std::string entries(const fem::Mat6& matrix)
{
  std::string text;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      text += fmt::format("{}{}{}", i + j ? "," : "", j ? " " : "\n      ",
                          digits(matrix(tfel_order[std::size_t(i)], tfel_order[std::size_t(j)])));
  return text;
}

std::string shift_code(std::monostate)
{
  return "  const real shift = 1;\n";
}

std::string shift_code(const fem::WlfShift& shift)
{
  return fmt::format("  const real above = T + dT / 2 - {};\n"
                     "  const real shift = std::pow(10., -{} * above / ({} + above));\n",
                     digits(shift.reference_temperature), digits(shift.c1), digits(shift.c2));
}

std::string shift_code(const fem::ArrheniusShift& shift)
{
  return fmt::format("  const real shift = std::exp({} * (1 / (T + dT / 2) - 1 / {}));\n",
                     digits(shift.activation_energy / 8.314462618),
                     digits(shift.reference_temperature));
}

std::string shift_code(const fem::FreeShift& shift)
{
  std::string temperatures, logs;
  for (std::size_t i = 0; i < shift.temperatures.size(); ++i) {
    temperatures += (i ? ", " : "") + digits(shift.temperatures[i]);
    logs += (i ? ", " : "") + digits(shift.log10_factors[i]);
  }
  return fmt::format("  // log10 of the shift factor: linear between these temperatures.\n"
                     "  const int n_temperatures = {};\n"
                     "  const real temperatures[n_temperatures] = {{{}}};\n"
                     "  const real logs[n_temperatures] = {{{}}};\n"
                     "  const real middle = T + dT / 2;\n  int at = 0;\n"
                     "  while (at < n_temperatures - 2 && middle > temperatures[at + 1])\n"
                     "    ++at;\n"
                     "  const real part = (middle - temperatures[at]) /\n"
                     "                    (temperatures[at + 1] - temperatures[at]);\n"
                     "  const real shift =\n"
                     "      std::pow(10., logs[at] + part * (logs[at + 1] - logs[at]));\n",
                     shift.temperatures.size(), temperatures, logs);
}

/// The terms of a law; at least one, as a behaviour has no arrays of length zero.
std::vector<fem::RetardationTerm> terms_of(const fem::ComplianceLaw& law)
{
  if (law.terms.empty())
    return {{1, fem::Mat6::Zero()}};
  return law.terms;
}

std::string tables(const fem::ComplianceLaw& law, double stress)
{
  const auto terms = terms_of(law);
  std::string times, parts;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    times += (k ? ", " : "") + digits(terms[k].time);
    parts += (k ? "," : "") + std::string("\n     {") + entries(stress * terms[k].compliance) + "}";
  }
  return fmt::format("  const real tau[{0}] = {{{1}}};\n"
                     "  const real S_0[36] = {{{2}}};\n"
                     "  const real S_v[36] = {{{3}}};\n"
                     "  const real S_k[{0}][36] = {{{4}}};\n",
                     terms.size(), times, entries(stress * law.instantaneous),
                     entries(stress * law.fluidity), parts);
}

/// The update: exact if the stress changes evenly over the step.
constexpr const char* update_code = R"(  const real step = dt / shift; // reduced time
  real decay[n_terms], ramp[n_terms];
  for (int k = 0; k != n_terms; ++k) {
    const real x = step / tau[k];
    decay[k] = -std::expm1(-x);
    ramp[k] = x > 1e-4 ? 1 - decay[k] / x : x / 2 - x * x / 6;
  }
  Stensor4 algorithmic; // strain increment per stress increment
  StrainStensor creep = deto; // strain increment without change of stress
  for (int i = 0; i != 6; ++i) {
    real flow = 0, retarded = 0;
    for (int j = 0; j != 6; ++j) {
      const int ij = 6 * i + j;
      real sum = S_0[ij] + step / 2 * S_v[ij];
      flow += step * S_v[ij] * sig[j];
      for (int k = 0; k != n_terms; ++k) {
        sum += ramp[k] * S_k[k][ij];
        retarded += decay[k] * S_k[k][ij] * sig[j];
      }
      algorithmic(i, j) = sum;
    }
    for (int k = 0; k != n_terms; ++k)
      retarded -= decay[k] * er[k][i];
    creep[i] = flow + retarded;
  }
  const Stensor4 tangent = invert(algorithmic);
  const StrainStensor elastic = deto - creep;
  real change[6];
  for (int i = 0; i != 6; ++i) {
    change[i] = 0;
    for (int j = 0; j != 6; ++j)
      change[i] += tangent(i, j) * elastic[j];
  }
  for (int k = 0; k != n_terms; ++k) {
    real grown[6];
    for (int i = 0; i != 6; ++i) {
      grown[i] = -decay[k] * er[k][i];
      for (int j = 0; j != 6; ++j)
        grown[i] += S_k[k][6 * i + j] * (decay[k] * sig[j] + ramp[k] * change[j]);
    }
    for (int i = 0; i != 6; ++i)
      er[k][i] += grown[i];
  }
  for (int i = 0; i != 6; ++i)
    sig[i] += change[i];
  if (computeTangentOperator_)
    Dt = tangent;
)";

std::string behaviour_text(const fem::LawRecord& record, const CardUnits& units,
                           const std::string& limits)
{
  return header(record, units, "//", "Creep law as an MFront behaviour.", limits) +
         fmt::format(
             "@DSL Default;\n@Behaviour MasticCreep;\n"
             "@Description{{\n"
             "  Anisotropic generalised Kelvin law\n"
             "  S(t) = S_0 + t S_v + sum of S_k (1 - exp(-t / tau_k)), t the reduced time.\n"
             "  The axes of the material are those of the frame. Internal variables are the\n"
             "  retarded strains. The update is exact while the stress changes evenly over a\n"
             "  step, and its tangent is consistent.\n}}\n"
             "@ModellingHypothesis Tridimensional;\n\n"
             "@IntegerConstant n_terms = {0};\n"
             "@AuxiliaryStateVariable StrainStensor er[{0}];\n"
             "er.setEntryName(\"RetardedStrain\");\n\n"
             "@ProvidesSymmetricTangentOperator true;\n\n@Integrator{{\n",
             terms_of(record.law).size()) +
         tables(record.law, units.stress) +
         std::visit([](const auto& shift) { return shift_code(shift); }, record.shift) +
         update_code + "}\n";
}

/// Strain along an axis under a constant stress along axis 1, in closed form.
std::string strain_formula(const fem::ComplianceLaw& law, double stress, int axis)
{
  const auto number = [&](double value) {
    return value < 0 ? "(" + digits(value) + ")" : digits(value);
  };
  std::string formula = fmt::format("{} + {} * t", number(stress * law.instantaneous(axis, 0)),
                                    number(stress * law.fluidity(axis, 0)));
  for (const fem::RetardationTerm& term : law.terms)
    formula += fmt::format(" + {} * (1 - exp(-t / {}))", number(stress * term.compliance(axis, 0)),
                           digits(term.time));
  return formula;
}

std::string deck_text(const fem::LawRecord& record, const CardUnits& units, const CreepCheck& check)
{
  const double ramp = 1e-6 * check.times.front();
  std::string times = fmt::format("0, {}", digits(ramp));
  for (const double until : check.times)
    times += fmt::format(", {} in 20", digits(until));
  return header(record, units, "//",
                "Check of MasticCreep.mfront: mfront --obuild --interface=generic "
                "MasticCreep.mfront, then mtest this file.",
                "") +
         expected_table(check, "//") +
         fmt::format("@ModellingHypothesis 'Tridimensional';\n"
                     "@Behaviour<generic> 'src/libBehaviour.so' 'MasticCreep';\n"
                     "@ExternalStateVariable 'Temperature' {0:.6f};\n"
                     "@ImposedStress 'SXX' {{0 : 0, {1} : {2}, {3} : {2}}};\n"
                     "@StressEpsilon {7};\n@Times {{{4}}};\n"
                     "@Test<function> 'EXX' '{5}' {6};\n@Test<function> 'EYY' '{8}' {6};\n",
                     record.reference_temperature, digits(ramp),
                     digits(check.stress / units.stress), digits(check.times.back()), times,
                     strain_formula(record.law, check.stress, 0),
                     digits(1e-4 * check.axial.front()), digits(1e-8 * check.stress / units.stress),
                     strain_formula(record.law, check.stress, 1));
}

} // namespace

MaterialCard mfront_card(const fem::LawRecord& record, const CardUnits& units)
{
  const std::string limits =
      "The behaviour is the law itself, anisotropic and with its temperature shift; its error is "
      "that of the time steps where the stress does not change evenly." +
      shift_note(record, true);
  return {
      {{"MasticCreep.mfront", behaviour_text(record, units, limits)},
       {"mastic_mfront_check.mtest", deck_text(record, units, creep_check(record, record.law))}},
      record.law,
      0,
      limits};
}

} // namespace coupling
