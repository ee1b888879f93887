/// \file
/// Seeds of independent random streams, one for each effect and each repetition of a scene, so that adding an
/// effect never changes another's numbers.
#pragma once

#include <cstdint>
#include <string_view>

namespace stickslip::sim {

/// A bijection that spreads each bit over all. [Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014: SplitMix64; constants from there]
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

/// Seed of the stream that belongs to (seed, number), such as the repetitions of a scene.
[[nodiscard]] constexpr std::uint64_t stream_seed(std::uint64_t seed, std::uint64_t number) noexcept {
  return spread_bits(spread_bits(seed) ^ number);
}

/// Seed of the stream that belongs to (seed, name), such as the effects of a scene. The name enters
/// by FNV-1a. [Fowler, Noll and Vo; draft-eastlake-fnv-17, 64 bit]
[[nodiscard]] constexpr std::uint64_t stream_seed(std::uint64_t seed, std::string_view name) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char letter : name) hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
  return stream_seed(seed, hash);
}

}  // namespace stickslip::sim
