#include "dem/factor_strips.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
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

/// Eights of rows after the triangle of a strip.
int n_chunks(int j, int width, int n_rows)
{
  return (n_rows - j - width + n_lanes - 1) / n_lanes;
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
template <int width, typename Number>
std::array<Number, width> solve_triangle(const double* triangle, Number* front)
{
  std::array<Number, width> x;
  for (int a = 0; a < width; ++a) {
    x[a] = front[a];
    for (int b = 0; b < a; ++b)
      x[a] -= triangle[strip_width * a + b] * x[b];
    front[a] = x[a] = x[a] * triangle[strip_width * a + a];
  }
  return x;
}

double* huge_array(std::size_t n)
{
  constexpr std::size_t page = std::size_t(1) << 21;
  const std::size_t bytes = (n * sizeof(double) / page + 1) * page;
  void* memory = std::aligned_alloc(page, bytes);
  if (!memory)
    throw std::bad_alloc();
  ::madvise(memory, bytes, MADV_HUGEPAGE); // a wish: without it all is the same, but slower
  return static_cast<double*>(memory);
}

} // namespace

void FactorStrips::Free::operator()(double* p) const
{
  std::free(p);
}

FactorStrips::FactorStrips(std::vector<int> n_columns, std::vector<int> n_rows)
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
  values_.reset(huge_array(total));
}

void FactorStrips::store(int s, const double* block)
{
  const int n = n_columns_[s], n_rows = n_rows_[s];
  for (int j = 0, k = 0; j < n; j += strip_width, ++k) {
    const int width = width_at(j, n), begin = j + width;
    double* out = const_cast<double*>(strip(s, k));
    for (int a = 0; a < width; ++a)
      for (int b = 0; b <= a; ++b) {
        const double value = block[std::size_t(j + b) * n_rows + j + a];
        out[strip_width * a + b] = a == b ? 1 / value : value;
      }
    out += triangle_size;
    const double* column = block + std::size_t(j) * n_rows;
    int row = begin;
    for (; row + n_lanes <= n_rows; row += n_lanes)
      for (int a = 0; a < width; ++a, out += n_lanes)
        std::memcpy(out, column + std::size_t(a) * n_rows + row, sizeof(Lanes));
    for (int a = 0; a < width && row < n_rows; ++a, out += n_lanes)
      for (int r = 0; r < n_lanes; ++r)
        out[r] = row + r < n_rows ? column[std::size_t(a) * n_rows + row + r] : 0.0;
  }
}

void FactorStrips::eliminate(int s, double* front) const
{
  const int n = n_columns_[s];
  for (int j = 0, k = 0; j < n; j += strip_width, ++k)
    with_width(width_at(j, n), [&](auto constant) {
      constexpr int width = constant;
      const double* values = strip(s, k);
      const auto x = solve_triangle<width>(values, front + j);
      const auto* column = reinterpret_cast<const Lanes*>(values + triangle_size);
      double* rest = front + j + width;
      const int chunks = n_chunks(j, width, n_rows_[s]);
      for (int c = 0; c < chunks; ++c, rest += n_lanes, column += width) {
        Lanes r;
        std::memcpy(&r, rest, sizeof r);
        for (int a = 0; a < width; ++a)
          r -= column[a] * x[a];
        std::memcpy(rest, &r, sizeof r);
      }
    });
}

void FactorStrips::eliminate(int s, Lanes* front) const
{
  const int n = n_columns_[s];
  for (int j = 0, k = 0; j < n; j += strip_width, ++k)
    with_width(width_at(j, n), [&](auto constant) {
      constexpr int width = constant;
      const double* values = strip(s, k);
      const auto x = solve_triangle<width>(values, front + j);
      const double* column = values + triangle_size;
      const double* next = k + 1 < n_strips(s) ? strip(s, k + 1) : values;
      Lanes* rest = front + j + width;
      const int chunks = n_chunks(j, width, n_rows_[s]);
      for (int c = 0; c < chunks; ++c, rest += n_lanes, column += width * n_lanes) {
        for (int a = 0; a < width; ++a)
          __builtin_prefetch(next + n_lanes * (c * width + a));
        for (int r = 0; r < n_lanes; ++r) {
          Lanes sum = column[r] * x[0];
          for (int a = 1; a < width; ++a)
            sum += column[n_lanes * a + r] * x[a];
          rest[r] -= sum;
        }
      }
    });
}

void FactorStrips::substitute(int s, double* front) const
{
  const int n = n_columns_[s];
  for (int k = n_strips(s) - 1; k >= 0; --k) {
    const int j = k * strip_width;
    with_width(width_at(j, n), [&](auto constant) {
      constexpr int width = constant;
      const double* triangle = strip(s, k);
      const auto* column = reinterpret_cast<const Lanes*>(triangle + triangle_size);
      const double* rest = front + j + width;
      std::array<Lanes, width> sum{};
      const int chunks = n_chunks(j, width, n_rows_[s]);
      for (int c = 0; c < chunks; ++c, rest += n_lanes, column += width) {
        Lanes r;
        std::memcpy(&r, rest, sizeof r);
        for (int a = 0; a < width; ++a)
          sum[a] += column[a] * r;
      }
      for (int a = width - 1; a >= 0; --a) {
        double x = front[j + a] - sum_of(sum[a]);
        for (int b = a + 1; b < width; ++b)
          x -= triangle[strip_width * b + a] * front[j + b];
        front[j + a] = x * triangle[strip_width * a + a];
      }
    });
  }
}

} // namespace dem
