#include "dem/frontal_cholesky.h"

#include <algorithm>
#include <cstdint>
#include <stdexcept>

namespace dem {

namespace {

std::size_t triangle_size(int n)
{
  return std::size_t(n) * (n + 1) / 2;
}

/// The part of a vector that begins on a boundary of 64 bytes; the vector has room for it.
template <typename Number>
std::span<Number> aligned(std::vector<Number>& memory)
{
  constexpr std::size_t boundary = 64;
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  const std::size_t skip = (boundary - address % boundary) % boundary / sizeof(Number);
  return std::span(memory).subspan(skip);
}

} // namespace

template <typename Number>
FrontalCholesky<Number>::FrontalCholesky(const SymmetricPattern& pattern,
                                         std::span<const int> position, Supernodes supernodes)
    : nodes_(std::move(supernodes))
{
  place_entries(pattern, position);
  place_leftovers();
  std::size_t largest = 0;
  for (int s = 0; s < nodes_.size(); ++s)
    largest = std::max(largest, DenseFront<Number>::size(int(nodes_.rows(s).size())));
  front_.resize(largest + DenseFront<Number>::n_lanes);
}

template <typename Number>
void FrontalCholesky<Number>::place_entries(const SymmetricPattern& pattern,
                                            std::span<const int> position)
{
  struct Placed {
    int row, column, value;
  };
  std::vector<Placed> placed;
  placed.reserve(pattern.row.size());
  for (int c = 0; c < pattern.size(); ++c)
    for (int p = pattern.column_start[c]; p < pattern.column_start[c + 1]; ++p) {
      const int a = position[c], b = position[pattern.row[p]];
      placed.push_back({std::max(a, b), std::min(a, b), p});
    }
  std::ranges::sort(placed, [](const Placed& a, const Placed& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  first_entry_.push_back(0);
  std::size_t next = 0;
  for (int s = 0; s < nodes_.size(); ++s) {
    const std::span<const int> rows = nodes_.rows(s);
    for (int c = nodes_.first_column[s]; c < nodes_.first_column[s + 1]; ++c) {
      for (; next < placed.size() && placed[next].column == c; ++next) {
        const auto row = std::ranges::lower_bound(rows, placed[next].row) - rows.begin();
        entry_.push_back({placed[next].value, int(row)});
      }
      first_entry_.push_back(int(entry_.size()));
    }
  }
}

template <typename Number>
void FrontalCholesky<Number>::place_leftovers()
{
  children_.resize(std::size_t(nodes_.size()));
  first_run_.push_back(0);
  std::vector<int> stack; // supernodes whose leftover waits
  std::size_t top = 0, highest = 0;
  for (int s = 0; s < nodes_.size(); ++s) {
    for (; !stack.empty() && nodes_.parent[stack.back()] == s; stack.pop_back()) {
      children_[s].push_back(stack.back());
      top = leftover_at_[stack.back()];
    }
    leftover_at_.push_back(top);
    if (const int parent = nodes_.parent[s]; parent >= 0) {
      stack.push_back(s);
      top += triangle_size(n_left(s));
      highest = std::max(highest, top);
      const std::span<const int> rows = nodes_.rows(s).subspan(nodes_.n_columns(s));
      const std::span<const int> above = nodes_.rows(parent);
      for (int i = 0; i < int(rows.size()); ++i) {
        const int to = int(std::ranges::lower_bound(above, rows[i]) - above.begin());
        if (i > 0 && run_.back().shift == to - i)
          run_.back().end = i + 1;
        else
          run_.push_back({i, i + 1, to - i});
      }
    }
    first_run_.push_back(int(run_.size()));
  }
  if (!stack.empty())
    throw std::logic_error("supernodes must follow their descendants");
  leftover_.resize(highest);
}

template <typename Number>
void FrontalCholesky<Number>::gather(int s, std::span<const double> values,
                                     DenseFront<Number>& front) const
{
  front.clear();
  for (int c = 0; c < nodes_.n_columns(s); ++c) {
    Number* column = front.column(c);
    const int k = nodes_.first_column[s] + c;
    for (int e = first_entry_[k]; e < first_entry_[k + 1]; ++e)
      column[entry_[e].row] += Number(values[entry_[e].value]);
  }
  for (const int child : children_[s]) {
    const Number* from = leftover_.data() + leftover_at_[child];
    const Run* last = run_.data() + first_run_[child + 1];
    for (const Run* own = run_.data() + first_run_[child]; own != last; ++own)
      for (int j = own->begin; j < own->end; ++j) {
        Number* column = front.column(j + own->shift);
        for (const Run* run = own; run != last; ++run)
          for (int i = std::max(run->begin, j); i < run->end; ++i)
            column[i + run->shift] += *from++;
      }
  }
}

/// Keeps what the front has left for the parent, in the place of what its children left.
template <typename Number>
void FrontalCholesky<Number>::leave(int s, const DenseFront<Number>& front)
{
  Number* to = leftover_.data() + leftover_at_[s];
  const int n = nodes_.n_columns(s), n_rows = int(nodes_.rows(s).size());
  for (int j = n; j < n_rows; ++j)
    to = std::copy(front.column(j) + j, front.column(j) + n_rows, to);
}

template <typename Number>
bool FrontalCholesky<Number>::factorise(std::span<const double> values, const Store& store)
{
  for (int s = 0; s < nodes_.size(); ++s) {
    DenseFront<Number> front(aligned(front_), int(nodes_.rows(s).size()));
    gather(s, values, front);
    if (!front.eliminate(nodes_.n_columns(s)))
      return false;
    store(s, front.column(0), std::size_t(front.stride(int(nodes_.rows(s).size()))));
    leave(s, front);
  }
  return true;
}

template class FrontalCholesky<double>;
template class FrontalCholesky<float>;

} // namespace dem
