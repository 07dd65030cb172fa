// SPDX-License-Identifier: Apache-2.0
// Of a tile's samples, what coding changes: as clients will have it.
#pragma once

#include <cstdint>
#include <vector>

namespace farfield {

/// Arrays as in Tile. Uncovered samples hold what decoders put there.
struct CodedSamples {
  std::vector<float> disparity;
  std::vector<std::uint8_t> rgb;
};

}  // namespace farfield
