// SPDX-License-Identifier: Apache-2.0
// Near geometry as server and client share it: chunks, where they stand, and the textures they use.
//
// A chunk is a cluster of at most kMaxChunkTriangles triangles of one material. Its vertices are floats relative to
// the chunk's own origin, in mesh axes; a placement carries it to cell-relative metres. An instanced mesh is sent
// once and placed often.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <vector>

#include "common/base/hash.h"
#include "common/base/result.h"

namespace farfield {

inline constexpr int kMaxChunkTriangles = 256;

struct ChunkVertex {
  glm::vec3 position;    // metres relative to the chunk's origin
  glm::i16vec2 normal;   // octahedral, snorm16, unit normal in mesh axes
  glm::vec2 uv;
  glm::u8vec4 colour;    // sRGB base colour × vertex colour
};

glm::i16vec2 encode_normal(const glm::vec3& unit_normal);
glm::vec3 decode_normal(const glm::i16vec2& code);

struct Chunk {
  ContentHash texture = 0;  // content hash of the texture, 0 for none
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;
  std::vector<ChunkVertex> vertices;      // at most 3·kMaxChunkTriangles
  std::vector<std::uint16_t> indices;     // three per triangle
};

/// Where one chunk stands: metres relative to the centre of the leaf cell it was selected for.
struct ChunkPlacement {
  ContentHash chunk = 0;
  glm::mat4x3 cell_from_chunk{1};  // columns: axes, then translation
};

/// Format: see chunk_codec.cpp. Deterministic: the bytes' hash is the chunk's content hash.
Bytes encode_chunk(const Chunk& chunk);
/// Errors: kBadData. Never allocates more than the limits above allow.
Result<Chunk> decode_chunk(ByteView bytes);

/// One mip level of a texture: 8-bit sRGB + alpha, rows top to bottom.
struct TextureLevel {
  ContentHash texture = 0;
  int level = 0;         // 0 is the full size
  int level_count = 1;
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

inline constexpr int kMaxTextureEdge = 4096;

/// JPEG 4:4:4 colour; alpha, where any texel is not opaque, by zstd.
Bytes encode_texture_level(const TextureLevel& level);
/// Errors: kBadData, kLimitExceeded (an edge beyond kMaxTextureEdge).
Result<TextureLevel> decode_texture_level(ByteView bytes);

}  // namespace farfield
