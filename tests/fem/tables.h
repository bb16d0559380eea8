#pragma once
#include "fem/compliance_law.h"
#include "fem/mandel.h"
#include "tests/reference.h"

#include <gtest/gtest.h>

#include <random>

/// Laws and matrices that several tests use.
namespace tables {

inline fem::Mat6 matrix(const nlohmann::json& rows)
{
  fem::Mat6 result;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      result(i, j) = reference::number(rows.at(std::size_t(i)).at(std::size_t(j)));
  return result;
}

/// The law of tensor_compliance.json, in Mandel notation.
inline fem::ComplianceLaw anisotropic_law()
{
  const auto table = reference::json("tensor_compliance.json");
  const auto part = [&](const char* name) {
    return fem::mandel_compliance_from_voigt(matrix(table.at(name)));
  };
  const std::vector<fem::RetardationTerm> terms{{table.at("taus")[0].get<double>(), part("S1")},
                                                {table.at("taus")[1].get<double>(), part("S2")}};
  return fem::make_compliance_law(part("S0"), part("Sv"), terms);
}

/// Positive definite matrix with no symmetry, entries about `size`; of lower rank if asked.
inline fem::Mat6 random_matrix(std::mt19937_64& random, double size, int rank = 6)
{
  Eigen::MatrixXd half(6, rank);
  for (Eigen::Index i = 0; i < half.size(); ++i)
    half.data()[i] = double(random() % 2000001) / 1e6 - 1;
  return size * (half * half.transpose() + (rank == 6 ? 0.1 : 0) * fem::Mat6::Identity());
}

inline double difference(const fem::Mat6& a, const fem::Mat6& b)
{
  return (a - b).norm() / b.norm();
}

} // namespace tables
