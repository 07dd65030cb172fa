// SPDX-License-Identifier: Apache-2.0
// Chunks from anywhere: decode_chunk(), and that what it accepts can be drawn.
#include <cmath>

#include "common/geometry/chunk.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto chunk = farfield::decode_chunk({data, size});
  if (!chunk) {
    require(!chunk.error().message.empty(), "every error says what is wrong");
    return 0;
  }
  require(chunk->indices.size() % 3 == 0 && chunk->indices.size() <= 3 * farfield::kMaxChunkTriangles,
          "a chunk is at most kMaxChunkTriangles triangles");
  require(chunk->vertices.size() <= 3 * farfield::kMaxChunkTriangles, "a chunk has at most three vertices per triangle");
  for (const std::uint16_t index : chunk->indices) require(index < chunk->vertices.size(), "indices name vertices");
  for (const farfield::ChunkVertex& vertex : chunk->vertices) {
    for (int axis = 0; axis < 3; ++axis) require(std::isfinite(vertex.position[axis]), "positions are finite");
    require(std::isfinite(vertex.uv.x) && std::isfinite(vertex.uv.y), "texture coordinates are finite");
  }
  return 0;
}
