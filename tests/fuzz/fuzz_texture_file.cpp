// SPDX-License-Identifier: Apache-2.0
// PNG, JPEG and TGA textures from anywhere.
#include "server/model/texture_file.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto image = farfield::decode_texture({data, size});
  if (!image) {
    require(!image.error().message.empty(), "every error says what is wrong");
    return 0;
  }
  require(image->width >= 1 && image->height >= 1 && image->width <= farfield::kMaxTextureFileEdge &&
              image->height <= farfield::kMaxTextureFileEdge,
          "edges are within the limit");
  require(image->rgba.size() == std::size_t{4} * image->width * image->height, "four bytes per texel");
  return 0;
}
