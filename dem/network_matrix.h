#pragma once
#include "dem/connectivity.h"
#include "dem/network.h"
#include "dem/supernodal_factor.h"

#include <span>
#include <vector>

namespace dem {

/// Sparsity of the stiffness matrix with all bonds in place.
SymmetricPattern stiffness_pattern(const ElasticNetwork& network);

/// Springs to ground that hold what contacts without friction cannot: stiffness on every dof of a
/// particle in a clamped piece, relative to the mean normal stiffness of the bonds.
constexpr double relative_ground_stiffness = 1e-9;

/// Mean normal stiffness of the bonds [N/m]; 1 without bonds.
double mean_normal_stiffness(const ElasticNetwork& network);

/// Values of the stiffness matrix in the order of its pattern. Loose pieces are replaced by unit
/// springs to ground, clamped ones get the weak springs above.
std::vector<double> stiffness_values(const ElasticNetwork& network, const SymmetricPattern& pattern,
                                     std::span<const BondStatus> status, const Pieces& pieces);

} // namespace dem
