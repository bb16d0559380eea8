#pragma once
#include "dem/bonds.h"
#include "dem/particles.h"
#include "dem/strength.h"

#include <optional>
#include <string>
#include <vector>

namespace dem {

/// What holds a particle.
enum class Support : std::uint8_t {
  free,
  bottom, ///< glued to the lower platen, which does not move
  top,    ///< glued to the upper platen, which moves along z and does not tilt
};

/// Force and moment on one particle per unit of the load factor.
struct ParticleLoad {
  Index particle;
  Vec3 force;  ///< [N]
  Vec3 moment; ///< [N m]
};

/// A bonded specimen as it is made: it does not change during a run.
///
/// It is loaded either by the upper platen or by loads on particles, each with one scalar history.
struct Assembly {
  Particles particles;
  std::vector<Support> support; ///< one per particle
  std::vector<BondLaw> laws;
  std::vector<PairLaw> pair_laws; ///< law of new contacts, by the classes of the two particles
  Bonds bonds;
  std::optional<Strengths> strengths; ///< absent: bonds do not break
  std::vector<ParticleLoad> loads;    ///< empty: the platen is loaded
  /// Dead loads, force [N] and moment [N m], that act in full from the first instant on, besides
  /// the platen's: the pressure on the lateral surface. Empty: none.
  std::vector<ParticleLoad> confinement;
  double area;         ///< nominal cross-section [m^2]
  double gauge_length; ///< displacement over strain [m]
};

/// True if the load acts through the platen, false if it acts on particles.
inline bool loaded_by_platen(const Assembly& assembly)
{
  return assembly.loads.empty();
}

/// Heights of the platens [m].
struct PlatenHeights {
  double low, high;
};

/// Lowest and highest point reached by a sphere.
PlatenHeights packing_extent(const Particles& particles);

/// Particles whose gap to a platen is at most `gap` times their radius are glued to it.
std::vector<Support> platen_supports(const Particles& particles, PlatenHeights platens, double gap);

/// Checks that everything fits together.
/// \throws std::invalid_argument naming the particle, bond or number at fault
void validate(const Assembly& assembly);

/// \throws std::invalid_argument that names the solver if the specimen is confined
void refuse_confinement(const Assembly& assembly, const char* solver);

} // namespace dem
