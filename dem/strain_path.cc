#include "dem/strain_path.h"

#include <algorithm>
#include <cmath>

namespace dem {

PathPoint point_at(const StrainPath& path, double time)
{
  const auto after = std::ranges::upper_bound(path, time, std::ranges::less(), &PathPoint::time);
  if (after == path.begin())
    return path.front();
  const PathPoint& a = *(after - 1);
  PathPoint result = a;
  if (after == path.end())
    return result;
  const PathPoint& b = *after;
  const double length = b.time - a.time, s = (time - a.time) / length;
  const double rise = b.smooth - a.smooth;
  result.time = time;
  result.smooth = a.smooth + s * rise +
                  s * (1 - s) * ((1 - s) * (a.rate * length - rise) + s * (rise - b.rate * length));
  result.rate =
      (rise + (1 - 2 * s) * ((1 - s) * (a.rate * length - rise) + s * (rise - b.rate * length)) +
       s * (1 - s) * (2 * rise - (a.rate + b.rate) * length)) /
      length;
  result.displacement = a.displacement + result.smooth - a.smooth;
  const auto mixed = [&](double from, double to) { return from + s * (to - from); };
  result.force = mixed(a.force, b.force);
  const EnergyLedger &x = a.energy, &y = b.energy;
  result.energy = {mixed(x.work, y.work),         mixed(x.stored, y.stored),
                   mixed(x.dashpots, y.dashpots), mixed(x.friction, y.friction),
                   mixed(x.breakage, y.breakage), mixed(x.regularisation, y.regularisation)};
  return result;
}

double averaged_strain_rate(const StrainPath& path, const RateLaw& law, double gauge_length,
                            double time)
{
  const double start = path.front().time;
  const PathPoint now = point_at(path, time);
  const double window = std::max(law.window, law.window_fraction * (time - start));
  const double from = std::max(start, time - window);
  if (!(time - from > 1e-14 * std::abs(time)))
    return now.rate / gauge_length;
  return (now.smooth - point_at(path, from).smooth) / (time - from) / gauge_length;
}

double averaged_strain_rate(const StrainPath& path, const RateLaw& law, double gauge_length)
{
  return averaged_strain_rate(path, law, gauge_length, path.back().time);
}

} // namespace dem
