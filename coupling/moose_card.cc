#include "coupling/card_parts.h"

#include <fmt/format.h>

#include <cmath>

namespace coupling {

namespace {

/// A Kelvin unit of the model: spring with Young's modulus and Poisson's ratio, and its time.
struct KelvinUnit {
  double time, young, poisson;
};

/// Parts J and B of a unit; neither may be zero, as the program inverts the spring.
KelvinUnit kelvin_unit(double time, double shear, double bulk)
{
  shear = std::max(shear, 1e-8 * bulk);
  bulk = std::max(bulk, 1e-8 * shear);
  const YoungPoisson spring = young_poisson(1 / shear, 1 / bulk);
  return {time, spring.young, spring.poisson};
}

/// The isotropic creep as Kelvin units. Flow is a unit of a very long time: the dashpot of the
/// program would have the Poisson's ratio of the first spring.
std::vector<KelvinUnit> kelvin_units(const fem::ComplianceLaw& law, double last_time)
{
  std::vector<KelvinUnit> units;
  for (const fem::RetardationTerm& term : law.terms) {
    const IsotropicCreep part = isotropic_creep({law.instantaneous, fem::Mat6::Zero(), {term}});
    const auto compliance = [](const fem::CreepCompliance& creep) {
      return creep.parts.empty() ? 0 : creep.parts[0].compliance;
    };
    const double shear = compliance(part.shear), bulk = compliance(part.bulk);
    if (shear + bulk > 0)
      units.push_back(kelvin_unit(term.time, shear, bulk));
  }
  const IsotropicCreep creep = isotropic_creep(law);
  const double longest = 1e4 * std::max(last_time, units.empty() ? 0 : units.back().time);
  if (creep.shear.fluidity + creep.bulk.fluidity > 0)
    units.push_back(
        kelvin_unit(longest, longest * creep.shear.fluidity, longest * creep.bulk.fluidity));
  return units;
}

fem::ComplianceLaw represented_law(const IsotropicCreep& creep,
                                   const std::vector<KelvinUnit>& units)
{
  IsotropicCreep result{{creep.shear.instantaneous, 0, {}}, {creep.bulk.instantaneous, 0, {}}};
  for (const KelvinUnit& unit : units) {
    result.shear.parts.push_back({unit.time, 2 * (1 + unit.poisson) / unit.young});
    result.bulk.parts.push_back({unit.time, 3 * (1 - 2 * unit.poisson) / unit.young});
  }
  return compliance_law(result);
}

std::string material_block(const IsotropicCreep& creep, const std::vector<KelvinUnit>& kelvin,
                           const CardUnits& units)
{
  const YoungPoisson spring =
      young_poisson(1 / creep.shear.instantaneous, 1 / creep.bulk.instantaneous);
  std::string moduli, ratios, times;
  for (const KelvinUnit& unit : kelvin) {
    moduli += " " + digits(unit.young / units.stress);
    ratios += fmt::format(" {:.17g}", unit.poisson);
    times += " " + digits(unit.time);
  }
  return fmt::format("  [creep]\n    type = GeneralizedKelvinVoigtModel\n"
                     "    young_modulus = {}\n    poisson_ratio = {:.17g}\n"
                     "    creep_modulus = '{}'\n    creep_ratio = '{}'\n"
                     "    creep_viscosity = '{}' # times\n"
                     "    integration_rule = zienkiewicz\n  []\n",
                     digits(spring.young / units.stress), spring.poisson, moduli.substr(1),
                     ratios.substr(1), times.substr(1));
}

std::string boundary(const std::string& name, const std::string& variable, const std::string& side,
                     const std::string& type, const std::string& value)
{
  return fmt::format("  [{}]\n    type = {}\n    variable = {}\n    boundary = {}\n"
                     "    value = {}\n  []\n",
                     name, type, variable, side, value);
}

std::string kernel(const std::string& axis, int component)
{
  return fmt::format("  [equilibrium_{0}]\n    type = StressDivergenceTensors\n"
                     "    variable = disp_{0}\n    component = {1}\n  []\n",
                     axis, component);
}

std::string deck_text(const CardUnits& units, const CreepCheck& check, const std::string& materials)
{
  std::string text =
      "[GlobalParams]\n  displacements = 'disp_x disp_y disp_z'\n[]\n\n"
      "[Mesh]\n  type = GeneratedMesh\n  dim = 3\n  elem_type = HEX8\n[]\n\n"
      "[Variables]\n  [disp_x]\n  []\n  [disp_y]\n  []\n  [disp_z]\n  []\n[]\n\n"
      "[Kernels]\n" +
      kernel("x", 0) + kernel("y", 1) + kernel("z", 2) + "[]\n\n[BCs]\n" +
      boundary("hold_x", "disp_x", "left", "DirichletBC", "0") +
      boundary("hold_y", "disp_y", "bottom", "DirichletBC", "0") +
      boundary("hold_z", "disp_z", "back", "DirichletBC", "0") +
      boundary("load", "disp_x", "right", "NeumannBC", digits(check.stress / units.stress)) +
      "[]\n\n" + materials +
      "\n[UserObjects]\n  [update]\n    type = LinearViscoelasticityManager\n"
      "    viscoelastic_model = creep\n  []\n[]\n\n[Postprocessors]\n";
  for (const char* axis : {"x", "y"})
    text += fmt::format("  [strain_{0}{0}]\n    type = SideAverageValue\n    variable = disp_{0}\n"
                        "    boundary = {1}\n  []\n",
                        axis, axis[0] == 'x' ? "right" : "top");
  std::string times = "0";
  for (const double t : times_between({1e-3 * check.times.front(), check.times.back()}, 600))
    times += fmt::format(" {:.9e}", t);
  return text + fmt::format("[]\n\n[Executioner]\n  type = Transient\n  solve_type = NEWTON\n"
                            "  nl_rel_tol = 1e-10\n  nl_abs_tol = 1e-14\n  end_time = {}\n"
                            "  [TimeStepper]\n    type = TimeSequenceStepper\n"
                            "    time_sequence = '{}'\n  []\n[]\n\n[Outputs]\n  csv = true\n[]\n",
                            digits(check.times.back()), times);
}

} // namespace

MaterialCard moose_card(const fem::LawRecord& record, const CardUnits& units)
{
  const auto range = valid_times(record);
  const IsotropicCreep creep = isotropic_creep(record.law);
  const std::vector<KelvinUnit> kelvin = kelvin_units(record.law, range.second);
  const fem::ComplianceLaw represented = represented_law(creep, kelvin);
  std::string limits = isotropy_note(record);
  if (creep.shear.fluidity + creep.bulk.fluidity > 0)
    limits += fmt::format(" Flow is a Kelvin unit with a time 10,000 times the longest, which "
                          "changes D(t) by up to {:.2g} %.",
                          100 * creep_error(represented, compliance_law(creep), range));
  limits += shift_note(record, false);
  const std::string materials = "[Materials]\n" + material_block(creep, kelvin, units) +
                                "  [stress]\n    type = ComputeLinearViscoelasticStress\n  []\n"
                                "  [strain]\n    type = ComputeSmallStrain\n"
                                "    displacements = 'disp_x disp_y disp_z'\n  []\n[]\n";
  const std::string card =
      header(record, units, "#", "Creep law as a block of MOOSE's solid mechanics.", limits) +
      materials;
  const CreepCheck check = creep_check(record, represented);
  const std::string deck =
      header(record, units, "#", "Check of mastic_moose.i, whose block is copied in.", "") +
      expected_table(check, "#") + "\n" + deck_text(units, check, materials);
  return {{{"mastic_moose.i", card}, {"mastic_moose_check.i", deck}},
          represented,
          creep_error(represented, record.law, range),
          limits};
}

} // namespace coupling
