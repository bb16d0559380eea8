#pragma once
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

/// The few names of TFEL that the integrator of a generated behaviour uses, so that it can be
/// compiled and run where MFront is not installed. It tests the update, not MFront's syntax.
using real = double;

struct StrainStensor {
  std::array<double, 6> v{};
  double& operator[](int i) { return v[std::size_t(i)]; }
  double operator[](int i) const { return v[std::size_t(i)]; }
};

inline StrainStensor operator-(const StrainStensor& a, const StrainStensor& b)
{
  StrainStensor c;
  for (int i = 0; i < 6; ++i)
    c[i] = a[i] - b[i];
  return c;
}

struct Stensor4 {
  std::array<double, 36> v{};
  double& operator()(int i, int j) { return v[std::size_t(6 * i + j)]; }
  double operator()(int i, int j) const { return v[std::size_t(6 * i + j)]; }
};

/// Gauss-Jordan with pivots.
inline Stensor4 invert(Stensor4 a)
{
  Stensor4 b;
  for (int i = 0; i < 6; ++i)
    b(i, i) = 1;
  for (int c = 0; c < 6; ++c) {
    int pivot = c;
    for (int r = c + 1; r < 6; ++r)
      pivot = std::abs(a(r, c)) > std::abs(a(pivot, c)) ? r : pivot;
    const double scale = 1 / a(pivot, c);
    for (int j = 0; j < 6; ++j) {
      std::swap(a(c, j), a(pivot, j));
      std::swap(b(c, j), b(pivot, j));
      a(c, j) *= scale;
      b(c, j) *= scale;
    }
    for (int r = 0; r < 6; ++r)
      if (const double factor = a(r, c); r != c)
        for (int j = 0; j < 6; ++j) {
          a(r, j) -= factor * a(c, j);
          b(r, j) -= factor * b(c, j);
        }
  }
  return b;
}
