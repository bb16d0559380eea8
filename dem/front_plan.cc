#include "dem/front_plan.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace dem {

namespace {

std::size_t triangle_size(int n)
{
  return std::size_t(n) * (n + 1) / 2;
}

/// An entry of the matrix; row and column in the order of the factor.
struct Entry {
  int value, row, column;
};

/// Goes on with the last run of a front, or begins one.
void append(std::vector<FrontPlan::EntryRun>& runs, std::size_t first_of_front, const Entry& entry)
{
  if (runs.size() > first_of_front) {
    FrontPlan::EntryRun& run = runs.back();
    const bool is_next = entry.value == run.value + run.size;
    const bool down = entry.column == run.column && entry.row == run.row + run.size;
    const bool along = entry.row == run.row && entry.column == run.column + run.size;
    if (is_next && (down || along) && (run.size == 1 || run.along_row == along)) {
      run.along_row = along;
      ++run.size;
      return;
    }
  }
  runs.push_back({entry.value, entry.row, entry.column, 1, false});
}

/// Supernode of each column.
std::vector<int> supernode_of_column(const Supernodes& nodes)
{
  std::vector<int> result(std::size_t(nodes.first_column.back()));
  for (int s = 0; s < nodes.size(); ++s)
    std::fill(result.begin() + nodes.first_column[s], result.begin() + nodes.first_column[s + 1],
              s);
  return result;
}

} // namespace

FrontPlan::FrontPlan(const SymmetricPattern& pattern, std::span<const int> position,
                     Supernodes supernodes)
    : nodes_(std::move(supernodes))
{
  place_entries(pattern, position);
  place_leftovers();
}

void FrontPlan::place_entries(const SymmetricPattern& pattern, std::span<const int> position)
{
  const std::vector<int> supernode_of = supernode_of_column(nodes_);
  const auto for_entries = [&](auto&& use) {
    for (int c = 0; c < pattern.size(); ++c)
      for (int p = pattern.column_start[c]; p < pattern.column_start[c + 1]; ++p) {
        const int a = position[c], b = position[pattern.row[p]];
        use(Entry{p, std::max(a, b), std::min(a, b)});
      }
  };
  std::vector<int> first(std::size_t(nodes_.size()) + 1, 0); // entry of each supernode
  for_entries([&](const Entry& entry) { ++first[supernode_of[entry.column] + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Entry> entries(pattern.row.size());
  std::vector<int> next = first;
  for_entries([&](const Entry& entry) { entries[next[supernode_of[entry.column]]++] = entry; });
  std::vector<int> place(position.size()); // of each row in the front
  first_entry_.push_back(0);
  for (int s = 0; s < nodes_.size(); ++s) {
    const std::span<const int> rows = nodes_.rows(s);
    for (std::size_t r = 0; r < rows.size(); ++r)
      place[rows[r]] = int(r);
    for (int e = first[s]; e < first[s + 1]; ++e)
      append(entry_, std::size_t(first_entry_[s]),
             {entries[e].value, place[entries[e].row], place[entries[e].column]});
    first_entry_.push_back(int(entry_.size()));
  }
}

void FrontPlan::place_leftovers()
{
  children_.resize(std::size_t(nodes_.size()));
  first_run_.push_back(0);
  std::vector<int> stack; // supernodes whose leftover waits
  std::size_t top = 0;
  for (int s = 0; s < nodes_.size(); ++s) {
    for (; !stack.empty() && nodes_.parent[stack.back()] == s; stack.pop_back()) {
      children_[s].push_back(stack.back());
      top = leftover_at_[stack.back()];
    }
    leftover_at_.push_back(top);
    if (nodes_.parent[s] >= 0) {
      stack.push_back(s);
      top += triangle_size(nodes_.n_left(s));
      stack_size_ = std::max(stack_size_, top);
      place_leftover(s);
    }
    first_run_.push_back(int(run_.size()));
  }
  if (!stack.empty())
    throw std::logic_error("supernodes must follow their descendants");
}

void FrontPlan::place_leftover(int s)
{
  const std::span<const int> rows = nodes_.rows(s).subspan(nodes_.n_columns(s));
  const std::span<const int> above = nodes_.rows(nodes_.parent[s]);
  for (int i = 0; i < int(rows.size()); ++i) {
    const int to = int(std::ranges::lower_bound(above, rows[i]) - above.begin());
    if (i > 0 && run_.back().shift == to - i)
      run_.back().end = i + 1;
    else
      run_.push_back({i, i + 1, to - i});
  }
}

} // namespace dem
