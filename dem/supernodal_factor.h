#pragma once
#include "dem/frontal_cholesky.h"
#include "dem/lanes.h"
#include "dem/types.h"

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

namespace dem {

/// In what the factor is worked out and stored.
enum class FactorPrecision {
  full,
  /// Relative error 6e-8, half the memory to read: refine what comes out. Worked out in double
  /// where single precision meets a pivot that is not positive.
  single_to_precondition
};

/// Cholesky factor of a sparse symmetric positive definite matrix, K = L L^T up to a permutation.
///
/// CHOLMOD analyses (METIS ordering) and finds the supernodes; the numbers are worked out by
/// FrontalCholesky. In the triangular solves a right-hand side with few entries touches only the
/// columns on the paths from them to the root of the elimination tree, here a few thousand of
/// 34,000.
///
/// "Half-solved" vectors are y = L^-1 P b, in the order of the factor.
class SupernodalFactor {
public:
  /// Symbolic analysis. It serves every matrix with this pattern or a part of it.
  explicit SupernodalFactor(const SymmetricPattern& pattern,
                            FactorPrecision precision = FactorPrecision::full);
  ~SupernodalFactor();
  SupernodalFactor(SupernodalFactor&&) noexcept;
  SupernodalFactor& operator=(SupernodalFactor&&) noexcept;

  /// Numeric factorisation of the matrix with these values, in the order of the pattern.
  /// \return false if the matrix is not positive definite
  bool factorise(std::span<const double> values);

  /// Up to eight half-solved columns, one per lane, on the supernodes where they are not zero.
  struct SparseColumns {
    int n_columns = 0;
    std::vector<int> supernode; ///< in increasing order
    std::vector<int> first_row; ///< of each supernode in `row`
    std::vector<Lanes> row;
  };

  /// L^-1 P B for a matrix B with non-zero rows `rows` only; `entries` holds those rows.
  SparseColumns half_solve(std::span<const Index> rows,
                           const Eigen::Ref<const Eigen::MatrixXd>& entries) const;

  /// L^-1 P b.
  Eigen::VectorXd half_solve(const Eigen::VectorXd& b) const;

  /// P^T L^-T y. Reads the factor once: bound by memory.
  Eigen::VectorXd back_solve(Eigen::VectorXd y) const;

  /// First column of each supernode, and the number of columns at the end.
  std::span<const int> supernode_starts() const;

  long n_nonzeros() const; ///< of L

private:
  struct Data;
  std::unique_ptr<Data> data_;
};

} // namespace dem
