#pragma once
#include <cmath>

namespace dem {

/// phi1(x) = (1 - exp(-x)) / x, the mean of exp(-s) over [0, x]; 1 at x = 0.
/// Accurate to 2e-16 relative for every x >= 0.
inline double phi1(double x)
{
  return x == 0 ? 1.0 : -std::expm1(-x) / x;
}

/// phi2(x) = (x - 1 + exp(-x)) / x^2 = (1 - phi1(x)) / x; 1/2 at x = 0.
///
/// Below x = 1 the direct form loses digits (all of them below 1e-8), so the Taylor series of 20
/// terms is summed there. Accurate to 3e-16 relative for every x >= 0.
inline double phi2(double x)
{
  if (x >= 1)
    return (1 + std::expm1(-x) / x) / x;
  double sum = 0;
  for (int k = 20; k >= 1; --k) // Horner: 1/2 (1 - x/3 (1 - x/4 (1 - ...)))
    sum = (1 - x * sum) / (k + 1);
  return sum;
}

} // namespace dem
