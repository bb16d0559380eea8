#pragma once
#include "dem/creep_law.h"
#include "dem/particles.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace dem {

/// Law of a bond: the creep law of its normal mode, and what makes the other five modes of it.
struct BondLaw {
  CreepLaw creep;
  double normal_to_shear = 11;  ///< N/S [-], > 0: divides all constants in shear and torsion
  double radius_multiplier = 1; ///< lambda [-], > 0: section radius over the smaller sphere radius
};

/// Bonds between spheres. All arrays have the same length.
///
/// The contact point lies on the line of centres, in the middle of the overlap or of the gap.
struct Bonds {
  std::vector<std::array<Index, 2>> ends;
  std::vector<double> section_radius; ///< R = lambda min(R_a, R_b) [m]
  std::vector<double> contact_offset; ///< of the contact point from the middle of the line of
                                      ///< centres towards the second end [m]
  std::vector<int> law;               ///< index into the laws of the assembly
  std::vector<std::int64_t> id;       ///< key of the strength draw; survives renumbering

  std::size_t size() const { return ends.size(); }
};

/// Stiffness of the six modes of one bond under instantaneous load.
struct ModeStiffness {
  double normal, shear;    ///< [N/m]
  double torsion, bending; ///< [N m/rad]
};

/// Multipliers of the normal stiffness: 1, 1/(N/S), R^2/2/(N/S), R^2/4.
ModeStiffness mode_stiffness(const BondLaw& law, double section_radius);

/// Which law holds between two classes of particles.
struct PairLaw {
  int class_a, class_b; ///< in any order
  int law;
};

/// Pairs of particles to be bonded, and the gap that decided.
struct ContactPairs {
  std::vector<std::array<Index, 2>> pairs;
  double gap; ///< largest gap bonded, relative to the smaller radius [-]; -1 without pairs
};

/// All pairs whose gap is at most `gap` times the smaller radius.
ContactPairs contacts_within(const Particles& particles, double gap);

/// The nearest pairs, by gap over the smaller radius, until the mean number of contacts per
/// particle is reached (2 n_pairs / n_particles). Gaps above 5 % of the smaller radius are never
/// bonded, so that the mean may stay below what is asked.
ContactPairs nearest_contacts(const Particles& particles, double mean_contacts);

/// Bonds for a list of pairs. Ids are the positions in the list.
/// \throws std::invalid_argument for a missing particle, a self bond, a pair that comes twice,
///         coincident centres, or a pair of classes without a law
Bonds make_bonds(const Particles& particles, std::span<const std::array<Index, 2>> pairs,
                 std::span<const BondLaw> laws, std::span<const PairLaw> pair_laws);

/// \throws std::invalid_argument for a normal_to_shear or a radius_multiplier that is not > 0
void validate(std::span<const BondLaw> laws);

/// Adds a bond between two particles wherever they or their images lie: its section, contact point
/// and law. Nothing but the pair of classes is checked.
/// \throws std::invalid_argument for a pair of classes without a law
void append_bond(Bonds& bonds, const Particles& particles, const std::array<Index, 2>& ends,
                 std::span<const BondLaw> laws, std::span<const PairLaw> pair_laws);

/// All laws as one law times a factor each, if they are proportional: then bond forces do not
/// depend on history and one elastic solution answers for all times.
struct ProportionalLaws {
  CreepLaw creep;              ///< of the first law
  std::vector<double> factors; ///< law i = factors[i] * creep
};
std::optional<ProportionalLaws> proportional_laws(std::span<const BondLaw> laws);

} // namespace dem
