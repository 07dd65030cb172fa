// SPDX-License-Identifier: Apache-2.0
// Near geometry as server and client share it: chunks, where they stand, and the textures they use.
//
// A chunk is a cluster of at most kMaxChunkTriangles triangles of one material. Its vertices are floats relative to
// the chunk's own origin, in mesh axes; a placement carries it to cell-relative metres. An instanced mesh is sent
// once and placed often.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <vector>

#include "common/base/bytes.h"
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

/// Octahedral code of a unit normal (Meyer et al. 2010, "On floating-point normal vectors"), rounded to nearest:
/// off by at most 0.004 degrees. Components lie in -32767 … 32767. A zero or non-finite vector codes as +Z.
glm::i16vec2 encode_normal(const glm::vec3& unit_normal);

/// Returns: a unit vector. Light must be computed from this, not from the vector that was encoded: then server and
/// client agree to the bit.
inline glm::vec3 decode_normal(const glm::i16vec2& code) {
  const float x = static_cast<float>(code.x) * (1.0f / 32767.0f);
  const float y = static_cast<float>(code.y) * (1.0f / 32767.0f);
  const float z = 1.0f - std::abs(x) - std::abs(y);
  const float fold = z < 0.0f ? -z : 0.0f;  // the lower half is folded over the diagonals
  return glm::normalize(glm::vec3(x + (x < 0.0f ? fold : -fold), y + (y < 0.0f ? fold : -fold), z));
}

struct Chunk {
  ContentHash texture = 0;  // content hash of the texture, 0 for none
  bool is_alpha_masked = false;
  float alpha_cutoff = 0.5f;
  std::vector<ChunkVertex> vertices;      // at most 3·kMaxChunkTriangles
  std::vector<std::uint16_t> indices;     // three per triangle
};

/// Where one chunk stands: metres relative to the centre of the leaf cell it was selected for. Normals go through the
/// inverse transpose of its 3×3 part and are made unit again before they are lit.
struct ChunkPlacement {
  ContentHash chunk = 0;  // names the chunk's content as the scene holds it (SceneChunk::hash), not its encoded bytes
  glm::mat4x3 cell_from_chunk{1};  // columns: axes, then translation
};

/// Format: see chunk_codec.cpp. Deterministic and lossless but for order: triangles may come back reordered and
/// rotated, vertices renumbered; the picture is the same. Positions and uvs on a power-of-two grid (as the scene makes
/// them) cost least.
/// Requires: 1 … kMaxChunkTriangles triangles, every index below vertices.size(), finite positions and uvs.
Bytes encode_chunk(const Chunk& chunk);
/// Errors: kBadData, kVersionMismatch. Never allocates more than the limits above allow.
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

}  // namespace farfield
