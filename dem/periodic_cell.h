#pragma once
#include "dem/contact_search.h"
#include "dem/types.h"

#include <span>
#include <vector>

namespace dem {

/// Whole numbers of edges by which an image lies away from its original.
using ImageShift = Eigen::Vector3i;

/// A parallelepiped that repeats in all three directions. The edges may lean as far as they like.
struct PeriodicCell {
  Mat3 edges; ///< columns: the three edge vectors [m], right-handed

  Vec3 translation(const ImageShift& shift) const { return edges * shift.cast<double>(); }
  double volume() const { return edges.determinant(); } ///< [m^3]
};

/// Checked cell.
/// \throws std::invalid_argument if the edges are not finite, left-handed or in one plane
PeriodicCell make_periodic_cell(const Mat3& edges);

/// Upright box with these edge lengths [m].
PeriodicCell box_cell(const Vec3& lengths);

/// Columns: area vectors of the three faces [m^2], face k being the one that edge k crosses.
Mat3 face_areas(const PeriodicCell& cell);

/// Distances between opposite faces [m].
Vec3 face_distances(const PeriodicCell& cell);

/// How many edges to move a point to bring it into the cell, where its coordinates along the edges
/// lie in [0, 1). A point within 1e-12 of a face counts as on it.
ImageShift shift_into_cell(const PeriodicCell& cell, const Vec3& point);

/// Near pairs across faces, each pair once: as NeighbourList, and with the image of the partner.
struct PeriodicNeighbours {
  NeighbourList list;
  std::vector<ImageShift> shift; ///< partner k is at centre[list.neighbour[k]] + edges * shift[k]
};

/// All pairs of spheres and periodic images of spheres whose surfaces are less than `margin` [m]
/// apart; a sphere may be near its own images, or near several images of another one.
///
/// Centres may lie outside the cell. Works for any shape and size of the cell: all images within
/// reach of it are placed and searched by `near_pairs`. Of the two ways to write a pair, one
/// comes: the sphere with the smaller number first, or, for a sphere and its own image, the shift
/// whose first component other than zero is positive.
PeriodicNeighbours periodic_near_pairs(const PeriodicCell& cell, std::span<const Vec3> centre,
                                       std::span<const double> radius, double margin);

} // namespace dem
