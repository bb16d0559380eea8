#pragma once
#include "dem/types.h"

#include <span>
#include <vector>

namespace dem {

/// Pairs of near spheres, each pair once: the partners of sphere i are
/// neighbour[start[i]] ... neighbour[start[i+1]-1].
struct NeighbourList {
  std::vector<Index> start; ///< length n + 1
  std::vector<Index> neighbour;
};

/// All pairs of spheres whose surfaces are less than `margin` [m] apart (or overlap).
///
/// Spheres are sorted into linked cells, one grid per size class (factor 2), and each sphere looks
/// for partners in its own class and in the coarser ones. The cost is linear in the number of
/// spheres at any size ratio. The order of the pairs depends on the input alone.
NeighbourList near_pairs(std::span<const Vec3> centre, std::span<const double> radius,
                         double margin);

} // namespace dem
