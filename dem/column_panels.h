#pragma once
#include "dem/supernodal_factor.h"

#include <Eigen/Core>

#include <vector>

namespace dem {

/// Half-solved columns gathered over time, Y = [Y_1 Y_2 ...], kept by supernode of the factor.
///
/// On each supernode the columns that are not zero there lie side by side, eight to a register, so
/// that products with all of them run through memory once and in order.
class ColumnPanels {
public:
  /// \param supernode_starts  first column of each supernode, and the number of columns at the end
  explicit ColumnPanels(std::span<const int> supernode_starts);

  int size() const { return n_columns_; } ///< number of columns
  void clear();
  void append(const SupernodalFactor::SparseColumns& columns);

  /// Y^T B: one row of lanes per gathered column, one lane per column of B.
  std::vector<Lanes> products(const SupernodalFactor::SparseColumns& b) const;

  /// Y^T y for a full half-solved vector.
  Eigen::VectorXd products(const Eigen::VectorXd& y) const;

  /// y += Y c.
  void add(const Eigen::VectorXd& c, Eigen::VectorXd& y) const;

private:
  struct Panel {
    std::vector<int> column;   ///< numbers of the columns
    std::vector<Lanes> values; ///< groups of eight columns times the rows of the supernode
  };

  int n_rows(std::size_t s) const { return starts_[s + 1] - starts_[s]; }

  std::vector<int> starts_;
  std::vector<Panel> panels_;
  int n_columns_ = 0;
};

} // namespace dem
