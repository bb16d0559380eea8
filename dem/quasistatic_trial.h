#pragma once
#include "dem/quasistatic.h"

namespace dem {

/// A step that may be taken.
struct QuasistaticSolver::Trial {
  double duration;
  Equilibrium equilibrium;
  Links links;
  double displacement = 0; ///< gained [m]
  double load = 0;         ///< at the end: force on the platen, or load factor
  EnergyLedger energy;     ///< gained
  double error = 0;        ///< estimated, of the displacement gained, relative
};

} // namespace dem
