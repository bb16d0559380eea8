#pragma once
#include "dem/dynamics.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace bench {

/// The scene on which explicit codes are compared: 6000 bonded spheres in a cylinder, compressed
/// by a platen of constant speed. Its numbers are in data/cylinder.json.
struct BondedCylinder {
  dem::Particles particles;
  std::vector<std::array<dem::Index, 2>> pairs;
  dem::ModeStiffness stiffness; ///< of every bond
  double kelvin_stiffness;      ///< over the stiffness of the spring [-]
  double retardation_time;      ///< of the Kelvin branch [s]
  double relaxation_time;       ///< viscosity of the dashpot over stiffness of the spring [s]
  double bond_strength;         ///< [N], never reached but checked
  double platen_depth;          ///< spheres centred this near to an end are held [m]
  double platen_speed;          ///< of the upper platen, downwards [m/s]
  double time_step;             ///< [s]
  long n_steps;                 ///< after which the platen force is compared
};

/// What the bonds are made of.
enum class Law { elastic, burgers };

std::string name_of(Law law);

/// \throws std::invalid_argument for a name that is not a law
Law law_named(const std::string& name);

/// \throws std::runtime_error naming the file that is missing
BondedCylinder read_bonded_cylinder(const std::filesystem::path& folder);

/// Force on the upper platen at the end that an independent program found [N], tension positive.
double reference_force(const std::filesystem::path& folder, Law law);

/// An explicit run.
struct ExplicitRun {
  dem::DynamicModel model;
  dem::DynamicState state;
};

/// The scene at rest, the upper platen about to move.
ExplicitRun start_run(const BondedCylinder& scene, Law law);

/// Goes on for a number of steps. Returns the seconds per bond and step that this took.
double timed_steps(ExplicitRun& run, long n_steps, int n_threads);

} // namespace bench
