#include "dem/link_strength.h"

#include <algorithm>
#include <cmath>

namespace dem {

namespace {

double normal_of(const Links& links, std::size_t k)
{
  return links.memory_of(k)[0];
}

double shear_of(const Links& links, std::size_t k)
{
  const double* memory = links.memory_of(k);
  return std::hypot(memory[links.n_parts], memory[2 * links.n_parts]);
}

} // namespace

std::vector<double> strength_ratios(const Links& links, const Strengths& strengths, double noise)
{
  std::vector<double> ratios(strengths.normal.size(), 0.0);
  double largest = 0;
  for (std::size_t k = 0; k < links.link.size(); ++k)
    largest = std::max({largest, std::abs(normal_of(links, k)), shear_of(links, k)});
  const auto ratio = [&](double force, double strength) {
    return force > noise * largest ? force / strength : 0;
  };
  for (std::size_t b = 0; b < ratios.size(); ++b)
    if (links.link[b].kind == LinkKind::bond)
      ratios[b] = std::max(ratio(normal_of(links, b), strengths.normal[b]),
                           ratio(shear_of(links, b), strengths.shear[b]));
  return ratios;
}

BreakingForces breaking_forces(const Links& links, std::size_t bond, const Strengths& strengths)
{
  const double normal = normal_of(links, bond), shear = shear_of(links, bond);
  const bool by_tension =
      normal > 0 && normal * strengths.shear[bond] >= shear * strengths.normal[bond];
  return {normal, shear, by_tension ? BreakMode::tension : BreakMode::shear};
}

} // namespace dem
