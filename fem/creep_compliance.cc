#include "fem/creep_compliance.h"

#include "fem/interconversion.h"
#include "fem/mandel.h"

#include <cmath>
#include <stdexcept>

namespace fem {

namespace {

Eigen::MatrixXd one(double value)
{
  return Eigen::MatrixXd::Constant(1, 1, value);
}

} // namespace

double value(const CreepCompliance& law, double t)
{
  double sum = law.instantaneous + t * law.fluidity;
  for (const auto& [time, part] : law.parts)
    sum -= part * std::expm1(-t / time);
  return sum;
}

double value(const RelaxationModulus& law, double t)
{
  double sum = law.equilibrium;
  for (const auto& [time, part] : law.parts)
    sum += part * std::exp(-t / time);
  return sum;
}

std::complex<double> complex_compliance(const CreepCompliance& law, double omega)
{
  std::complex<double> sum{law.instantaneous, -law.fluidity / omega};
  for (const auto& [time, part] : law.parts)
    sum += part / std::complex<double>(1, omega * time);
  return sum;
}

std::complex<double> complex_modulus(const RelaxationModulus& law, double omega)
{
  std::complex<double> sum = law.equilibrium;
  for (const auto& [time, part] : law.parts)
    sum += part / std::complex<double>(1, -1 / (omega * time));
  return sum;
}

std::complex<double> complex_modulus(const CreepCompliance& law, double omega)
{
  return 1.0 / complex_compliance(law, omega);
}

RelaxationModulus relaxation_modulus(const CreepCompliance& law)
{
  CreepSpectrum creep{one(law.instantaneous), one(law.fluidity), {}};
  for (const auto& [time, part] : law.parts)
    creep.modes.push_back({1 / time, one(part)});
  const RelaxationSpectrum spectrum = relaxation_spectrum(creep);
  RelaxationModulus result{spectrum.equilibrium(0, 0), {}};
  for (auto mode = spectrum.modes.rbegin(); mode != spectrum.modes.rend(); ++mode)
    result.parts.push_back({1 / mode->rate, mode->weight(0, 0)});
  return result;
}

CreepCompliance creep_compliance(const RelaxationModulus& law)
{
  RelaxationSpectrum relaxation{one(law.equilibrium), {}};
  for (const auto& [time, part] : law.parts)
    relaxation.modes.push_back({1 / time, one(part)});
  const CreepSpectrum spectrum = creep_spectrum(relaxation);
  CreepCompliance result{spectrum.instantaneous(0, 0), spectrum.fluidity(0, 0), {}};
  for (auto mode = spectrum.modes.rbegin(); mode != spectrum.modes.rend(); ++mode)
    result.parts.push_back({1 / mode->rate, mode->weight(0, 0)});
  return result;
}

CreepCompliance burgers_compliance(double maxwell_modulus, double maxwell_viscosity,
                                   double kelvin_modulus, double kelvin_viscosity)
{
  return {1 / maxwell_modulus,
          1 / maxwell_viscosity,
          {{kelvin_viscosity / kelvin_modulus, 1 / kelvin_modulus}}};
}

ComplianceLaw isotropic_law(const CreepCompliance& uniaxial, double poisson_ratio)
{
  const Mat6 shape = isotropic_shape(poisson_ratio);
  std::vector<RetardationTerm> terms;
  for (const auto& [time, part] : uniaxial.parts)
    terms.push_back({time, part * shape});
  return make_compliance_law(uniaxial.instantaneous * shape, uniaxial.fluidity * shape, terms);
}

CreepCompliance uniaxial(const ComplianceLaw& law, const Vec3& direction)
{
  if (!(direction.norm() > 0))
    throw std::invalid_argument("compliance law: a direction needs a length > 0");
  const Vec3 unit = direction.normalized();
  const Vec6 stress = mandel_vector(unit * unit.transpose());
  const auto along = [&](const Mat6& matrix) { return stress.dot(matrix * stress); };
  CreepCompliance result{along(law.instantaneous), along(law.fluidity), {}};
  for (const auto& [time, part] : law.terms)
    result.parts.push_back({time, along(part)});
  return result;
}

} // namespace fem
