#pragma once
#include "dem/types.h"

namespace dem {

/// What broken bonds leave behind.
enum class AfterBreakage : std::uint8_t {
  leave,   ///< nothing
  pressed, ///< a contact without friction while it is pressed; it leaves when its force would pull
  friction ///< a contact with friction (explicit solver only)
};

/// Which force reached its strength.
enum class BreakMode : std::uint8_t { tension, shear };

/// One broken bond.
struct Breakage {
  double time; ///< [s]
  Index bond;
  BreakMode mode;
  double normal_force;    ///< before it broke [N], tension positive
  double shear_force;     ///< before it broke [N]
  double strength_factor; ///< strength over reference strength [-]
  double strain;          ///< of the specimen just before [-]
  int pass;               ///< how many batches broke before it at the same instant
};

/// Where a run stands.
enum class RunEnd : std::uint8_t {
  running,
  finished,        ///< the end of the load history
  strain_limit,    ///< the specimen has strained as much as was asked
  lost_equilibrium ///< no equilibrium with the bonds that are left
};

/// What the specimen shows at a time.
struct Response {
  double time;            ///< [s]
  double force;           ///< on the upper platen [N], or load factor [-]
  double strain;          ///< [-]
  double strain_rate;     ///< that counts for the strengths [1/s]
  double strength_factor; ///< [-]
  double compliance;      ///< elastic displacement per force of the present network [m/N]
  long n_broken;
};

} // namespace dem
