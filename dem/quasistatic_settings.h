#pragma once
#include "dem/records.h"

namespace dem {

/// Which changes of geometry a quasi-static run follows.
enum class Geometry : std::uint8_t {
  finite, ///< particles move and turn by any amount, contacts close
  small   ///< displacements are small: equilibrium on the geometry at the start
};

/// How a quasi-static run is made.
struct QuasistaticSettings {
  double strain_per_step = 5e-4;    ///< largest change of the specimen's strain in a step [-]
  double error_tolerance = 1e-3;    ///< local error of strain over strain gained, per step [-]
  long breakage_batch = 16;         ///< bonds that may break at a time; 1: one after the other
  double residual_tolerance = 1e-5; ///< out-of-balance force over the largest contact force [-]
  double regularisation = 1e-3;     ///< viscous resistance of contacts to sliding and rolling in a
                                    ///< step, over their stiffness [-]
  double passage_limit = 0.01;      ///< strain without equilibrium that counts as rupture [-]
  double friction = 0.5;            ///< of contacts [-]
  AfterBreakage after_breakage = AfterBreakage::friction;
  Geometry geometry = Geometry::finite;
};

} // namespace dem
