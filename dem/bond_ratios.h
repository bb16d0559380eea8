#pragma once
#include "dem/network.h"
#include "dem/strength.h"

#include <span>
#include <vector>

namespace dem {

/// Largest force over strength among all bonds, per unit of the load factor, for load factors of
/// either sign (forces that pull under one sign press under the other).
struct CriticalRatio {
  double positive = 0, negative = 0; ///< [1/unit of the load factor]
};

/// Forces of all bonds per unit of the load factor, against their strengths at the reference rate.
///
/// The ratio of a bond is max(normal force / normal strength, shear force / shear strength).
/// Forces below 1e-12 of the largest are rounding and count as 0; a force of 0 breaks nothing, not
/// even a strength of 0.
struct BondRatios {
  std::vector<ForcePair> force;           ///< per unit of the load factor
  std::vector<double> positive, negative; ///< ratios, by the sign of the load factor; 0 if broken
  CriticalRatio critical;
};

/// \param force  of each bond, per unit of the load factor
BondRatios bond_ratios(std::span<const BondStatus> status, const Strengths& strengths,
                       std::vector<ForcePair> force);

/// Intact bonds whose ratio is within 1e-12 of the largest under a load factor of this sign.
std::vector<Index> critical_bonds(const BondRatios& ratios, bool positive_load);

} // namespace dem
