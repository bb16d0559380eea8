#pragma once
#include "dem/strength.h"

#include <vector>

namespace dem {

/// Where the energy of a specimen went since the start [J].
struct EnergyLedger {
  double work = 0;           ///< of the loads
  double stored = 0;         ///< in springs
  double dashpots = 0;       ///< dissipated in dashpots
  double friction = 0;       ///< dissipated in sliding contacts
  double breakage = 0;       ///< released by broken bonds
  double regularisation = 0; ///< taken by the viscous hold of loose particles

  /// What does not add up: error of the integration in time.
  double gap() const { return work - stored - dashpots - friction - breakage - regularisation; }
};

/// A time that a run in steps has reached; two points at one time make a jump.
struct PathPoint {
  double time;         ///< [s]
  double displacement; ///< at the load [m]
  double smooth;       ///< the same without elastic jumps [m]
  double rate;         ///< of the smooth one [m/s]
  double force;        ///< on the upper platen [N], or load factor
  long n_broken;
  EnergyLedger energy;
};

using StrainPath = std::vector<PathPoint>;

/// Between two points the smooth displacement is the cubic of its values and rates.
PathPoint point_at(const StrainPath& path, double time);

/// Strain rate that counts for the strengths at the last point [1/s]: without elastic jumps,
/// averaged over the window of the rate law (over the time since the start while that is shorter).
double averaged_strain_rate(const StrainPath& path, const RateLaw& law, double gauge_length);

/// The same at an earlier time.
double averaged_strain_rate(const StrainPath& path, const RateLaw& law, double gauge_length,
                            double time);

} // namespace dem
