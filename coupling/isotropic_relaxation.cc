#include "coupling/isotropic_relaxation.h"

#include "fem/symmetry.h"

#include <algorithm>
#include <cmath>

namespace coupling {

namespace {

/// Unit vector of pressure in Mandel notation.
fem::Vec6 pressure()
{
  fem::Vec6 unit = fem::Vec6::Zero();
  unit.head<3>().setConstant(1 / std::sqrt(3.0));
  return unit;
}

/// Factors of the two isotropic projections of a matrix: volume and shear.
struct IsotropicParts {
  double volume, shear;
};

IsotropicParts isotropic_parts(const fem::Mat6& matrix)
{
  const double volume = pressure().dot(matrix * pressure());
  return {volume, (matrix.trace() - volume) / 5};
}

fem::Mat6 isotropic_matrix(double volume, double shear)
{
  const fem::Mat6 projection = pressure() * pressure().transpose();
  return volume * projection + shear * (fem::Mat6::Identity() - projection);
}

bool same_time(double a, double b)
{
  return std::abs(a - b) <= 1e-12 * std::max(a, b);
}

/// Adds a part to the term of its time, or as a new term.
void add(std::vector<fem::RetardationTerm>& terms, double time, const fem::Mat6& part)
{
  const auto found = std::ranges::find_if(
      terms, [&](const fem::RetardationTerm& term) { return same_time(term.time, time); });
  if (found == terms.end())
    terms.push_back({time, part});
  else
    found->compliance += part;
}

/// The fraction of a modulus that is left in the end, at least the smallest that programs take.
double residual(const fem::RelaxationModulus& modulus, double last_time)
{
  const double initial = fem::value(modulus, 0);
  if (modulus.equilibrium > 1e-10 * initial)
    return 0;
  const double compliance = fem::value(fem::creep_compliance(modulus), last_time);
  return std::clamp(1e-4 / (initial * compliance), 1e-10, 1e-3);
}

fem::RelaxationModulus modulus(const PronySeries& series, double initial, double PronyTerm::*part)
{
  fem::RelaxationModulus result{initial, {}};
  for (const PronyTerm& term : series.terms)
    if (term.*part > 0) {
      result.parts.push_back({term.time, initial * (term.*part)});
      result.equilibrium -= initial * (term.*part);
    }
  return result;
}

} // namespace

IsotropicCreep isotropic_creep(const fem::ComplianceLaw& law)
{
  IsotropicCreep creep;
  const IsotropicParts initial = isotropic_parts(law.instantaneous);
  const IsotropicParts flow = isotropic_parts(law.fluidity);
  const double longest = law.terms.empty() ? 1 : law.terms.back().time;
  const auto kept = [](double part, double of) { return part > 1e-13 * of ? part : 0; };
  creep.shear.instantaneous = 2 * initial.shear;
  creep.bulk.instantaneous = 3 * initial.volume;
  creep.shear.fluidity = 2 * kept(flow.shear, initial.shear / longest);
  creep.bulk.fluidity = 3 * kept(flow.volume, initial.volume / longest);
  for (const fem::RetardationTerm& term : law.terms) {
    const IsotropicParts part = isotropic_parts(term.compliance);
    if (kept(part.shear, initial.shear) > 0)
      creep.shear.parts.push_back({term.time, 2 * part.shear});
    if (kept(part.volume, initial.volume) > 0)
      creep.bulk.parts.push_back({term.time, 3 * part.volume});
  }
  return creep;
}

fem::ComplianceLaw compliance_law(const IsotropicCreep& creep)
{
  std::vector<fem::RetardationTerm> terms;
  for (const fem::RetardationPart& part : creep.shear.parts)
    add(terms, part.time, isotropic_matrix(0, part.compliance / 2));
  for (const fem::RetardationPart& part : creep.bulk.parts)
    add(terms, part.time, isotropic_matrix(part.compliance / 3, 0));
  std::ranges::sort(terms, {}, &fem::RetardationTerm::time);
  // Not `make_compliance_law`: its threshold is below the rounding of terms far above S_0.
  return {isotropic_matrix(creep.bulk.instantaneous / 3, creep.shear.instantaneous / 2),
          isotropic_matrix(creep.bulk.fluidity / 3, creep.shear.fluidity / 2), terms};
}

IsotropicRelaxation isotropic_relaxation(const IsotropicCreep& creep)
{
  return {fem::relaxation_modulus(creep.shear), fem::relaxation_modulus(creep.bulk)};
}

IsotropicCreep isotropic_creep(const IsotropicRelaxation& relaxation)
{
  return {fem::creep_compliance(relaxation.shear), fem::creep_compliance(relaxation.bulk)};
}

PronySeries prony_series(const IsotropicRelaxation& relaxation, double last_time)
{
  PronySeries series{fem::value(relaxation.shear, 0), fem::value(relaxation.bulk, 0), {}};
  const double in_shear = (1 - residual(relaxation.shear, last_time)) / series.shear_modulus;
  const double in_bulk = (1 - residual(relaxation.bulk, last_time)) / series.bulk_modulus;
  for (const fem::RelaxationPart& part : relaxation.shear.parts)
    series.terms.push_back({part.time, in_shear * part.modulus, 0});
  for (const fem::RelaxationPart& part : relaxation.bulk.parts) {
    const auto found = std::ranges::find_if(
        series.terms, [&](const PronyTerm& term) { return same_time(term.time, part.time); });
    if (found == series.terms.end())
      series.terms.push_back({part.time, 0, in_bulk * part.modulus});
    else
      found->bulk = in_bulk * part.modulus;
  }
  std::ranges::sort(series.terms, {}, &PronyTerm::time);
  return series;
}

IsotropicRelaxation isotropic_relaxation(const PronySeries& series)
{
  return {modulus(series, series.shear_modulus, &PronyTerm::shear),
          modulus(series, series.bulk_modulus, &PronyTerm::bulk)};
}

} // namespace coupling
