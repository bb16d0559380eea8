#pragma once
#include "dem/creep_law.h"

#include <Eigen/Core>

namespace dem {

/// How force and displacement are taken to change within a step.
enum class StepScheme : std::uint8_t {
  force_linear,       ///< exact for constant force and force ramps; rings if displacement is held
                      ///< over steps far above the relaxation times
  displacement_linear ///< exact for held displacement and constant rate; never rings
};

/// One step of a creep law, as a linear map of what it remembers.
///
/// The memory of an element is x = (force f, elongations k of its Kelvin branches); a step with the
/// displacement increment du takes it to x' = carry x + gain du. The first entry of `gain` is the
/// algorithmic stiffness K_alg [N/m], between 0 and K_m. For a mode of a bond with the stiffness
/// multiplier w, memory is (f, w k) and du is multiplied by w. Both schemes are of second order in
/// the step in general. Padded with zeros to a common number of parts.
struct LawStep {
  StepScheme scheme;
  double duration;       ///< [s], in reduced time
  Eigen::MatrixXd carry; ///< n_parts x n_parts
  Eigen::VectorXd gain;  ///< n_parts

  double stiffness() const { return gain[0]; }
};

/// \param n_parts  at least 1 + the number of branches
LawStep law_step(const CreepLaw& law, StepScheme scheme, double duration, int n_parts);

/// Recoverable energy of a memory [J], for the multiplier w.
double stored_energy(const CreepLaw& law, const double* memory, double multiplier);

/// What the dashpots dissipate in a step [J], for the multiplier w: exact for the scheme.
double dissipated_energy(const CreepLaw& law, const LawStep& step, const double* before,
                         const double* after, double increment, double multiplier);

/// Rate of the displacement without its elastic part, times w [N/s per N/m]: dashpot and branches.
double inelastic_rate(const CreepLaw& law, const double* memory);

} // namespace dem
