// SPDX-License-Identifier: Apache-2.0
#include "common/shading/shading.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace farfield {
namespace {

float decode(float code) { return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f); }

// srgb_to_linear at the rounding border below each code: value >= border[c] rounds to at least c.
struct Tables {
  std::array<float, 256> linear;
  std::array<float, 256> border;
  std::array<std::uint8_t, 4096> first_guess;
  Tables() {
    for (int c = 0; c < 256; ++c) {
      linear[c] = decode(static_cast<float>(c) / 255.0f);
      border[c] = c == 0 ? 0.0f : decode((static_cast<float>(c) - 0.5f) / 255.0f);
    }
    int code = 0;
    for (int i = 0; i < 4096; ++i) {
      while (code < 255 && static_cast<float>(i) / 4096.0f >= border[code + 1]) ++code;
      first_guess[i] = static_cast<std::uint8_t>(code);
    }
  }
};

const Tables& tables() {
  static const Tables instance;
  return instance;
}

}  // namespace

float srgb_to_linear(std::uint8_t value) { return tables().linear[value]; }

std::uint8_t linear_to_srgb(float value) {
  if (!(value > 0.0f)) return 0;
  if (value >= 1.0f) return 255;
  const Tables& t = tables();
  int code = t.first_guess[static_cast<int>(value * 4096.0f)];
  while (code < 255 && value >= t.border[code + 1]) ++code;
  return static_cast<std::uint8_t>(code);
}

}  // namespace farfield
