#pragma once
#include <array>

#if defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace dem {

/// Eight rows of eight numbers, turned: out[j][i] = row[i][j]. Rows and `out` lie on 64-byte
/// boundaries.
inline void transpose8(const std::array<const double*, 8>& row, double (&out)[8][8])
{
#if defined(__AVX512F__)
  __m512d r[8], p[8];
  for (int i = 0; i < 8; ++i)
    r[i] = _mm512_load_pd(row[i]);
  for (int i = 0; i < 8; i += 2) { // pairs
    p[i] = _mm512_unpacklo_pd(r[i], r[i + 1]);
    p[i + 1] = _mm512_unpackhi_pd(r[i], r[i + 1]);
  }
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  for (int h = 0; h < 8; h += 4) // quadruples
    for (int k = 0; k < 2; ++k) {
      r[h + k] = _mm512_permutex2var_pd(p[h + k], low, p[h + k + 2]);
      r[h + k + 2] = _mm512_permutex2var_pd(p[h + k], high, p[h + k + 2]);
    }
  for (int k = 0; k < 4; ++k) { // halves
    _mm512_store_pd(out[k], _mm512_shuffle_f64x2(r[k], r[k + 4], 0x44));
    _mm512_store_pd(out[k + 4], _mm512_shuffle_f64x2(r[k], r[k + 4], 0xee));
  }
#else
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      out[j][i] = row[i][j];
#endif
}

/// Adds eight numbers to eight others, both on 64-byte boundaries.
inline void add8(double* __restrict sum, const double* __restrict row)
{
#pragma omp simd
  for (int j = 0; j < 8; ++j)
    sum[j] += row[j];
}

} // namespace dem
