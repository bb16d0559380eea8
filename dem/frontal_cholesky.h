#pragma once
#include "dem/dense_front.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace dem {

/// Sparsity of a symmetric matrix: row indices of the lower triangle, column by column, sorted.
struct SymmetricPattern {
  std::vector<int> column_start; ///< length n + 1
  std::vector<int> row;

  int size() const { return int(column_start.size()) - 1; }
};

/// Columns of a Cholesky factor with the same rows, in an order in which the descendants of each
/// come right before it.
struct Supernodes {
  std::vector<int> first_column; ///< of each, and the number of columns at the end
  std::vector<int> first_row;    ///< of each in `row`, and the end
  std::vector<int> row;          ///< own columns first, ascending
  std::vector<int> parent;       ///< -1 at a root

  int size() const { return int(parent.size()); }
  int n_columns(int s) const { return first_column[s + 1] - first_column[s]; }
  std::span<const int> rows(int s) const
  {
    return std::span(row).subspan(first_row[s], first_row[s + 1] - first_row[s]);
  }
};

/// Multifrontal Cholesky factorisation on one thread.
///
/// Each supernode gathers entries of the matrix and what its children left over in a dense front,
/// eliminates its columns there and leaves the rest of the front to its parent.
template <typename Number>
class FrontalCholesky {
public:
  /// \param position  of each unknown in the order of the factor
  FrontalCholesky(const SymmetricPattern& pattern, std::span<const int> position,
                  Supernodes supernodes);

  /// Takes the columns of a supernode: the triangle and the rows below it, by columns.
  using Store = std::function<void(int supernode, const Number* columns, std::size_t stride)>;

  /// \return false if the matrix is not positive definite
  bool factorise(std::span<const double> values, const Store& store);

private:
  struct Entry {
    int value; ///< place in the pattern
    int row;   ///< of the front
  };
  /// Rows of a leftover that lie side by side in the front of the parent.
  struct Run {
    int begin, end;
    int shift; ///< row of the parent less that of the leftover
  };

  int n_left(int s) const { return int(nodes_.rows(s).size()) - nodes_.n_columns(s); }
  void place_entries(const SymmetricPattern& pattern, std::span<const int> position);
  void place_leftovers();
  void gather(int s, std::span<const double> values, DenseFront<Number>& front) const;
  void leave(int s, const DenseFront<Number>& front);

  Supernodes nodes_;
  std::vector<int> first_entry_; ///< of each column of the factor in `entry_`, and the end
  std::vector<Entry> entry_;
  std::vector<int> first_run_; ///< of each supernode in `run_`, and the end
  std::vector<Run> run_;
  std::vector<std::vector<int>> children_;
  std::vector<std::size_t> leftover_at_; ///< of each supernode in `leftover_`
  std::vector<Number> leftover_;         ///< lower triangles by columns, a stack
  std::vector<Number> front_;
};

extern template class FrontalCholesky<double>;
extern template class FrontalCholesky<float>;

} // namespace dem
