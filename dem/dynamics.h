#pragma once
#include "dem/dynamic_contacts.h"
#include "dem/loading.h"
#include "dem/records.h"

#include <functional>
#include <limits>
#include <vector>

namespace dem {

/// How an explicit run is made.
struct DynamicSettings {
  double viscosity_scaling = 1; ///< x: all viscosities are multiplied by it, time runs 1/x faster
  double step_safety = 0.8;     ///< step over critical step [-]
  double damping = 0.7;         ///< Cundall's local damping [-], 0 to 1
  double friction = 0.5;        ///< of contacts [-]
  double ramp_periods = 4;      ///< jumps of the load are spread over this many axial periods
  double smallest_window = 1;   ///< of the strain rate, in axial periods
  double servo_gain = 0.5;      ///< of the platens under force control [-], 0 to 1
  AfterBreakage after_breakage = AfterBreakage::friction;
};

/// A specimen for the explicit solver: does not change during a run.
///
/// Inertia, finite motions and rotations, any creep laws, contacts with friction. With viscosities
/// scaled by x, a real time t is simulated in x t; loads, histories and strain rates are given and
/// reported in real time, so that the strengths see the real rate.
struct DynamicModel {
  Assembly assembly;
  Loading loading;  ///< in real time
  RateLaw rate_law; ///< in real time
  DynamicSettings settings;
  double strain_limit = std::numeric_limits<double>::infinity();
  double time_step;        ///< simulated [s]
  double axial_period;     ///< of the specimen on its platens, simulated [s]
  double ramp_time;        ///< simulated [s]
  double platen_stiffness; ///< felt by the servo within one step [N/m]
  PlatenHeights platens;   ///< at the start [m]
  int n_modes = 1;
  std::vector<Index> slot, particle; ///< of each particle, and the other way round
  std::vector<StepFactors> factors;  ///< of each law
  // by slot
  std::vector<double> radius, inverse_mass, inverse_inertia;
  std::vector<Support> support;
  std::vector<int> material_class;
  std::vector<Vec3> force, moment; ///< loads per unit of the load factor
  std::vector<Index> loaded;       ///< free slots on which loads act
};

/// \param time_step  simulated [s]; 0 takes the critical step times the safety
/// \throws std::invalid_argument for settings out of range or a loading that does not fit
DynamicModel make_dynamic_model(const Assembly& assembly, const Loading& loading,
                                const RateLaw& rate_law, const DynamicSettings& settings,
                                double strain_limit, double time_step = 0);

/// What has happened so far. Copying it and going on gives the same future, bit for bit, on any
/// number of threads.
struct DynamicState {
  long n_steps = 0;
  AlignedDoubles motions;       ///< motion_stride numbers per slot
  std::vector<double> velocity; ///< velocity and spin, 6 numbers per slot, half a step back
  std::vector<Vec3> rotation;   ///< time integral of the spin [rad], by slot
  DynamicBonds bonds;
  DynamicContacts contacts;
  std::vector<double> initial_distance; ///< of the ends of each bond [m]
  AlignedDoubles forces;                ///< force_stride numbers per slot, at the present positions
  double displacement = 0;   ///< of the upper platen relative to the lower, or of the loads [m]
  double servo_velocity = 0; ///< integral part of the servo [m/s]
  double force_on_upper = 0, force_on_lower = 0; ///< by the platens, tension positive [N]
  std::vector<double> samples; ///< of the displacement, every `steps_per_sample` steps
  double strength_factor = std::numeric_limits<double>::infinity();
  std::vector<Breakage> breakages;
  RunEnd end = RunEnd::running;
};

/// Steps between samples of the platen displacement, checks of the neighbour list and of stability.
constexpr long steps_per_sample = 64;

DynamicState start(const DynamicModel& model);

/// Real time of a state [s].
double real_time(const DynamicModel& model, const DynamicState& state);

/// The state after at most n_steps more, on this many threads.
/// \throws std::runtime_error naming the particle and the time if the motion grows without bound
DynamicState advance(const DynamicModel& model, DynamicState state, long n_steps, int n_threads);

/// What the specimen shows now. The compliance is 0: it is not known to this solver.
Response response(const DynamicModel& model, const DynamicState& state);

/// Displacement and rotation of a particle so far.
struct Motion {
  Vec3 displacement, rotation;
};
Motion motion(const DynamicModel& model, const DynamicState& state, Index particle);

} // namespace dem
