#include "dem/column_panels.h"

#include <algorithm>
#include <array>

namespace dem {

namespace {

/// Products of eight gathered columns with the first `width` lanes of new ones, over n rows.
template <int width>
std::array<Lanes, width> eight_products(const Lanes* gathered, const Lanes* fresh, int n)
{
  std::array<Lanes, width> sum{};
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < width; ++k)
      sum[k] += gathered[i] * fresh[i][k];
  return sum;
}

/// Adds the products of a panel to the rows of the result.
template <int width>
void add_products(const std::vector<int>& column, const std::vector<Lanes>& values,
                  const Lanes* fresh, int n, std::vector<Lanes>& result)
{
  for (std::size_t first = 0; first < column.size(); first += n_lanes) {
    const auto sum = eight_products<width>(values.data() + first / n_lanes * n, fresh, n);
    const std::size_t count = std::min<std::size_t>(n_lanes, column.size() - first);
    for (std::size_t lane = 0; lane < count; ++lane)
      for (int k = 0; k < width; ++k)
        result[column[first + lane]][k] += sum[k][lane];
  }
}

} // namespace

ColumnPanels::ColumnPanels(std::span<const int> supernode_starts)
    : starts_(supernode_starts.begin(), supernode_starts.end()), panels_(starts_.size() - 1)
{
}

void ColumnPanels::clear()
{
  for (Panel& panel : panels_) {
    panel.column.clear();
    panel.values.clear();
  }
  n_columns_ = 0;
}

void ColumnPanels::append(const SupernodalFactor::SparseColumns& columns)
{
  for (std::size_t p = 0; p < columns.supernode.size(); ++p) {
    const int s = columns.supernode[p], n = n_rows(s);
    Panel& panel = panels_[s];
    for (int k = 0; k < columns.n_columns; ++k) {
      const std::size_t place = panel.column.size(), lane = place % n_lanes;
      if (lane == 0)
        panel.values.resize(panel.values.size() + n, no_lanes());
      Lanes* group = panel.values.data() + place / n_lanes * n;
      for (int i = 0; i < n; ++i)
        group[i][lane] = columns.row[columns.first_row[p] + i][k];
      panel.column.push_back(n_columns_ + k);
    }
  }
  n_columns_ += columns.n_columns;
}

std::vector<Lanes> ColumnPanels::products(const SupernodalFactor::SparseColumns& b) const
{
  std::vector<Lanes> result(n_columns_, no_lanes());
  for (std::size_t p = 0; p < b.supernode.size(); ++p) {
    const Panel& panel = panels_[b.supernode[p]];
    const Lanes* fresh = b.row.data() + b.first_row[p];
    const int n = n_rows(b.supernode[p]);
    if (b.n_columns == 1)
      add_products<1>(panel.column, panel.values, fresh, n, result);
    else if (b.n_columns <= 6)
      add_products<6>(panel.column, panel.values, fresh, n, result);
    else
      add_products<n_lanes>(panel.column, panel.values, fresh, n, result);
  }
  return result;
}

Eigen::VectorXd ColumnPanels::products(const Eigen::VectorXd& y) const
{
  Eigen::VectorXd result = Eigen::VectorXd::Zero(n_columns_);
  for (std::size_t s = 0; s < panels_.size(); ++s) {
    const Panel& panel = panels_[s];
    const int n = n_rows(s);
    for (std::size_t first = 0; first < panel.column.size(); first += n_lanes) {
      const Lanes* group = panel.values.data() + first / n_lanes * n;
      Lanes sum = no_lanes();
      for (int i = 0; i < n; ++i)
        sum += group[i] * y[starts_[s] + i];
      const std::size_t count = std::min<std::size_t>(n_lanes, panel.column.size() - first);
      for (std::size_t lane = 0; lane < count; ++lane)
        result[panel.column[first + lane]] += sum[lane];
    }
  }
  return result;
}

void ColumnPanels::add(const Eigen::VectorXd& c, Eigen::VectorXd& y) const
{
  std::vector<Lanes> sum;
  for (std::size_t s = 0; s < panels_.size(); ++s) {
    const Panel& panel = panels_[s];
    if (panel.column.empty())
      continue;
    const int n = n_rows(s);
    sum.assign(n, no_lanes());
    for (std::size_t first = 0; first < panel.column.size(); first += n_lanes) {
      Lanes weight = no_lanes();
      const std::size_t count = std::min<std::size_t>(n_lanes, panel.column.size() - first);
      for (std::size_t lane = 0; lane < count; ++lane)
        weight[lane] = c[panel.column[first + lane]];
      const Lanes* group = panel.values.data() + first / n_lanes * n;
      for (int i = 0; i < n; ++i)
        sum[i] += group[i] * weight;
    }
    for (int i = 0; i < n; ++i)
      y[starts_[s] + i] += sum_of(sum[i]);
  }
}

} // namespace dem
