// SPDX-License-Identifier: Apache-2.0
// Texture levels from anywhere: decode_texture_level(), and that what it accepts can be uploaded.
#include "common/codec/texture_codec.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto level = farfield::decode_texture_level({data, size});
  if (!level) {
    require(!level.error().message.empty(), "every error says what is wrong");
    return 0;
  }
  require(level->width >= 1 && level->height >= 1 && level->width <= farfield::kMaxTextureEdge &&
              level->height <= farfield::kMaxTextureEdge,
          "edges are within the limit");
  require(level->rgba.size() == std::size_t{4} * level->width * level->height, "four bytes per texel");
  require(level->level >= 0 && level->level < level->level_count, "the level is one of the texture's");
  return 0;
}
