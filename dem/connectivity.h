#pragma once
#include "dem/network.h"

#include <span>
#include <string>
#include <vector>

namespace dem {

/// How a group of particles that hang together by intact bonds is held.
enum class PieceHold : std::uint8_t {
  held,    ///< contains particles glued to a platen
  clamped, ///< not glued to a platen, but pressed contacts touch it
  loose,   ///< nothing touches it and nothing loads it
  dropped  ///< nothing holds it, yet a load acts on it: no equilibrium
};

/// Groups of particles connected by intact bonds; platens connect the particles glued to them.
struct Pieces {
  std::vector<int> piece;      ///< of each particle
  std::vector<PieceHold> hold; ///< of each piece
  bool platens_connected;      ///< by bonds or pressed contacts, through any pieces

  PieceHold of(Index particle) const { return hold[piece[particle]]; }
};

/// Finds the pieces by union-find: linear in the number of bonds.
Pieces find_pieces(const ElasticNetwork& network, std::span<const BondStatus> status);

/// The bonds of each particle.
struct ParticleBonds {
  std::vector<Index> start; ///< of each particle in `bond`, and the end
  std::vector<Index> bond;

  std::span<const Index> of(Index particle) const
  {
    return {bond.data() + start[particle], std::size_t(start[particle + 1] - start[particle])};
  }
};
ParticleBonds particle_bonds(const ElasticNetwork& network);

/// Whether intact bonds still connect two particles, searched for among near particles only: false
/// may also mean that the way round is long.
bool connected_nearby(const ElasticNetwork& network, const ParticleBonds& bonds,
                      std::span<const BondStatus> status, Index from, Index to);

/// Why a network cannot be in equilibrium, judged by its connections alone; empty if nothing
/// speaks against it. (Pressed contacts without friction may still be a mechanism.)
std::string equilibrium_obstacle(const ElasticNetwork& network, const Pieces& pieces);

/// Number of independent motions of a particle that strain none of its bonds while all other
/// particles stand still: 6 without bonds, 0 with one bond that carries moments; 5, 4 and 3 with
/// one, two and three pressed contacts in general position.
int n_free_modes(const ElasticNetwork& network, std::span<const BondStatus> status, Index particle);

} // namespace dem
