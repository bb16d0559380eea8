#include "dem/dense_front.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace dem {

namespace {

/// Columns that are finished at a time, and of a tile: eight columns of three registers fit.
constexpr int panel_width = 32, tile_width = 8, tile_height = 3;

template <typename Number>
struct Register;
template <>
struct Register<double> {
  typedef double Type __attribute__((vector_size(64)));
};
template <>
struct Register<float> {
  typedef float Type __attribute__((vector_size(64)));
};
template <typename Number>
using RegisterOf = typename Register<Number>::Type;

template <typename Number>
RegisterOf<Number> load(const Number* from)
{
  RegisterOf<Number> result;
  std::memcpy(&result, from, sizeof result);
  return result;
}

/// c -= a b^T for a tile of up to eight columns.
///
/// \param a, b   rows of the tile and rows of its columns, in columns that are done
template <int height, typename Number>
void update_tile(Number* c, const Number* a, const Number* b, std::size_t stride, int depth,
                 int n_columns)
{
  constexpr int n_lanes = DenseFront<Number>::n_lanes;
  RegisterOf<Number> sum[tile_width][height] = {};
  for (int k = 0; k < depth; ++k, a += stride, b += stride) {
    RegisterOf<Number> left[height];
#pragma GCC unroll 3
    for (int v = 0; v < height; ++v)
      left[v] = load(a + v * n_lanes);
#pragma GCC unroll 8
    for (int j = 0; j < tile_width; ++j)
#pragma GCC unroll 3
      for (int v = 0; v < height; ++v)
        sum[j][v] += left[v] * b[j];
  }
#pragma GCC unroll 8
  for (int j = 0; j < tile_width; ++j)
    if (j < n_columns)
#pragma GCC unroll 3
      for (int v = 0; v < height; ++v) {
        Number* to = c + std::size_t(j) * stride + v * n_lanes;
        const RegisterOf<Number> left = load(to) - sum[j][v];
        std::memcpy(to, &left, sizeof left);
      }
}

/// Triangle of a block on the diagonal, reciprocals on its own diagonal; the identity beyond.
template <typename Number>
using Triangle = Number[tile_width][tile_width];

template <typename Number>
bool factor_triangle(const Number* block, std::size_t stride, int width, Triangle<Number>& l)
{
  for (int i = 0; i < tile_width; ++i)
    for (int j = 0; j < tile_width; ++j)
      l[i][j] = i == j ? 1 : 0;
  for (int j = 0; j < width; ++j)
    for (int i = j; i < width; ++i) {
      Number sum = block[std::size_t(j) * stride + i];
      for (int k = 0; k < j; ++k)
        sum -= l[i][k] * l[j][k];
      if (i == j && !(sum > 0))
        return false;
      l[i][j] = i == j ? 1 / std::sqrt(sum) : sum * l[j][j];
    }
  return true;
}

/// Rows of L beside a triangle, a register of rows at a time.
template <typename Number>
void solve_rows(const Triangle<Number>& l, Number* rows, std::size_t stride, int width)
{
  RegisterOf<Number> x[tile_width];
#pragma GCC unroll 8
  for (int j = 0; j < tile_width; ++j) {
    if (j < width)
      x[j] = load(rows + j * stride);
    else
      x[j] = RegisterOf<Number>{};
#pragma GCC unroll 8
    for (int k = 0; k < j; ++k)
      x[j] -= x[k] * l[j][k];
    x[j] = x[j] * l[j][j];
    if (j < width)
      std::memcpy(rows + j * stride, &x[j], sizeof x[j]);
  }
}

} // namespace

template <typename Number>
DenseFront<Number>::DenseFront(std::span<Number> values, int n_rows)
    : values_(values.data()), n_rows_(n_rows), stride_(std::size_t(stride(n_rows)))
{
}

template <typename Number>
void DenseFront<Number>::clear()
{
  for (int j = 0; j < n_rows_; ++j)
    std::fill(column(j) + j / n_lanes * n_lanes, column(j) + stride_, Number(0));
}

/// Takes columns [from, to) off columns [first, last).
template <typename Number>
void DenseFront<Number>::update(int first, int last, int from, int to)
{
  const int end = (n_rows_ + n_lanes - 1) / n_lanes * n_lanes;
  for (int j = first; j < last; j += tile_width) {
    const int n_columns = std::min(tile_width, last - j);
    const Number* b = column(from) + j;
    for (int i = j / n_lanes * n_lanes; i < end;) {
      const int height = std::min(tile_height, (end - i) / n_lanes);
      const auto tile = height == 3   ? update_tile<3, Number>
                        : height == 2 ? update_tile<2, Number>
                                      : update_tile<1, Number>;
      tile(column(j) + i, column(from) + i, b, stride_, to - from, n_columns);
      i += height * n_lanes;
    }
  }
}

template <typename Number>
bool DenseFront<Number>::factor_block(int first, int width)
{
  Triangle<Number> triangle;
  if (!factor_triangle(column(first) + first, stride_, width, triangle))
    return false;
  for (int i = first / n_lanes * n_lanes; i < n_rows_; i += n_lanes) // the triangle's rows too
    solve_rows(triangle, column(first) + i, stride_, width);
  return true;
}

template <typename Number>
bool DenseFront<Number>::eliminate(int n_columns)
{
  for (int panel = 0; panel < n_columns; panel += panel_width) {
    const int end = std::min(panel + panel_width, n_columns);
    for (int j = panel; j < end; j += tile_width) {
      const int width = std::min(tile_width, end - j);
      update(j, j + width, panel, j);
      if (!factor_block(j, width))
        return false;
    }
    update(end, n_rows_, panel, end);
  }
  return true;
}

template class DenseFront<double>;
template class DenseFront<float>;

} // namespace dem
