#include "coupling/calibration.h"

#include <fmt/format.h>

#include <optional>
#include <stdexcept>
#include <vector>

namespace coupling {

dem::CreepLaw calibrated_law(const fem::CreepCompliance& macroscopic, double factor)
{
  if (!(factor > 0))
    throw std::invalid_argument(
        fmt::format("the geometry factor of a packing must be > 0, found {:g} m", factor));
  std::optional<double> viscosity;
  if (macroscopic.fluidity > 0)
    viscosity = factor / macroscopic.fluidity;
  std::vector<dem::KelvinBranch> branches;
  for (const fem::RetardationPart& part : macroscopic.parts)
    if (part.compliance > 0)
      branches.push_back({factor / part.compliance, factor * part.time / part.compliance});
  return dem::make_creep_law(factor / macroscopic.instantaneous, viscosity, branches);
}

double geometry_factor(double macroscopic_compliance, const dem::CreepLaw& law)
{
  return macroscopic_compliance * law.maxwell_stiffness;
}

} // namespace coupling
