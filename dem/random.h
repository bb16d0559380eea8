#pragma once
#include <array>
#include <cstdint>

namespace dem {

/// Philox 4x32 with 10 rounds: four random words for a counter and a key, without any state.
/// Salmon, Moraes, Dror and Shaw, Proc. SC'11 (2011).
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key)
{
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = 0xD2511F53ull * counter[0], b = 0xCD9E8D57ull * counter[2];
    counter = {std::uint32_t(b >> 32) ^ counter[1] ^ key[0], std::uint32_t(b),
               std::uint32_t(a >> 32) ^ counter[3] ^ key[1], std::uint32_t(a)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// What a draw is for: streams never share numbers.
enum class RandomStream : std::uint32_t { strength = 1, packing = 2, power_iteration = 3 };

/// Uniform number in the open interval (0, 1), 52 bits: a pure function of its arguments, so a
/// sample depends neither on the order of the draws nor on threads.
/// \param id   what the number belongs to (bond or particle id)
/// \param draw counts repeated draws for the same id
constexpr double uniform(std::uint64_t seed, RandomStream stream, std::uint64_t id,
                         std::uint32_t draw = 0)
{
  const auto words =
      philox({std::uint32_t(id), std::uint32_t(id >> 32), draw, std::uint32_t(stream)},
             {std::uint32_t(seed), std::uint32_t(seed >> 32)});
  const std::uint64_t bits = (std::uint64_t(words[0]) << 32 | words[1]) >> 12; // 52 bits
  return (double(bits) + 0.5) * 0x1p-52;
}

} // namespace dem
