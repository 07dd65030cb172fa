// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "common/codec/texture_codec.h"
#include "server/model/texture_file.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/seeds.h"
#include "tests/support/small_jpeg.h"

namespace farfield::fuzz {
namespace {

/// A square grid of `edge`² quads, bent.
Chunk grid_chunk(int edge, ContentHash texture, bool is_alpha_masked) {
  Chunk chunk;
  chunk.texture = texture;
  chunk.is_alpha_masked = is_alpha_masked;
  for (int y = 0; y <= edge; ++y) {
    for (int x = 0; x <= edge; ++x) {
      const glm::vec3 position(0.25f * static_cast<float>(x), 0.125f * static_cast<float>(x * y % 5), 0.25f * static_cast<float>(y));
      chunk.vertices.push_back({position, encode_normal({0, 1, 0}), {0.125f * static_cast<float>(x), 0.125f * static_cast<float>(y)},
                                glm::u8vec4(200, 10 * x, 10 * y, 255)});
    }
  }
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x) {
      const auto at = [&](int dx, int dy) { return static_cast<std::uint16_t>((y + dy) * (edge + 1) + x + dx); };
      for (const std::uint16_t index : {at(0, 0), at(1, 0), at(0, 1), at(0, 1), at(1, 0), at(1, 1)}) chunk.indices.push_back(index);
    }
  }
  return chunk;
}

std::vector<std::uint8_t> texels(int width, int height, bool is_opaque) {
  ByteWriter writer;
  for (int i = 0; i < width * height; ++i) {
    const auto step = static_cast<std::uint8_t>(i * 3);
    writer.put(glm::u8vec4(step, 255 - step, 40, is_opaque ? 255 : i % 256));
  }
  return writer.take();
}

}  // namespace

void add_geometry_seeds(Seeds& seeds) {
  seeds.push_back({"chunk", "one_quad", encode_chunk(grid_chunk(1, 0, false))});
  seeds.push_back({"chunk", "textured_grid", encode_chunk(grid_chunk(8, 0x1234567890abcdef, false))});
  seeds.push_back({"chunk", "alpha_masked", encode_chunk(grid_chunk(4, 7, true))});

  seeds.push_back({"texture_level", "one_texel", encode_texture_level({9, 3, 4, 1, 1, texels(1, 1, true)})});
  seeds.push_back({"texture_level", "opaque", encode_texture_level({9, 0, 5, 16, 12, texels(16, 12, true)})});
  seeds.push_back({"texture_level", "panels", encode_texture_level({9, 0, 6, 33, 17, texels(33, 17, true)})});
  seeds.push_back({"texture_level", "with_alpha", encode_texture_level({9, 1, 5, 17, 9, texels(17, 9, false)})});

  const auto add_png = [&](const char* name, int width, int height, bool is_opaque) {
    Result<Bytes> png = encode_png({width, height, texels(width, height, is_opaque), name});
    require(png.has_value(), "an image can be written");
    seeds.push_back({"texture_file", name, std::move(*png)});
  };
  add_png("opaque.png", 8, 5, true);
  add_png("with_alpha.png", 5, 8, false);
  seeds.push_back({"texture_file", "opaque.jpg", test::small_jpeg(texels(16, 9, true), 16, 9, 60)});
  seeds.push_back({"texture_file", "run_length.tga", {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 2, 0, 32, 8, 0x81, 1, 2, 3, 255,
                                                      1, 4, 5, 6, 0, 7, 8, 9, 128, 0x83, 10, 11, 12, 255}});
  seeds.push_back({"texture_file", "mapped.tga", {0, 1, 1, 0, 0, 2, 0, 24, 0, 0, 0, 0, 2, 0, 2, 0, 8, 0x20, 0, 0, 0, 1, 2, 3, 0, 1, 1, 0}});
}

}  // namespace farfield::fuzz
