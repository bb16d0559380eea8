#pragma once
#include "dem/events.h"
#include "tests/dem/assemblies.h"

#include <limits>
#include <utility>

/// Runs of the event solver that several tests make.
namespace event_runs {

constexpr double never = std::numeric_limits<double>::infinity();
inline const dem::RateLaw constant_strength{0, 0.005, 0, 0, 0};

inline dem::EventsState run(dem::EventsSolver& solver)
{
  dem::EventsState state = solver.start();
  while (state.end == dem::RunEnd::running)
    state = solver.step(std::move(state));
  return state;
}

/// A pair of spheres under the platen, strength and law given.
inline dem::Assembly pair(const dem::CreepLaw& creep, double strength)
{
  return assemblies::bundle(std::span(&strength, 1), 4e-3, creep);
}

} // namespace event_runs
