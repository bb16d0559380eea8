#include "dem/bordered_cholesky.h"

namespace dem {

void BorderedCholesky::clear()
{
  rows_.clear();
  size_ = 0;
}

void BorderedCholesky::solve(std::span<Lanes> b) const
{
  constexpr int strip = 4; // rows that share each load of b
  int i = 0;
  for (; i + strip <= size_; i += strip) {
    const double* l[strip];
    Lanes x[strip];
    for (int a = 0; a < strip; ++a) {
      l[a] = row(i + a);
      x[a] = b[i + a];
    }
    for (int j = 0; j < i; ++j)
      for (int a = 0; a < strip; ++a)
        x[a] -= l[a][j] * b[j];
    for (int a = 0; a < strip; ++a) {
      for (int c = 0; c < a; ++c)
        x[a] -= l[a][i + c] * x[c];
      b[i + a] = x[a] = x[a] / l[a][i + a];
    }
  }
  for (; i < size_; ++i) {
    Lanes x = b[i];
    for (int j = 0; j < i; ++j)
      x -= row(i)[j] * b[j];
    b[i] = x / row(i)[i];
  }
}

void BorderedCholesky::solve(Eigen::VectorXd& b) const
{
  for (int i = 0; i < size_; ++i) {
    const Eigen::Map<const Eigen::VectorXd> l(row(i), i);
    b[i] = (b[i] - l.dot(b.head(i))) / row(i)[i];
  }
}

void BorderedCholesky::solve_transposed(Eigen::VectorXd& b) const
{
  for (int i = size_ - 1; i >= 0; --i) {
    const Eigen::Map<const Eigen::VectorXd> l(row(i), i);
    b[i] /= row(i)[i];
    b.head(i) -= b[i] * l;
  }
}

void BorderedCholesky::append(std::span<const Lanes> border, const Eigen::MatrixXd& corner)
{
  for (int k = 0; k < int(corner.rows()); ++k) {
    for (const Lanes& x : border)
      rows_.push_back(x[k]);
    for (int c = 0; c <= k; ++c)
      rows_.push_back(corner(k, c));
    ++size_;
  }
}

} // namespace dem
