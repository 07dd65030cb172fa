// SPDX-License-Identifier: Apache-2.0
// Reproducible random numbers for generators: the same keys give the same stream on every run and machine.
//
// Based on: Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom Number Generators" (SplitMix64).
// The standard library's distributions are avoided: their results differ from one library to the next.
#pragma once

#include <cstdint>
#include <iterator>

namespace farfield {

class RandomStream {
 public:
  /// The stream named by a seed and any number of integer keys (module coordinates, purpose …).
  template <class... Keys>
  explicit RandomStream(std::uint64_t seed, Keys... keys) : state_(seed) {
    ((state_ = mixed(state_ + kStep) ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(keys))), ...);
  }

  std::uint64_t bits() { return mixed(state_ += kStep); }
  /// Uniform in [0, 1), 53 bits.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  float between(float low, float high) { return low + (high - low) * static_cast<float>(unit()); }
  /// Uniform in 0 … count - 1. Requires: count > 0.
  int below(int count) { return static_cast<int>(unit() * count); }
  /// Uniform in low … high, both included.
  int between(int low, int high) { return low + below(high - low + 1); }
  bool chance(double probability) { return unit() < probability; }
  template <class Container>
  const auto& pick(const Container& container) {
    return container[static_cast<std::size_t>(below(static_cast<int>(std::size(container))))];
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ull;
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace farfield
