#pragma once
#include "dem/lanes.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace dem {

/// Zeros after a front.
constexpr int front_padding = n_lanes;

/// The supernodes of a Cholesky factor L, in the layout that triangular solves read fastest.
///
/// Four neighbouring columns of a supernode make a strip: their triangle (reciprocal diagonal),
/// then the rows after it, eight at a time. Strips lie in the order in which a back-solve needs
/// them, in huge pages where the system has them, so that it is one stream through memory.
///
/// A "front" is a vector over the rows of one supernode, its own columns first, followed by
/// `front_padding` entries that are zero.
///
/// \tparam Stored  double, or float: half the memory to stream, for a factor that only
///                 preconditions (relative error 6e-8 of each entry; sums are in double).
template <typename Stored>
class FactorStrips {
public:
  /// \param n_columns  of each supernode; \param n_rows  of each, own columns included
  FactorStrips(std::vector<int> n_columns, std::vector<int> n_rows);

  /// Copies a supernode from a dense block stored by columns.
  ///
  /// \param stride  distance between columns
  template <typename Number>
  void store(int supernode, const Number* block, std::size_t stride);

  /// Solves for the supernode's own rows and takes what they contribute off the rows after them.
  void eliminate(int supernode, double* front) const;
  void eliminate(int supernode, Lanes* front) const; ///< eight right-hand sides

  /// Solves for the supernode's own rows with the transposed factor, the rows after being known.
  void substitute(int supernode, double* front) const;

private:
  struct Free {
    void operator()(Stored* p) const;
  };

  const Stored* strip(int supernode, int k) const
  {
    return values_.get() + offset_[first_[supernode] + k];
  }
  int n_strips(int supernode) const { return int(first_[supernode + 1] - first_[supernode]); }

  std::vector<int> n_columns_, n_rows_;
  std::vector<std::size_t> first_;  ///< strip of each supernode, and their number
  std::vector<std::size_t> offset_; ///< of each strip in `values_`
  std::unique_ptr<Stored[], Free> values_;
};

extern template class FactorStrips<double>;
extern template class FactorStrips<float>;

} // namespace dem
