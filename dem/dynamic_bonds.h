#pragma once
#include "dem/assembly.h"

#include <Eigen/Core>

#include <limits>
#include <span>
#include <vector>

namespace dem {

/// Doubles on the boundary of a vector register.
using AlignedDoubles = std::vector<double, Eigen::aligned_allocator<double>>;

/// What the bond kernel reads of a particle, eight numbers each: centre [m], half-tangent vector of
/// the last rotation step (see bond_frame.h), two unused.
constexpr int motion_stride = 8;

/// Forces on a particle: force [N], moment [N m], two unused.
constexpr int force_stride = 8;

/// Factors of one step of the relaxation modes of a law: f <- decay f + gain k du.
struct StepFactors {
  std::vector<double> decay, gain;
};

/// Factors of a step of length dt [s] for a law, with its spring set to 1 and the modes padded with
/// zeros to `n_modes`.
StepFactors step_factors(const CreepLaw& law, double dt, int n_modes);

/// A range of blocks and the particles they touch: the unit of parallel work. Each chunk adds its
/// forces into a window of its own, so that sums do not depend on the number of threads.
struct BondChunk {
  Index first_block, last_block;
  Index first_particle, last_particle; ///< window [first, last)
  std::size_t window;                  ///< start of the window in the array of partial forces
};

/// Bonds of an explicit run: kinematics and relaxation modes, eight bonds to a block so that one
/// vector register holds one number of eight bonds. Particles are numbered by slot (in the order of
/// their position), bonds by block and lane.
struct DynamicBonds {
  int n_modes = 1;         ///< relaxation modes carried per component
  std::vector<Index> ends; ///< slots of both ends: 8 first ends, 8 second ends per block
  std::vector<Index> bond; ///< bond in each lane; -1 in an idle one
  std::vector<int> law;    ///< of each block
  AlignedDoubles fields;   ///< n_fields(n_modes) x 8 numbers per block
  std::vector<BondChunk> chunks;
  std::size_t n_partial_forces = 0; ///< length of the array of partial forces / force_stride

  Index n_blocks() const { return Index(law.size()); }
};

/// Numbers per bond: normal (3), distance, tangent (3), six modes x n_modes forces, then the
/// constants: stiffness of normal, shear, torsion, bending; contact offset; normal and shear
/// strength.
constexpr int n_fields(int n_modes)
{
  return 14 + 6 * n_modes;
}

/// Bonds of an assembly at rest. Strengths are infinite if the assembly has none.
/// \param slot  of each particle
DynamicBonds make_dynamic_bonds(const Assembly& assembly, std::span<const Index> slot, int n_modes);

/// Advances all bonds of a chunk over one step and sums up what they do to the particles.
///
/// The elongation is the change of distance; shear, torsion and bending follow the relative motion
/// at the contact point in the mid-step configuration. Rigid motions strain nothing, to rounding.
/// The update of the modes is exact for motion at constant rate over the step; it is stable for any
/// ratio of the step to the relaxation times. The two ends of a bond are treated alike.
///
/// \param motions   motion_stride numbers per slot
/// \param factors   of each law
/// \param strength_factor  multiplies all strengths
/// \param partial   array of partial forces; the chunk fills its window
/// \param broken    receives lane numbers (8 block + lane) of bonds that broke, in order
void advance_chunk(DynamicBonds& bonds, const BondChunk& chunk, const double* motions,
                   std::span<const StepFactors> factors, double strength_factor, double* partial,
                   std::vector<Index>& broken);

/// State of one bond in natural form.
struct DynamicBond {
  Index first_slot, second_slot;
  Index bond;
  int law;
  Vec3 normal, tangent;
  double distance; ///< [m]
  Eigen::Matrix<double, 6, Eigen::Dynamic>
      modes; ///< forces: normal, two shear, torsion, two bending
  ModeStiffness stiffness;
  double normal_strength, shear_strength; ///< [N]
};
DynamicBond dynamic_bond(const DynamicBonds& bonds, Index lane);

/// Force and moment on the first end, in global axes.
struct GlobalLoad {
  Vec3 force, moment;
};
GlobalLoad global_load(const DynamicBond& bond);

/// Gives a bond stiffnesses that do not follow from its section. Forces it carries stay.
void set_stiffness(DynamicBonds& bonds, Index lane, const ModeStiffness& stiffness);

/// Takes all stiffness and force from a bond and makes it unbreakable: it is gone.
void remove_bond(DynamicBonds& bonds, Index lane);

} // namespace dem
