#include "coupling/shared_creep.h"

#include "fem/step_law.h"

#include <cmath>

namespace coupling {

SharedCreep::SharedCreep(const dem::CreepLaw& law)
{
  if (law.maxwell_viscosity)
    fluidity_ = law.maxwell_stiffness / *law.maxwell_viscosity;
  for (const dem::KelvinBranch& branch : law.branches)
    branch_.push_back({dem::retardation_time(branch), law.maxwell_stiffness / branch.stiffness});
}

SharedCreep::Part SharedCreep::part(double duration) const
{
  Part part{duration, fluidity_ * duration, 0.5 * fluidity_ * duration, {}, {}, {}};
  for (const Branch& branch : branch_) {
    const double x = duration / branch.time;
    part.decay.push_back(-std::expm1(-x));
    part.held.push_back(branch.share * part.decay.back());
    part.growth.push_back(branch.share * x * fem::phi_2(x));
  }
  return part;
}

double SharedCreep::compliance(const Part& part) const
{
  double sum = 1 + part.flow_growth;
  for (const double each : part.growth)
    sum += each;
  return sum;
}

double SharedCreep::held(const Part& part) const
{
  double sum = part.flow;
  for (const double each : part.held)
    sum += each;
  return sum;
}

fem::Vec6 SharedCreep::gain(const Part& part, const fem::Vec6& elastic, const fem::Vec6& growth,
                            std::span<const fem::Vec6> kelvin) const
{
  fem::Vec6 sum = part.flow * elastic + part.flow_growth * growth;
  for (std::size_t k = 0; k < branch_.size(); ++k)
    sum += part.held[k] * elastic - part.decay[k] * kelvin[k] + part.growth[k] * growth;
  return sum;
}

void SharedCreep::advance(const Part& part, const fem::Vec6& elastic, const fem::Vec6& growth,
                          std::span<fem::Vec6> kelvin) const
{
  for (std::size_t k = 0; k < branch_.size(); ++k)
    kelvin[k] += part.held[k] * elastic - part.decay[k] * kelvin[k] + part.growth[k] * growth;
}

fem::Vec6 SharedCreep::rate(const Part& part, const fem::Vec6& elastic, const fem::Vec6& growth,
                            std::span<const fem::Vec6> kelvin) const
{
  fem::Vec6 sum = fluidity_ * (elastic + growth);
  for (std::size_t k = 0; k < branch_.size(); ++k) {
    const fem::Vec6 now =
        kelvin[k] + part.held[k] * elastic - part.decay[k] * kelvin[k] + part.growth[k] * growth;
    sum += (branch_[k].share * (elastic + growth) - now) / branch_[k].time;
  }
  return sum;
}

} // namespace coupling
