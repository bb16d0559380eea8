#pragma once
#include "coupling/isotropic_relaxation.h"
#include "coupling/material_cards.h"
#include "tests/fem/tables.h"

#include <cmath>
#include <sstream>

/// Records for which cards are written, and reading the cards back.
namespace cards {

inline fem::LawRecord record_of(const fem::ComplianceLaw& law)
{
  fem::LawRecord record;
  record.law = law;
  record.first_time = 0.01;
  record.last_time = 1e4;
  record.shift = fem::WlfShift{10.1, 120.0, 293.15};
  record.temperatures = {277.15, 318.15};
  record.provenance = {"made by a test"};
  return record;
}

/// No symmetry, flows.
inline fem::LawRecord anisotropic_record()
{
  return record_of(tables::anisotropic_law());
}

/// Isotropic, with a Poisson's ratio that creeps; a solid if asked.
inline fem::LawRecord isotropic_record(bool solid)
{
  coupling::IsotropicCreep creep;
  creep.shear = {1e-9, solid ? 0 : 2e-13, {{0.1, 2e-9}, {10, 5e-9}, {1000, 2e-8}}};
  creep.bulk = {3e-10, 0, {{0.1, 1e-10}, {10, 2e-10}}};
  return record_of(coupling::compliance_law(creep));
}

inline std::string text_of(const std::vector<coupling::CardFile>& files, const std::string& name)
{
  for (const coupling::CardFile& file : files)
    if (file.name == name)
      return file.text;
  throw std::runtime_error("the card has no file " + name);
}

inline std::vector<std::string> lines_of(const std::string& text)
{
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

/// Numbers between commas or blanks.
inline std::vector<double> numbers(std::string line)
{
  for (char& c : line)
    if (c == ',' || c == '\'')
      c = ' ';
  std::vector<double> values;
  std::istringstream stream(line);
  for (std::string word; stream >> word;)
    values.push_back(reference::number(word));
  return values;
}

/// Position of the line that begins with a text.
inline std::size_t find(const std::vector<std::string>& lines, const std::string& begin)
{
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (lines[i].starts_with(begin))
      return i;
  throw std::runtime_error("no line begins with " + begin);
}

/// Largest relative difference of D(t) from 0.01 s to 10,000 s.
inline double creep_difference(const coupling::IsotropicRelaxation& found,
                               const fem::ComplianceLaw& law)
{
  const fem::ComplianceLaw read = coupling::compliance_law(coupling::isotropic_creep(found));
  double largest = 0;
  for (double t = 0.01; t < 1e4; t *= 1.5) {
    const fem::Mat6 a = fem::compliance(read, t), b = fem::compliance(law, t);
    largest = std::max({largest, std::abs(a(0, 0) / b(0, 0) - 1), std::abs(a(1, 0) / b(1, 0) - 1),
                        std::abs(a(3, 3) / b(3, 3) - 1)});
  }
  return largest;
}

/// G(t) and K(t) from Young's modulus and Poisson's ratio and pairs (g, rho), (k, rho).
inline coupling::IsotropicRelaxation moduli(double young, double poisson,
                                            const coupling::PronySeries& parts)
{
  coupling::PronySeries series = parts;
  series.shear_modulus = young / (2 * (1 + poisson));
  series.bulk_modulus = young / (3 * (1 - 2 * poisson));
  return coupling::isotropic_relaxation(series);
}

inline coupling::IsotropicRelaxation read_abaqus(const std::string& text, double stress)
{
  const auto lines = lines_of(text);
  const auto elastic = numbers(lines.at(find(lines, "*ELASTIC, MODULI=INSTANTANEOUS") + 1));
  coupling::PronySeries series;
  for (std::size_t i = find(lines, "*VISCOELASTIC, TIME=PRONY") + 1;
       i < lines.size() && lines[i][0] != '*'; ++i) {
    const auto row = numbers(lines[i]);
    series.terms.push_back({row.at(2), row.at(0), row.at(1)});
  }
  return moduli(stress * elastic.at(0), elastic.at(1), series);
}

} // namespace cards
