#include "fem/relaxation_law.h"

#include "fem/interconversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fem {

RelaxationLaw make_relaxation_law(const Mat6& equilibrium, std::span<const RelaxationTerm> terms)
{
  // The demands on C(0), C_inf and C_k are those on S_0, S_v and S_k.
  std::vector<RetardationTerm> checked;
  Mat6 sum = equilibrium;
  for (const auto& [time, part] : terms) {
    checked.push_back({time, part});
    sum += part;
  }
  try {
    checked.push_back({1e300, equilibrium});
    checked = make_compliance_law(sum, Mat6::Zero(), checked).terms;
  } catch (const std::invalid_argument& problem) {
    throw std::invalid_argument(
        fmt::format("relaxation law (C(0) as instantaneous compliance, C_k as compliance, C_inf at "
                    "1e300 s): {}",
                    problem.what()));
  }
  checked.pop_back();
  RelaxationLaw law{equilibrium, {}};
  for (const auto& [time, part] : checked)
    law.terms.push_back({time, part});
  return law;
}

Mat6 stiffness(const RelaxationLaw& law, double t)
{
  Mat6 sum = law.equilibrium;
  for (const auto& [time, part] : law.terms)
    sum += std::exp(-t / time) * part;
  return sum;
}

ComplexMat6 complex_stiffness(const RelaxationLaw& law, double omega)
{
  Mat6 storage = law.equilibrium, loss = Mat6::Zero();
  for (const auto& [time, part] : law.terms) {
    const double tangent = omega * time, weight = 1 / (1 + tangent * tangent);
    storage += tangent * tangent * weight * part;
    loss += tangent * weight * part;
  }
  ComplexMat6 result;
  result.real() = storage;
  result.imag() = loss;
  return result;
}

RelaxationLaw relaxation_law(const ComplianceLaw& law)
{
  CreepSpectrum creep{law.instantaneous, law.fluidity, {}};
  for (const auto& [time, part] : law.terms)
    creep.modes.push_back({1 / time, part});
  const RelaxationSpectrum spectrum = relaxation_spectrum(creep);
  RelaxationLaw result{spectrum.equilibrium, {}};
  for (auto mode = spectrum.modes.rbegin(); mode != spectrum.modes.rend(); ++mode)
    result.terms.push_back({1 / mode->rate, mode->weight});
  return result;
}

ComplianceLaw compliance_law(const RelaxationLaw& law)
{
  RelaxationSpectrum relaxation{law.equilibrium, {}};
  for (const auto& [time, part] : law.terms)
    relaxation.modes.push_back({1 / time, part});
  const CreepSpectrum spectrum = creep_spectrum(relaxation);
  ComplianceLaw result{spectrum.instantaneous, spectrum.fluidity, {}};
  for (auto mode = spectrum.modes.rbegin(); mode != spectrum.modes.rend(); ++mode)
    result.terms.push_back({1 / mode->rate, mode->weight});
  return result;
}

} // namespace fem
