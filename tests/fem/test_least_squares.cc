#include "fem/least_squares.h"

#include "tests/fem/tables.h"

using namespace fem;
using Eigen::MatrixXd, Eigen::VectorXd;

TEST(LeastSquares, NonnegativeFitReachesTheOptimumOfTheTable)
{
  const auto table = reference::json("creep_fit_reference.json");
  const auto rows = reference::table("creep_fit_data.csv");
  const std::map<std::string, std::string> columns{{"0", "J_noise_0"},
                                                   {"0.001", "J_noise_0.1pct"},
                                                   {"0.01", "J_noise_1pct"},
                                                   {"0.05", "J_noise_5pct"}};
  const auto& times = table.at("tau");
  for (const auto& [noise, column] : columns) {
    MatrixXd a(Eigen::Index(rows.size()), 13);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double t = reference::number(rows[i], "t"), j = reference::number(rows[i], column);
      a(Eigen::Index(i), 0) = 1 / j;
      a(Eigen::Index(i), 1) = t / j;
      for (std::size_t k = 0; k < 11; ++k)
        a(Eigen::Index(i), Eigen::Index(2 + k)) = -std::expm1(-t / times[k].get<double>()) / j;
    }
    const VectorXd ones = VectorXd::Ones(a.rows()), x = nonnegative_least_squares(a, ones);
    EXPECT_GE(x.minCoeff(), 0);
    const double optimum = table.at("fits").at(noise).at("objective").get<double>();
    EXPECT_LE((a * x - ones).squaredNorm(), (1 + 1e-6) * optimum) << noise;
    EXPECT_NEAR(x[0] / table.at("fits").at(noise).at("J0").get<double>(), 1, 1e-6);
  }
}

TEST(LeastSquares, NonnegativeFitKeepsItsConditions)
{
  std::mt19937_64 random(21);
  for (int repeat = 0; repeat < 50; ++repeat) {
    MatrixXd a(12, 8);
    VectorXd b(12);
    for (Eigen::Index i = 0; i < a.size(); ++i)
      a.data()[i] = double(random() % 2001) / 1e3 - 1;
    for (double& each : b)
      each = double(random() % 2001) / 1e3 - 1;
    a.col(3) = a.col(2); // equal columns
    a.col(5).setZero();
    const VectorXd x = nonnegative_least_squares(a, b), gradient = a.transpose() * (b - a * x);
    EXPECT_GE(x.minCoeff(), 0);
    EXPECT_LE(gradient.maxCoeff(), 1e-11);
    EXPECT_NEAR(x.dot(gradient), 0, 1e-11);
  }
}

TEST(LeastSquares, LevenbergMarquardtFindsTheMinimum)
{
  const auto rosenbrock = [](const VectorXd& x) -> VectorXd {
    return Eigen::Vector2d(10 * (x[1] - x[0] * x[0]), 1 - x[0]);
  };
  const LeastSquaresResult found = levenberg_marquardt(rosenbrock, Eigen::Vector2d(-1.2, 1));
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.parameters[0], 1, 1e-8);
  EXPECT_NEAR(found.parameters[1], 1, 1e-8);
  EXPECT_THROW(levenberg_marquardt(
                   [](const VectorXd&) -> VectorXd {
                     return VectorXd::Constant(1, std::numeric_limits<double>::quiet_NaN());
                   },
                   VectorXd::Zero(1)),
               std::invalid_argument);
}

TEST(LeastSquares, CovarianceOfAStraightLine)
{
  // Slope of y = a + b x through x = -1, 0, 1: variance s^2 / 2, mean: s^2 / 3.
  MatrixXd jacobian(3, 2);
  jacobian << 1, -1, 1, 0, 1, 1;
  const MatrixXd found = covariance(jacobian, 0.06);
  EXPECT_NEAR(found(0, 0), 0.02, 1e-15);
  EXPECT_NEAR(found(1, 1), 0.03, 1e-15);
  EXPECT_NEAR(found(0, 1), 0, 1e-15);
}
