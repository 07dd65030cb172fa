// SPDX-License-Identifier: Apache-2.0
// Tiles from anywhere: decode_tile(), and that what it accepts is a tile that the rest of the program may trust.
#include <cmath>

#include "common/codec/tile_codec.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const farfield::ByteView bytes(data, size);
  const auto accounting = farfield::inspect_tile(bytes);
  const auto tile = farfield::decode_tile(bytes);
  if (!tile) {
    require(!tile.error().message.empty(), "every error says what is wrong");
    return 0;
  }
  require(accounting.has_value(), "what can be decoded can be inspected");
  const std::size_t samples = tile->samples();
  require(tile->coverage.size() == samples && tile->disparity.size() == samples && tile->rgb.size() == 3 * samples &&
              tile->cut_right.size() == samples && tile->cut_down.size() == samples,
          "every array has the tile's size");
  for (std::size_t i = 0; i < samples; ++i) {
    require(tile->coverage[i] <= 1, "coverage is 0 or 1");
    require(tile->cut_right[i] <= 8 && tile->cut_down[i] <= 8, "cuts are 0 to 8");
    require(!tile->coverage[i] || std::isfinite(tile->disparity[i]), "disparity of covered samples is finite");
  }
  return 0;
}
