#include "coupling/card_parts.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace coupling {

namespace {

/// A Kelvin branch so stiff, or a dashpot so viscous, that it is as good as absent.
constexpr double very = 1e6;

/// The bond law as a Burgers element: missing parts become very stiff ones.
dem::CreepLaw burgers_of(const dem::CreepLaw& law, double last_time)
{
  const double stiffness = law.maxwell_stiffness;
  const dem::KelvinBranch branch =
      law.branches.empty() ? dem::KelvinBranch{very * stiffness, very * stiffness * last_time}
                           : law.branches[0];
  return dem::burgers(stiffness, law.maxwell_viscosity.value_or(very * stiffness * last_time),
                      branch.stiffness, branch.viscosity);
}

std::string property(const char* name, double value)
{
  return fmt::format("  {} {} ...\n", name, digits(value));
}

std::string properties(const dem::CreepLaw& law, double ratio, double friction)
{
  const dem::KelvinBranch& kelvin = law.branches.at(0);
  return property("bur_knk", kelvin.stiffness) + property("bur_cnk", kelvin.viscosity) +
         property("bur_knm", law.maxwell_stiffness) + property("bur_cnm", *law.maxwell_viscosity) +
         property("bur_ksk", kelvin.stiffness / ratio) +
         property("bur_csk", kelvin.viscosity / ratio) +
         property("bur_ksm", law.maxwell_stiffness / ratio) +
         property("bur_csm", *law.maxwell_viscosity / ratio) +
         fmt::format("  bur_fric {} ...\n  bur_mode 0\n", digits(friction)); // pulls, too
}

} // namespace

ContactCard pfc_card(const dem::BondLaw& law, double friction, double last_time)
{
  if (!(last_time > 0) || !(friction >= 0))
    throw std::invalid_argument("the time must be positive and the friction not negative");
  if (law.creep.branches.size() > 1)
    throw std::invalid_argument(
        fmt::format("the contact model burger of PFC has one Kelvin branch and this bond law has "
                    "{}; fit a law with one",
                    law.creep.branches.size()));
  const dem::CreepLaw element = burgers_of(law.creep, last_time);
  const std::vector<double> times = times_between({1e-4 * last_time, last_time}, 7);
  ContactCard card;
  for (const double t : times_between({1e-4 * last_time, last_time}, 200))
    card.creep_error = std::max(
        card.creep_error,
        std::abs(dem::creep_compliance(element, t) / dem::creep_compliance(law.creep, t) - 1));
  card.limits = "The contact model has no bending or torsion stiffness, never breaks and has one "
                "Kelvin branch. Its shear force ends at Coulomb's limit, also where a bond would "
                "hold. The constants hold at the temperature for which they are given.";
  if (card.creep_error > 1e-12)
    card.limits += fmt::format(
        " The law has no {}: in its place stands one {:g} times stiffer than "
        "the spring, which changes J(t) by up to {:.2g} %.",
        law.creep.branches.empty() ? "Kelvin branch" : "dashpot", very, 100 * card.creep_error);
  std::string text = "; Bond law as the contact model burger of PFC 6 and later.\n"
                     "; Units: m, N, s; normal and shear constants differ by the ratio N/S = " +
                     fmt::format("{:g}.\n; {}\n", law.normal_to_shear, card.limits) +
                     "contact cmat default type ball-ball model burger property ...\n" +
                     properties(element, law.normal_to_shear, friction);
  const double load = 1e-3 * law.creep.maxwell_stiffness; // one thousandth of a metre at once
  std::string deck = fmt::format(
      "; Creep of one contact: two balls pressed together by {} N along x from t = 0.\n"
      "; Expected approach in closed form, after the wave of the first load has been damped:\n"
      "; {:>14} {:>20}\n",
      digits(load), "time_s", "approach_m");
  for (const double t : times)
    deck += fmt::format("; {:14.6e} {:20.12e}\n", t, load * dem::creep_compliance(element, t));
  deck += fmt::format("model new\nmodel large-strain on\nmodel domain extent -10 10\n"
                      "program call 'mastic_pfc.dat'\n"
                      "ball create id 1 position-x -1.0 position-y 0 position-z 0 radius 1.0\n"
                      "ball create id 2 position-x 1.0 position-y 0 position-z 0 radius 1.0\n"
                      "ball attribute density 2400 damp 0.7\n"
                      "ball fix velocity spin range id 1\nball fix spin range id 2\n"
                      "model clean\n"
                      "ball attribute force-applied-x {} range id 2\n"
                      "ball history displacement-x id 2\nmodel history mechanical time-total\n"
                      "model solve time-total {}\n"
                      "history export '1' vs '2' file 'mastic_pfc_check' truncate\n",
                      digits(-load), digits(last_time));
  card.files = {{"mastic_pfc.dat", text}, {"mastic_pfc_check.dat", deck}};
  return card;
}

} // namespace coupling
