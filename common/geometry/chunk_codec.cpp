// SPDX-License-Identifier: Apache-2.0
// The encoded chunk, version 1. Little-endian.
//
//   u8  version = 1
//   u8  flags                bit 0 alpha-masked, 1 has uvs (else all zero), 2 one colour for all, 3 wide positions,
//                            4 wide uvs
//   u64 texture              content hash, 0 for none
//   f32 alpha cutoff         only with flag 0
//   u16 vertices (1 … 768), u16 triangles (1 … 256)
//   grid of positions, 3 components; grid of uvs, 2 components, only with flag 1:
//     i8 exponent, or kRawFloats;  then, unless raw, a signed varint per component: the least integer
//   u8×4 colour              only with flag 2
//   varint vertex bytes, varint index bytes: sizes of the two blocks below
//   zstd frame of: vertex block (meshoptimizer vertex codec), index block (meshoptimizer index codec)
//
// A vertex is a row of unsigned integers, 2 or (wide) 4 bytes each: x y z, then i16 normal ×2, then u v if present,
// then colour if not uniform; padded with zeros to a multiple of 4 bytes. value = (least + integer)·2^exponent: exact,
// since the encoder takes the finest bit any value uses as the grid. Values that no 32-bit range holds are stored as
// raw float bits (wide).
#include <meshoptimizer.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "common/geometry/chunk.h"

namespace farfield {
namespace {

constexpr std::uint8_t kVersion = 1;
constexpr std::int8_t kRawFloats = 127;
constexpr int kLeastExponent = -100, kGreatestExponent = 60;  // outside, values are raw
constexpr int kZstdLevel = 3;
constexpr std::size_t kMaxVertices = 3 * kMaxChunkTriangles;

enum Flags : std::uint8_t {
  kMasked = 1,
  kHasUv = 2,
  kUniformColour = 4,
  kWidePosition = 8,
  kWideUv = 16,
  kKnownFlags = 31
};

/// The integer grid of some float components of all vertices.
struct Grid {
  std::int8_t exponent = kRawFloats;
  std::int64_t least[3] = {0, 0, 0};
  bool is_wide = true;

  std::uint32_t code(float value, int component) const {
    if (exponent == kRawFloats) return std::bit_cast<std::uint32_t>(value);
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::ldexp(static_cast<double>(value), -exponent)) -
                                      least[component]);
  }
  float value(std::uint32_t code, int component) const {
    if (exponent == kRawFloats) return std::bit_cast<float>(code);
    return static_cast<float>(
        std::ldexp(static_cast<double>(least[component] + static_cast<std::int64_t>(code)), exponent));
  }
};

// The exponent of the lowest set bit of a finite, non-zero float.
int finest_bit(float value) {
  int exponent = 0;
  const auto mantissa = static_cast<std::uint32_t>(std::ldexp(std::abs(std::frexp(value, &exponent)), 24));
  return exponent - 24 + std::countr_zero(mantissa);
}

/// get(vertex, component) of all vertices decides the grid.
template <class Get>
Grid choose_grid(const std::vector<ChunkVertex>& vertices, int components, Get get) {
  int exponent = kGreatestExponent;
  float largest = 0;
  for (const ChunkVertex& vertex : vertices)
    for (int c = 0; c < components; ++c) {
      const float value = get(vertex, c);
      if (value != 0.0f) exponent = std::min(exponent, finest_bit(value));
      // Minus zero has no place on an integer grid and looks the same as zero: it becomes zero.
      largest = std::max(largest, std::abs(value));
    }
  Grid grid;
  if (exponent < kLeastExponent ||
      std::ldexp(static_cast<double>(largest), -exponent) > std::numeric_limits<std::int32_t>::max())
    return grid;
  grid.exponent = static_cast<std::int8_t>(exponent);
  std::int64_t range = 0;
  for (int c = 0; c < components; ++c) {
    std::int64_t low = std::numeric_limits<std::int64_t>::max(), high = std::numeric_limits<std::int64_t>::min();
    for (const ChunkVertex& vertex : vertices) {
      const auto integer = static_cast<std::int64_t>(std::ldexp(static_cast<double>(get(vertex, c)), -exponent));
      low = std::min(low, integer);
      high = std::max(high, integer);
    }
    grid.least[c] = low;
    range = std::max(range, high - low);
  }
  grid.is_wide = range > 0xffff;
  return grid;
}

/// Where the components of a vertex lie in its row.
struct RowLayout {
  std::size_t position_bytes, uv_bytes, size;
  bool has_uv, has_colour;

  explicit RowLayout(std::uint8_t flags)
      : position_bytes(flags & kWidePosition ? 4 : 2),
        uv_bytes(flags & kWideUv ? 4 : 2),
        has_uv(flags & kHasUv),
        has_colour(!(flags & kUniformColour)) {
    size = 3 * position_bytes + 4 + (has_uv ? 2 * uv_bytes : 0) + (has_colour ? 4 : 0);
    size = (size + 3) / 4 * 4;
  }
};

void put_code(std::uint8_t*& at, std::uint32_t code, std::size_t bytes) {
  std::memcpy(at, &code, bytes);  // little-endian: the low bytes come first
  at += bytes;
}

std::uint32_t get_code(const std::uint8_t*& at, std::size_t bytes) {
  std::uint32_t code = 0;
  std::memcpy(&code, at, bytes);
  at += bytes;
  return code;
}

void put_grid(ByteWriter& out, const Grid& grid, int components) {
  out.put(grid.exponent);
  if (grid.exponent == kRawFloats) return;
  for (int c = 0; c < components; ++c) out.put_signed(grid.least[c]);
}

std::optional<Grid> get_grid(ByteReader& in, int components, bool is_wide) {
  Grid grid;
  grid.is_wide = is_wide;
  grid.exponent = in.get<std::int8_t>();
  if (grid.exponent == kRawFloats) return is_wide ? std::optional(grid) : std::nullopt;
  if (grid.exponent < kLeastExponent || grid.exponent > kGreatestExponent) return std::nullopt;
  for (int c = 0; c < components; ++c) {
    grid.least[c] = in.get_signed();
    if (grid.least[c] < std::numeric_limits<std::int32_t>::min() ||
        grid.least[c] > std::numeric_limits<std::int32_t>::max())
      return std::nullopt;
  }
  return grid;
}

float position_component(const ChunkVertex& vertex, int c) {
  return vertex.position[c];
}
float uv_component(const ChunkVertex& vertex, int c) {
  return vertex.uv[c];
}

// The order in which the codecs predict best: triangles along strips, vertices by first use.
Chunk in_coding_order(const Chunk& chunk) {
  Chunk ordered = chunk;
  meshopt_optimizeVertexCacheStrip(ordered.indices.data(), chunk.indices.data(), chunk.indices.size(),
                                   chunk.vertices.size());
  std::vector<std::uint16_t> rank(chunk.vertices.size(), 0xffff);
  ordered.vertices.clear();
  for (std::uint16_t& index : ordered.indices) {
    if (rank[index] == 0xffff) {
      rank[index] = static_cast<std::uint16_t>(ordered.vertices.size());
      ordered.vertices.push_back(chunk.vertices[index]);
    }
    index = rank[index];
  }
  return ordered;
}

Bytes encode_rows(const Chunk& chunk, const RowLayout& layout, const Grid& positions, const Grid& uvs) {
  std::vector<std::uint8_t> rows(chunk.vertices.size() * layout.size, 0);
  for (std::size_t i = 0; i < chunk.vertices.size(); ++i) {
    const ChunkVertex& vertex = chunk.vertices[i];
    std::uint8_t* at = &rows[i * layout.size];
    for (int c = 0; c < 3; ++c) put_code(at, positions.code(vertex.position[c], c), layout.position_bytes);
    put_code(at, static_cast<std::uint16_t>(vertex.normal.x), 2);
    put_code(at, static_cast<std::uint16_t>(vertex.normal.y), 2);
    for (int c = 0; layout.has_uv && c < 2; ++c) put_code(at, uvs.code(vertex.uv[c], c), layout.uv_bytes);
    for (int c = 0; layout.has_colour && c < 4; ++c) put_code(at, vertex.colour[c], 1);
  }
  Bytes block(meshopt_encodeVertexBufferBound(chunk.vertices.size(), layout.size));
  block.resize(meshopt_encodeVertexBuffer(block.data(), block.size(), rows.data(), chunk.vertices.size(), layout.size));
  return block;
}

Bytes encode_indices(const Chunk& chunk) {
  Bytes block(meshopt_encodeIndexBufferBound(chunk.indices.size(), chunk.vertices.size()));
  block.resize(meshopt_encodeIndexBuffer(block.data(), block.size(), chunk.indices.data(), chunk.indices.size()));
  return block;
}

tl::unexpected<Error> bad(const char* what) {
  return fail(ErrorCode::kBadData, "encoded chunk: {}; ask the server for it again", what);
}

bool is_finite(const ChunkVertex& v) {
  return std::isfinite(v.position.x) && std::isfinite(v.position.y) && std::isfinite(v.position.z) &&
         std::isfinite(v.uv.x) && std::isfinite(v.uv.y);
}

}  // namespace

Bytes encode_chunk(const Chunk& source) {
  assert(!source.indices.empty() && source.indices.size() <= kMaxVertices && source.indices.size() % 3 == 0);
  const Chunk chunk = in_coding_order(source);
  const Grid positions = choose_grid(chunk.vertices, 3, position_component);
  const Grid uvs = choose_grid(chunk.vertices, 2, uv_component);
  const auto all = [&](auto test) { return std::all_of(chunk.vertices.begin(), chunk.vertices.end(), test); };
  std::uint8_t flags = chunk.is_alpha_masked ? kMasked : 0;
  if (!all([](const ChunkVertex& v) { return v.uv.x == 0.0f && v.uv.y == 0.0f; })) flags |= kHasUv;
  if (all([&](const ChunkVertex& v) { return v.colour == chunk.vertices.front().colour; })) flags |= kUniformColour;
  if (positions.is_wide) flags |= kWidePosition;
  if ((flags & kHasUv) && uvs.is_wide) flags |= kWideUv;

  const RowLayout layout(flags);
  Bytes blocks = encode_rows(chunk, layout, positions, uvs);
  const std::size_t vertex_bytes = blocks.size();
  const Bytes index_block = encode_indices(chunk);
  blocks.insert(blocks.end(), index_block.begin(), index_block.end());

  ByteWriter out;
  out.put(kVersion);
  out.put(flags);
  out.put(chunk.texture);
  if (flags & kMasked) out.put(chunk.alpha_cutoff);
  out.put(static_cast<std::uint16_t>(chunk.vertices.size()));
  out.put(static_cast<std::uint16_t>(chunk.indices.size() / 3));
  put_grid(out, positions, 3);
  if (flags & kHasUv) put_grid(out, uvs, 2);
  if (flags & kUniformColour) out.put(chunk.vertices.front().colour);
  out.put_varint(vertex_bytes);
  out.put_varint(index_block.size());
  const std::size_t header_bytes = out.size();
  Bytes bytes = out.take();
  bytes.resize(header_bytes + ZSTD_compressBound(blocks.size()));
  const std::size_t compressed =
      ZSTD_compress(bytes.data() + header_bytes, bytes.size() - header_bytes, blocks.data(), blocks.size(), kZstdLevel);
  assert(!ZSTD_isError(compressed));
  bytes.resize(header_bytes + compressed);
  return bytes;
}

Result<Chunk> decode_chunk(ByteView bytes) {
  ByteReader in(bytes);
  const auto version = in.get<std::uint8_t>();
  if (in.ok() && version != kVersion)
    return fail(ErrorCode::kVersionMismatch, "encoded chunk: version {}, this program reads {}; update the older side",
                version, kVersion);
  const auto flags = in.get<std::uint8_t>();
  if (flags & ~kKnownFlags) return bad("unknown flags");
  Chunk chunk;
  chunk.texture = in.get<ContentHash>();
  chunk.is_alpha_masked = flags & kMasked;
  if (chunk.is_alpha_masked) chunk.alpha_cutoff = in.get<float>();
  if (!std::isfinite(chunk.alpha_cutoff)) return bad("the alpha cutoff is not a number");
  const std::size_t vertices = in.get<std::uint16_t>();
  const std::size_t triangles = in.get<std::uint16_t>();
  if (!in.ok() || vertices < 1 || vertices > kMaxVertices || triangles < 1 || triangles > kMaxChunkTriangles)
    return bad("cut off, or more vertices or triangles than a chunk may hold");
  const std::optional<Grid> positions = get_grid(in, 3, flags & kWidePosition);
  const std::optional<Grid> uvs = flags & kHasUv ? get_grid(in, 2, flags & kWideUv) : Grid{};
  if (!in.ok() || !positions || !uvs) return bad("an impossible position or uv grid");
  glm::u8vec4 colour{0};
  if (flags & kUniformColour) colour = in.get<glm::u8vec4>();

  const RowLayout layout(flags);
  const std::uint64_t vertex_bytes = in.get_varint();
  const std::uint64_t index_bytes = in.get_varint();
  if (!in.ok() || vertex_bytes > meshopt_encodeVertexBufferBound(vertices, layout.size) ||
      index_bytes > meshopt_encodeIndexBufferBound(3 * triangles, vertices))
    return bad("cut off, or its blocks are larger than its counts allow");
  Bytes blocks(vertex_bytes + index_bytes);
  const ByteView packed = in.get_bytes(in.remaining());
  if (ZSTD_decompress(blocks.data(), blocks.size(), packed.data(), packed.size()) != blocks.size())
    return bad("its zstd frame is damaged");
  std::vector<std::uint8_t> rows(vertices * layout.size);
  if (meshopt_decodeVertexBuffer(rows.data(), vertices, layout.size, blocks.data(), vertex_bytes) != 0)
    return bad("its vertices are damaged");
  chunk.indices.resize(3 * triangles);
  if (meshopt_decodeIndexBuffer(chunk.indices.data(), chunk.indices.size(), blocks.data() + vertex_bytes,
                                index_bytes) != 0)
    return bad("its indices are damaged");
  if (*std::max_element(chunk.indices.begin(), chunk.indices.end()) >= vertices)
    return bad("an index points past the last vertex");

  chunk.vertices.resize(vertices);
  for (std::size_t i = 0; i < vertices; ++i) {
    ChunkVertex& vertex = chunk.vertices[i];
    const std::uint8_t* at = &rows[i * layout.size];
    for (int c = 0; c < 3; ++c) vertex.position[c] = positions->value(get_code(at, layout.position_bytes), c);
    vertex.normal.x = static_cast<std::int16_t>(get_code(at, 2));
    vertex.normal.y = static_cast<std::int16_t>(get_code(at, 2));
    vertex.uv = glm::vec2(0);
    for (int c = 0; layout.has_uv && c < 2; ++c) vertex.uv[c] = uvs->value(get_code(at, layout.uv_bytes), c);
    vertex.colour = colour;
    for (int c = 0; layout.has_colour && c < 4; ++c) vertex.colour[c] = static_cast<std::uint8_t>(get_code(at, 1));
    if (!is_finite(vertex)) return bad("a position or uv is not a number");
  }
  return chunk;
}

}  // namespace farfield
