#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

namespace dem {

/// Looks for the duration at which the first bond reaches its strength, by regula falsi (Illinois).
struct BreakageSearch {
  double safe, below; ///< duration without breakage, force over strength less 1
  double unsafe = std::numeric_limits<double>::infinity(), above = 0; ///< the same with breakage
  int last_side = 0;

  /// \return false if there is nothing between the two any more
  bool narrow(double duration, double overshoot)
  {
    const int side = overshoot < 0 ? -1 : 1;
    (side < 0 ? safe : unsafe) = duration;
    (side < 0 ? below : above) = overshoot;
    if (side == last_side)
      (side < 0 ? above : below) *= 0.5;
    last_side = side;
    return unsafe - safe > 1e-14 * unsafe;
  }
  double next() const
  {
    const double share =
        std::isfinite(above) ? std::clamp(-below / (above - below), 1e-6, 1 - 1e-6) : 0.5;
    return safe + share * (unsafe - safe);
  }
};

} // namespace dem
