#include "dem/frontal_cholesky.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace dem {

namespace {

/// The part of a vector that begins on a boundary of 64 bytes; the vector has room for it.
template <typename Number>
std::span<Number> aligned(std::vector<Number>& memory)
{
  constexpr std::size_t boundary = 64;
  const auto address = reinterpret_cast<std::uintptr_t>(memory.data());
  const std::size_t skip = (boundary - address % boundary) % boundary / sizeof(Number);
  return std::span(memory).subspan(skip);
}

/// Adds so many numbers side by side at once.
template <int n, typename Number>
void add_some(Number* to, const Number* from)
{
  typedef Number Some __attribute__((vector_size(n * sizeof(Number))));
  Some sum, more;
  std::memcpy(&sum, to, sizeof sum);
  std::memcpy(&more, from, sizeof more);
  sum += more;
  std::memcpy(to, &sum, sizeof sum);
}

/// Adds numbers side by side; most often they are those of few bodies, six each.
template <typename Number>
void add(Number* to, const Number* from, int n)
{
  int i = 0;
  for (; i + 8 <= n; i += 8)
    add_some<8>(to + i, from + i);
  if (n & 4) {
    add_some<4>(to + i, from + i);
    i += 4;
  }
  if (n & 2) {
    add_some<2>(to + i, from + i);
    i += 2;
  }
  if (n & 1)
    to[i] += from[i];
}

} // namespace

template <typename Number>
FrontalCholesky<Number>::FrontalCholesky(std::shared_ptr<const FrontPlan> plan)
    : plan_(std::move(plan)), leftover_(plan_->stack_size() + DenseFront<Number>::n_lanes)
{
  std::size_t largest = 0;
  for (int s = 0; s < plan_->nodes().size(); ++s)
    largest = std::max(largest, DenseFront<Number>::size(plan_->nodes().n_rows(s)));
  front_.resize(largest + DenseFront<Number>::n_lanes);
}

template <typename Number>
void FrontalCholesky<Number>::gather(int s, std::span<const double> values,
                                     DenseFront<Number>& front) const
{
  front.clear();
  const std::size_t stride = std::size_t(front.stride(plan_->nodes().n_rows(s)));
  for (const FrontPlan::EntryRun& run : plan_->entries(s)) {
    const double* from = values.data() + run.value;
    Number* to = front.column(run.column) + run.row;
    const std::size_t step = run.along_row ? stride : 1;
    for (int k = 0; k < run.size; ++k)
      to[k * step] = Number(from[k]);
  }
  for (const int child : plan_->children(s))
    gather_leftover(child, front);
}

template <typename Number>
void FrontalCholesky<Number>::gather_leftover(int child, DenseFront<Number>& front) const
{
  const Number* from = leftover_.data() + plan_->leftover_at(child);
  const auto runs = plan_->leftover(child);
  for (auto own = runs.begin(); own != runs.end(); ++own)
    for (int j = own->begin; j < own->end; ++j) {
      Number* column = front.column(j + own->shift);
      add(column + j + own->shift, from, own->end - j);
      from += own->end - j;
      for (auto run = own + 1; run != runs.end(); ++run) {
        const int n = run->end - run->begin;
        add(column + run->begin + run->shift, from, n);
        from += n;
      }
    }
}

/// Keeps what the front has left for the parent, in the place of what its children left. Whole
/// registers: the next column covers what is too much, and after the last one there is room.
template <typename Number>
void FrontalCholesky<Number>::leave(int s, const DenseFront<Number>& front)
{
  constexpr int n_lanes = DenseFront<Number>::n_lanes;
  Number* to = leftover_.data() + plan_->leftover_at(s);
  const int n_rows = plan_->nodes().n_rows(s);
  for (int j = plan_->nodes().n_columns(s); j < n_rows; ++j) {
    const Number* from = front.column(j) + j;
    const int n = n_rows - j;
    for (int i = 0; i < n; i += n_lanes)
      std::memcpy(to + i, from + i, n_lanes * sizeof(Number));
    to += n;
  }
}

template <typename Number>
bool FrontalCholesky<Number>::factorise(std::span<const double> values, const Store& store)
{
  const Supernodes& nodes = plan_->nodes();
  for (int s = 0; s < nodes.size(); ++s) {
    DenseFront<Number> front(aligned(front_), nodes.n_rows(s));
    gather(s, values, front);
    if (!front.eliminate(nodes.n_columns(s)))
      return false;
    store(s, front.column(0), std::size_t(front.stride(nodes.n_rows(s))));
    leave(s, front);
  }
  return true;
}

template class FrontalCholesky<double>;
template class FrontalCholesky<float>;

} // namespace dem
