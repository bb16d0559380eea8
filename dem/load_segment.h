#pragma once
#include "dem/creep_element.h"

#include <variant>
#include <vector>

namespace dem {

/// Smallest and largest value that something takes.
struct Range {
  double low, high;
};

/// Time functions of a proportional network that every segment needs: its creep law with the spring
/// set to 1, so that forces are "elastic displacements".
struct NetworkCreep {
  CreepLaw law;                         ///< K_m = 1 [-], viscosities in [s]
  std::vector<RelaxationMode> spectrum; ///< stiffnesses sum to 1
};
NetworkCreep network_creep(const CreepLaw& law);

/// A stretch of time in which the network does not change and the force on it is linear in time.
///
/// The displacement at the load (of the platen, or the work-conjugate mean for loads on particles)
/// is that of one creep element whose spring has the compliance of the network.
struct ForceSegment {
  double start;             ///< [s]
  double load, load_rate;   ///< load factor at the start, and its slope [1/s]
  double compliance;        ///< elastic displacement per unit of the load factor [m]
  CreepState<double> state; ///< of the displacement at the start
  double jumps = 0;         ///< elastic displacement that came in jumps so far [m]
};

/// A stretch of time in which the network does not change and the displacement of the platen is
/// linear in time.
struct DisplacementSegment {
  double start;              ///< [s]
  double displacement, rate; ///< at the start [m], and its slope [m/s]
  RelaxationState modes;     ///< of the elastic displacement at the start [m]
  double viscous = 0;        ///< displacement of the dashpots at the start [m]
  double jumps = 0;          ///< displacement that came in jumps so far [m]
};

using LoadSegment = std::variant<ForceSegment, DisplacementSegment>;

/// Multiplier of the unit response of the network: load factor, or elastic displacement [m].
double load(const LoadSegment& segment, const NetworkCreep& creep, double time);

/// Displacement [m].
double displacement(const LoadSegment& segment, const NetworkCreep& creep, double time);

/// Displacement without the jumps of the elastic part [m].
double smooth_displacement(const LoadSegment& segment, const NetworkCreep& creep, double time);

/// Rate of the smooth displacement [m/s].
double displacement_rate(const LoadSegment& segment, const NetworkCreep& creep, double time);

/// Bounds over an interval inside the segment. Every function above is a sum of terms that are
/// monotonic in time; the bounds add those of the terms and tighten in proportion to the interval.
Range load_range(const LoadSegment& segment, const NetworkCreep& creep, double from, double to);
Range smooth_displacement_range(const LoadSegment& segment, const NetworkCreep& creep, double from,
                                double to);
Range displacement_rate_range(const LoadSegment& segment, const NetworkCreep& creep, double from,
                              double to);

/// What a part of the network with unit response would have done since the start of the segment if
/// it had been at rest: integrals of the load over the dashpot and the Kelvin branches.
struct LoadMemory {
  double load;                ///< at the time
  double viscous;             ///< dashpot elongation gained
  std::vector<double> kelvin; ///< Kelvin elongations gained
  std::vector<double> decay;  ///< share of former Kelvin elongations that is left
};
LoadMemory memory(const LoadSegment& segment, const NetworkCreep& creep, double time);

} // namespace dem
