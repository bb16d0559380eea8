#pragma once

namespace dem {

/// Eight numbers that are worked on at once; the compiler maps them to the registers there are.
typedef double Lanes __attribute__((vector_size(64)));

constexpr int n_lanes = 8;

inline Lanes no_lanes()
{
  return Lanes{};
}

inline double sum_of(const Lanes& x)
{
  return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

} // namespace dem
