#include "dem/supernodal_factor.h"

#include "dem/dense_front.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <random>

using namespace dem;

namespace {

struct SparseMatrix {
  SymmetricPattern pattern{{0}, {}};
  std::vector<double> values;

  Eigen::VectorXd times(const Eigen::VectorXd& x) const
  {
    Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
    for (int c = 0; c < pattern.size(); ++c)
      for (int p = pattern.column_start[c]; p < pattern.column_start[c + 1]; ++p) {
        y[pattern.row[p]] += values[p] * x[c];
        if (pattern.row[p] != c)
          y[c] += values[p] * x[pattern.row[p]];
      }
    return y;
  }
};

/// Springs of random stiffness between neighbours on a cubic lattice, and weak ones to ground.
SparseMatrix lattice(int n, double ground)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> stiffness(0.1, 2);
  const int step[3] = {1, n, n * n};
  std::vector<double> diagonal(n * n * n, ground);
  std::vector<std::array<double, 3>> spring(n * n * n);
  for (int i = 0; i < n * n * n; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (i / step[axis] % n + 1 < n) {
        const double k = spring[i][axis] = stiffness(random);
        diagonal[i] += k;
        diagonal[i + step[axis]] += k;
      }
  SparseMatrix matrix;
  for (int i = 0; i < n * n * n; ++i) {
    matrix.pattern.row.push_back(i);
    matrix.values.push_back(diagonal[i]);
    for (int axis = 0; axis < 3; ++axis)
      if (spring[i][axis] > 0) {
        matrix.pattern.row.push_back(i + step[axis]);
        matrix.values.push_back(-spring[i][axis]);
      }
    matrix.pattern.column_start.push_back(int(matrix.pattern.row.size()));
  }
  return matrix;
}

/// Residual of a solution with random forces, over the forces.
double residual(const SupernodalFactor& factor, const SparseMatrix& matrix)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> force(-1, 1);
  const Eigen::VectorXd b =
      Eigen::VectorXd::NullaryExpr(matrix.pattern.size(), [&] { return force(random); });
  return (matrix.times(factor.back_solve(factor.half_solve(b))) - b).norm() / b.norm();
}

template <typename Number>
void expect_partial_factor(int n_rows, int n_columns, double tolerance)
{
  const Eigen::MatrixXd random = Eigen::MatrixXd::Random(n_rows, n_rows);
  const Eigen::MatrixXd a =
      random * random.transpose() + n_rows * Eigen::MatrixXd::Identity(n_rows, n_rows);
  Eigen::MatrixXd expected = a;
  const int n_left = n_rows - n_columns;
  const Eigen::MatrixXd l = a.topLeftCorner(n_columns, n_columns).llt().matrixL();
  const Eigen::MatrixXd below = l.triangularView<Eigen::Lower>()
                                    .solve(a.bottomLeftCorner(n_left, n_columns).transpose())
                                    .transpose();
  expected.topLeftCorner(n_columns, n_columns) = l;
  expected.bottomLeftCorner(n_left, n_columns) = below;
  expected.bottomRightCorner(n_left, n_left) -= below * below.transpose();
  std::vector<Number> memory(DenseFront<Number>::size(n_rows));
  DenseFront<Number> front(memory, n_rows);
  front.clear();
  for (int j = 0; j < n_rows; ++j)
    for (int i = j; i < n_rows; ++i)
      front.column(j)[i] = Number(a(i, j));
  ASSERT_TRUE(front.eliminate(n_columns));
  for (int j = 0; j < n_rows; ++j)
    for (int i = j; i < n_rows; ++i)
      ASSERT_NEAR(front.column(j)[i], expected(i, j), tolerance * a.norm())
          << n_rows << " rows, " << n_columns << " eliminated: " << i << ", " << j;
}

} // namespace

TEST(DenseFront, EliminatesItsFirstColumns)
{
  for (const int n_rows : {1, 2, 7, 8, 9, 17, 40, 63, 131})
    for (const int n_columns : {1, 5, 8, 33, 64, 131})
      if (n_columns <= n_rows) {
        expect_partial_factor<double>(n_rows, n_columns, 1e-14);
        expect_partial_factor<float>(n_rows, n_columns, 1e-5);
      }
}

TEST(DenseFront, SaysWhereAPivotIsNotPositive)
{
  std::vector<double> memory(DenseFront<double>::size(2));
  DenseFront<double> front(memory, 2);
  front.clear();
  front.column(0)[0] = front.column(0)[1] = front.column(1)[1] = 1;
  EXPECT_FALSE(front.eliminate(2));
}

TEST(SupernodalFactor, SolvesALattice)
{
  const SparseMatrix matrix = lattice(12, 1e-2);
  SupernodalFactor full(matrix.pattern),
      single(matrix.pattern, FactorPrecision::single_to_precondition);
  ASSERT_TRUE(full.factorise(matrix.values));
  ASSERT_TRUE(single.factorise(matrix.values));
  EXPECT_LT(residual(full, matrix), 1e-13);
  EXPECT_LT(residual(single, matrix), 1e-4);
  ASSERT_TRUE(full.factorise(lattice(12, 1).values)); // again, on the same analysis
  EXPECT_LT(residual(full, lattice(12, 1)), 1e-13);
}

TEST(SupernodalFactor, TurnsToDoubleWhereSinglePrecisionFails)
{
  const SparseMatrix matrix{{{0, 2, 3}, {0, 1, 1}}, {1, 1, 1 + 1e-10}};
  SupernodalFactor factor(matrix.pattern, FactorPrecision::single_to_precondition);
  ASSERT_TRUE(factor.factorise(matrix.values));
  EXPECT_LT(residual(factor, matrix), 1e-2);
  EXPECT_FALSE(factor.factorise(std::vector<double>{1, 1, 1}));
}
