#pragma once
#include <cstddef>
#include <span>

namespace dem {

/// Partial Cholesky factorisation of a dense symmetric matrix: the front of one supernode.
///
/// Stored by columns, the lower triangle. Its first columns become those of the factor L; what they
/// contribute is taken off the rest. Entries of the upper triangle up to a register's width above
/// the diagonal serve as scratch.
///
/// \tparam Number  double, or float: twice as fast, relative error 6e-8
template <typename Number>
class DenseFront {
public:
  static constexpr int n_lanes = int(64 / sizeof(Number)); ///< numbers in a register

  /// Distance between columns of a front with so many rows: whole registers, and what tiles at the
  /// end read beyond.
  static constexpr int stride(int n_rows) { return (n_rows + 7 + n_lanes) / n_lanes * n_lanes; }
  static std::size_t size(int n_rows) { return std::size_t(stride(n_rows)) * (n_rows + 8); }

  /// \param values  as many as `size` says, on a boundary of 64 bytes
  DenseFront(std::span<Number> values, int n_rows);

  /// Sets the lower triangle to zero.
  void clear();

  Number* column(int j) { return values_ + std::size_t(j) * stride_; }
  const Number* column(int j) const { return values_ + std::size_t(j) * stride_; }

  /// Eliminates the first columns.
  /// \return false if a pivot is not positive
  bool eliminate(int n_columns);

private:
  void update(int first, int last, int from, int to);
  bool factor_block(int first, int width);

  Number* values_;
  int n_rows_;
  std::size_t stride_;
};

extern template class DenseFront<double>;
extern template class DenseFront<float>;

} // namespace dem
