#include "dem/factor_strips.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace dem {

namespace {

constexpr int strip_width = 4;
constexpr int triangle_size = strip_width * strip_width;

/// Columns of a strip that begins at column j of n.
int width_at(int j, int n)
{
  return std::min(strip_width, n - j);
}

/// First row of the eights of a strip. Eights of all strips lie on one grid of rows, so that what
/// one strip has stored the next one loads as it was stored; rows before the strip's end get zeros.
int first_row(int j, int width)
{
  return (j + width) / n_lanes * n_lanes;
}

/// Eights of rows after the triangle of a strip.
int n_chunks(int j, int width, int n_rows)
{
  return n_rows > j + width ? (n_rows - first_row(j, width) + n_lanes - 1) / n_lanes : 0;
}

std::size_t strip_size(int j, int width, int n_rows)
{
  return triangle_size + std::size_t(n_chunks(j, width, n_rows)) * width * n_lanes;
}

/// Calls work with the width as a constant, so that loops over it unroll.
template <typename Work>
void with_width(int width, Work&& work)
{
  switch (width) {
  case 1:
    return work(std::integral_constant<int, 1>());
  case 2:
    return work(std::integral_constant<int, 2>());
  case 3:
    return work(std::integral_constant<int, 3>());
  default:
    return work(std::integral_constant<int, 4>());
  }
}

/// Solves the triangle of a strip forwards; Number is double or Lanes.
template <int width, typename Number, typename Stored>
std::array<Number, width> solve_triangle(const Stored* triangle, Number* front)
{
  std::array<Number, width> x;
  for (int a = 0; a < width; ++a) {
    x[a] = front[a];
    for (int b = 0; b < a; ++b)
      x[a] -= double(triangle[strip_width * a + b]) * x[b];
    front[a] = x[a] = x[a] * double(triangle[strip_width * a + a]);
  }
  return x;
}

template <typename Stored>
Stored* huge_array(std::size_t n)
{
  constexpr std::size_t page = std::size_t(1) << 21;
  const std::size_t bytes = (n * sizeof(Stored) / page + 1) * page;
  void* memory = std::aligned_alloc(page, bytes);
  if (!memory)
    throw std::bad_alloc();
  ::madvise(memory, bytes, MADV_HUGEPAGE); // a wish: without it all is the same, but slower
  return static_cast<Stored*>(memory);
}

Lanes eight(const double* values)
{
  Lanes result;
  std::memcpy(&result, values, sizeof result);
  return result;
}

Lanes eight(const float* values)
{
  typedef float HalfLanes __attribute__((vector_size(32)));
  HalfLanes result;
  std::memcpy(&result, values, sizeof result);
  return __builtin_convertvector(result, Lanes);
}

} // namespace

template <typename Stored>
void FactorStrips<Stored>::Free::operator()(Stored* p) const
{
  std::free(p);
}

template <typename Stored>
FactorStrips<Stored>::FactorStrips(std::vector<int> n_columns, std::vector<int> n_rows)
    : n_columns_(std::move(n_columns)), n_rows_(std::move(n_rows)), first_{0}
{
  std::size_t total = 0;
  for (std::size_t s = 0; s < n_columns_.size(); ++s) {
    for (int j = 0; j < n_columns_[s]; j += strip_width) {
      offset_.push_back(total); // for now counted from the end
      total += strip_size(j, width_at(j, n_columns_[s]), n_rows_[s]);
    }
    first_.push_back(offset_.size());
  }
  for (std::size_t k = 0; k < offset_.size(); ++k)
    offset_[k] = total - (k + 1 < offset_.size() ? offset_[k + 1] : total);
  values_.reset(huge_array<Stored>(total));
}

template <typename Stored>
template <typename Number>
void FactorStrips<Stored>::store(int s, const Number* block, std::size_t stride)
{
  const int n = n_columns_[s], n_rows = n_rows_[s];
  for (int j = 0, k = 0; j < n; j += strip_width, ++k) {
    const int width = width_at(j, n), begin = j + width;
    Stored* out = const_cast<Stored*>(strip(s, k));
    for (int a = 0; a < width; ++a)
      for (int b = 0; b <= a; ++b) {
        const Number value = block[(j + b) * stride + j + a];
        out[strip_width * a + b] = Stored(a == b ? 1 / value : value);
      }
    out += triangle_size;
    const Number* column = block + j * stride;
    const int chunks = n_chunks(j, width, n_rows);
    for (int c = 0; c < chunks; ++c) {
      const int row = first_row(j, width) + c * n_lanes;
      const bool inside = row >= begin && row + n_lanes <= n_rows;
      for (int a = 0; a < width; ++a, out += n_lanes)
        if (inside)
          std::copy_n(column + a * stride + row, n_lanes, out);
        else
          for (int r = 0; r < n_lanes; ++r)
            out[r] = Stored(row + r >= begin && row + r < n_rows ? column[a * stride + row + r]
                                                                 : Number(0));
    }
  }
}

namespace {

/// Fetches what forward elimination needs soon: it runs through the strips against their order in
/// memory, which the processor does not foresee.
template <typename Stored>
void fetch_before(const Stored* values)
{
  constexpr std::uintptr_t distance = 16384;
  __builtin_prefetch(
      reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(values) - distance));
}

} // namespace

template <typename Stored>
void FactorStrips<Stored>::eliminate(int s, double* front) const
{
  const int n = n_columns_[s];
  for (int j = 0, k = 0; j < n; j += strip_width, ++k)
    with_width(width_at(j, n), [&](auto constant) {
      constexpr int width = constant;
      const Stored* values = strip(s, k);
      const auto x = solve_triangle<width>(values, front + j);
      const Stored* column = values + triangle_size;
      double* rest = front + first_row(j, width);
      const int chunks = n_chunks(j, width, n_rows_[s]);
      constexpr int line = 64 / sizeof(Stored);
      for (int v = 0; v < triangle_size; v += line)
        fetch_before(values + v);
      for (int c = 0; c < chunks; ++c, rest += n_lanes, column += width * n_lanes) {
        for (int v = 0; v < width * n_lanes; v += line)
          fetch_before(column + v);
        Lanes r = eight(rest);
        for (int a = 0; a < width; ++a)
          r -= eight(column + n_lanes * a) * x[a];
        std::memcpy(rest, &r, sizeof r);
      }
    });
}

template <typename Stored>
void FactorStrips<Stored>::eliminate(int s, Lanes* front) const
{
  const int n = n_columns_[s];
  for (int j = 0, k = 0; j < n; j += strip_width, ++k)
    with_width(width_at(j, n), [&](auto constant) {
      constexpr int width = constant;
      const Stored* values = strip(s, k);
      const auto x = solve_triangle<width>(values, front + j);
      const Stored* column = values + triangle_size;
      const Stored* next = k + 1 < n_strips(s) ? strip(s, k + 1) : values;
      Lanes* rest = front + first_row(j, width);
      const int chunks = n_chunks(j, width, n_rows_[s]);
      for (int c = 0; c < chunks; ++c, rest += n_lanes, column += width * n_lanes) {
        for (int a = 0; a < width; ++a)
          __builtin_prefetch(next + n_lanes * (c * width + a));
        for (int r = 0; r < n_lanes; ++r) {
          Lanes sum = double(column[r]) * x[0];
          for (int a = 1; a < width; ++a)
            sum += double(column[n_lanes * a + r]) * x[a];
          rest[r] -= sum;
        }
      }
    });
}

template <typename Stored>
void FactorStrips<Stored>::substitute(int s, double* front) const
{
  const int n = n_columns_[s];
  for (int k = n_strips(s) - 1; k >= 0; --k) {
    const int j = k * strip_width;
    with_width(width_at(j, n), [&](auto constant) {
      constexpr int width = constant;
      const Stored* triangle = strip(s, k);
      const Stored* column = triangle + triangle_size;
      const double* rest = front + first_row(j, width);
      std::array<Lanes, width> sum{};
      const int chunks = n_chunks(j, width, n_rows_[s]);
      for (int c = 0; c < chunks; ++c, rest += n_lanes, column += width * n_lanes) {
        const Lanes r = eight(rest);
        for (int a = 0; a < width; ++a)
          sum[a] += eight(column + n_lanes * a) * r;
      }
      for (int a = width - 1; a >= 0; --a) {
        double x = front[j + a] - sum_of(sum[a]);
        for (int b = a + 1; b < width; ++b)
          x -= double(triangle[strip_width * b + a]) * front[j + b];
        front[j + a] = x * double(triangle[strip_width * a + a]);
      }
    });
  }
}

template class FactorStrips<double>;
template class FactorStrips<float>;
template void FactorStrips<double>::store(int, const double*, std::size_t);
template void FactorStrips<float>::store(int, const double*, std::size_t);
template void FactorStrips<float>::store(int, const float*, std::size_t);

} // namespace dem
