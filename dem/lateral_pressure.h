#pragma once
#include "dem/assembly.h"

#include <vector>

namespace dem {

/// Share of the smallest radius that a patch of the lateral surface measures at most.
constexpr double patch_share = 0.25;

/// Forces and moments of a pressure of 1 Pa on the lateral surface of an upright cylindrical
/// packing, in the order of the particles that get any.
///
/// The surface, unrolled, is cut into patches of equal size, at most `patch_share` times the
/// smallest radius wide and high. Each presses with area x inward normal, at its middle, on the
/// sphere whose surface is nearest to it; the moment about the centre of that sphere comes with it.
/// All forces together vanish, and so do their moments about any point (to rounding: the patches
/// lie opposite to each other). With the middles of the patches as points of attack x the mean
/// stress, 1/V sum x (x) f over the volume of the cylinder, is -1 Pa in both lateral directions and
/// 0 else, to rounding: only which sphere is pressed depends on the patches.
///
/// \param base  middle of the lower face [m]; the axis points along z
/// \throws std::invalid_argument if the centre of a sphere lies outside of the cylinder's radius
std::vector<ParticleLoad> lateral_pressure(const Particles& particles, const Cylinder& cylinder,
                                           const Vec3& base);

} // namespace dem
