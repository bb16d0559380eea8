#include "apps/extract_files.h"
#include "fem/mandel.h"
#include "fem/symmetry.h"

#include <fmt/format.h>

#include <cmath>

namespace apps {

namespace {

std::string with_deviation(const Scatter& s, double scale)
{
  return s.n < 2 ? fmt::format("{:.5g}", scale * s.mean)
                 : fmt::format("{:.5g} +- {:.2g}", scale * s.mean, scale * s.deviation);
}

std::string matrix_text(const dem::Mat6& matrix, double scale)
{
  std::string text;
  for (int i = 0; i < 6; ++i) {
    text += "   ";
    for (int j = 0; j < 6; ++j)
      text += fmt::format(" {:11.4g}", scale * matrix(i, j));
    text += '\n';
  }
  return text;
}

std::string sizes_text(const Extraction& e)
{
  std::string text = fmt::format("  {:>8} {:>6} {:>8}  {:>20}  {:>18}", "spheres", "number",
                                 "L/D_max", "E(0) [MPa]", "nu");
  for (const dem::BoundaryCondition each : all_conditions)
    text += fmt::format("  {:>16}", name_of(each));
  text += "\n";
  for (const SizeResult& s : e.sizes) {
    text += fmt::format("  {:>8} {:>6} {:>8.3g}  {:>20}  {:>18}", s.n_particles, s.young.n,
                        s.size_ratio, with_deviation(s.young, 1e-6), with_deviation(s.poisson, 1));
    for (const auto& bound : s.bounds)
      text += fmt::format("  {:>16}", bound ? fmt::format("{:.5g}", 1e-6 * bound->mean) : "-");
    text += "\n";
  }
  return text;
}

std::string law_text_lines(const LoadedScene& scene, const Extraction& e)
{
  const fem::ComplianceLaw& law = e.law.law;
  std::string text = fmt::format("  S(0) [1/GPa], Mandel notation (11 22 33 23 13 12):\n{}",
                                 matrix_text(law.instantaneous, 1e9));
  const auto distance = [&](fem::SymmetryClass kind) {
    return 100 * fem::distance(law, fem::best_symmetry(law, kind));
  };
  text += fmt::format("  distance of the law from the nearest isotropic one {:.3g} %, transversely "
                      "isotropic {:.3g} %, orthotropic {:.3g} %\n",
                      distance(fem::SymmetryClass::isotropic),
                      distance(fem::SymmetryClass::transversely_isotropic),
                      distance(fem::SymmetryClass::orthotropic));
  if (e.law.is_exact)
    text += fmt::format(
        "  the bond laws are proportional: the law has their {} retardation time{}, exact for all "
        "times\n",
        law.terms.size(), law.terms.size() == 1 ? "" : "s");
  else
    text +=
        fmt::format("  several bond laws: {} retardation times fitted from {:g} s to {:g} s; rms "
                    "{:.2g} %, largest {:.2g} %; time stepping to {:.1g}\n",
                    law.terms.size(), e.law.first_time, e.law.last_time, 100 * e.law.relative_rms,
                    100 * e.law.largest_error, e.law.stepping_error);
  if (scene.scene->element.symmetry != LawSymmetry::full)
    text += fmt::format("  the law that is written has the symmetry asked for; {:.3g} % away\n",
                        100 * e.symmetry_distance);
  return text;
}

} // namespace

std::string extraction_report(const LoadedScene& scene, const Extraction& e)
{
  double hill_mandel = 0;
  std::size_t n_loose = 0;
  for (const Realisation& each : e.realisations) {
    hill_mandel = std::max(hill_mandel, each.hill_mandel);
    n_loose += each.n_loose;
  }
  std::string text =
      "  Young's modulus at t = 0+, of the nearest isotropic tensor; the law is taken "
      "under the boundary condition '" +
      name_of(scene.scene->element.condition) + "'; +- is the standard deviation of one volume\n";
  text += sizes_text(e) + law_text_lines(scene, e);
  text += fmt::format("  energy of the bonds and work of the mean stress agree to {:.1g} "
                      "(Hill-Mandel)\n",
                      hill_mandel);
  if (n_loose > 0)
    text += fmt::format("  note: {} particles in all elements carry nothing\n", n_loose);
  for (const std::string& note : e.notes)
    text += "  " + note + "\n";
  const std::string keys = estimated_bond_keys(scene);
  if (!keys.empty())
    text += "  preset 'estimate': estimates, not the paper's tables, stand for " + keys + "\n";
  return text;
}

} // namespace apps
