// SPDX-License-Identifier: Apache-2.0
// Tables between sRGB codes and linear light, for passes over a whole frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace farfield::client {

/// Linear light in 16 bits, and back from the upper 14 bits of it: finer than any step of the 8-bit code.
struct LightTables {
  static constexpr int kCodeBits = 14;
  std::array<std::uint16_t, 256> linear;
  std::vector<std::uint8_t> code;  // 2^kCodeBits

  /// Made when first asked for; constant, for any thread.
  static const LightTables& get();

 private:
  LightTables();
};

}  // namespace farfield::client
