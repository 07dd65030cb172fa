// SPDX-License-Identifier: Apache-2.0
#include "client/warp/light_tables.h"

#include <cmath>

#include "common/shading/shading.h"

namespace farfield::client {

LightTables::LightTables() : code(std::size_t{1} << kCodeBits) {
  for (int c = 0; c < 256; ++c) {
    linear[c] = static_cast<std::uint16_t>(std::lround(65535.0f * srgb_to_linear(static_cast<std::uint8_t>(c))));
  }
  const float light = static_cast<float>(1 << (16 - kCodeBits)) / 65535.0f;
  for (std::size_t i = 0; i < code.size(); ++i) code[i] = linear_to_srgb((static_cast<float>(i) + 0.5f) * light);
}

const LightTables& LightTables::get() {
  static const LightTables instance;
  return instance;
}

}  // namespace farfield::client
