#pragma once
#include "dem/link_matrix.h"
#include "dem/supernodal_factor.h"

namespace dem {

/// Assembles the tangents of links into the values of a sparse matrix.
///
/// Pairs of bodies get their places in the matrix once. Where a link finds its own is kept as long
/// as the links stay the same.
class LinkAssembly {
public:
  using Ends = std::array<Index, 2>;

  /// \param pairs  bodies between which there may be stiffness
  LinkAssembly(std::vector<Ends> pairs, const LinkDofs& dofs);

  const std::vector<Ends>& pairs() const { return pairs_; } ///< sorted, the smaller body first
  const SymmetricPattern& pattern() const { return pattern_; }

  /// Links that carry without being one of the pairs.
  std::size_t n_outside(const LinkMatrix& matrix);

  /// Values of the lower triangle of K, in the order of the pattern. Links outside of it are left
  /// out: the matrix serves as a preconditioner.
  std::vector<double> values(const LinkMatrix& matrix);

private:
  void find_pairs();
  void find_links(const std::vector<Ends>& ends);
  void add_between(const LinkStiffness& block, const Ends& ends, int below,
                   std::span<double> values) const;
  void add_platen(const LinkStiffness& block, const Ends& ends, std::span<double> values) const;
  void add_bodies(std::span<const Mat6> own, std::span<const double> hold,
                  std::span<double> values) const;

  Index platen_of(Index body) const
  {
    return dofs_.support[body] == Support::top ? dofs_.platen_dof : -1;
  }

  LinkDofs dofs_;
  std::vector<Ends> pairs_;
  SymmetricPattern pattern_;
  /// Of the block of each pair in the columns of the body whose dofs come first; -1 if one is held,
  /// or both are one.
  std::vector<int> below_;
  std::vector<Ends> found_;        ///< links whose places are known
  std::vector<int> below_of_link_; ///< as `below_`; `outside` for a link that is no pair
};

} // namespace dem
