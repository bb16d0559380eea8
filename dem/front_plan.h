#pragma once
#include <cstddef>
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
  int n_rows(int s) const { return first_row[s + 1] - first_row[s]; }
  int n_left(int s) const { return n_rows(s) - n_columns(s); }
  std::span<const int> rows(int s) const { return std::span(row).subspan(first_row[s], n_rows(s)); }
};

/// What a multifrontal factorisation adds to which place of which front: the same for every matrix
/// with a pattern.
class FrontPlan {
public:
  /// Entries that lie side by side in the values of the matrix, and in the front down a column or
  /// along a row.
  struct EntryRun {
    int value;       ///< place of the first in the pattern
    int row, column; ///< of the first in the front
    int size;
    bool along_row;
  };
  /// Rows of a leftover that lie side by side in the front of the parent.
  struct LeftoverRun {
    int begin, end;
    int shift; ///< row of the parent less that of the leftover
  };

  /// \param position  of each unknown in the order of the factor
  FrontPlan(const SymmetricPattern& pattern, std::span<const int> position, Supernodes supernodes);

  const Supernodes& nodes() const { return nodes_; }
  std::span<const EntryRun> entries(int s) const { return part(entry_, first_entry_, s); }
  std::span<const int> children(int s) const { return children_[s]; }
  /// What a supernode leaves to its parent, as lower triangles by columns on a stack.
  std::size_t leftover_at(int s) const { return leftover_at_[s]; }
  std::span<const LeftoverRun> leftover(int s) const { return part(run_, first_run_, s); }
  std::size_t stack_size() const { return stack_size_; }

private:
  template <typename T>
  static std::span<const T> part(const std::vector<T>& all, const std::vector<int>& first, int s)
  {
    return std::span(all).subspan(first[s], first[s + 1] - first[s]);
  }
  void place_entries(const SymmetricPattern& pattern, std::span<const int> position);
  void place_leftovers();
  void place_leftover(int s);

  Supernodes nodes_;
  std::vector<int> first_entry_; ///< of each supernode in `entry_`, and the end
  std::vector<EntryRun> entry_;
  std::vector<int> first_run_; ///< of each supernode in `run_`, and the end
  std::vector<LeftoverRun> run_;
  std::vector<std::vector<int>> children_;
  std::vector<std::size_t> leftover_at_;
  std::size_t stack_size_ = 0;
};

} // namespace dem
