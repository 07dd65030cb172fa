// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "common/geometry/chunk.h"

namespace farfield {
namespace {

// A bumpy patch of rows × rows squares.
Chunk patch(int rows, float scale, bool has_uv, bool is_coloured, unsigned seed = 1) {
  std::mt19937 random(seed);
  Chunk chunk;
  chunk.texture = has_uv ? 0x123456789abcdef0ull : 0;
  const float step = std::ldexp(1.0f, -16);
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= rows; ++x) {
      ChunkVertex vertex;
      vertex.position = glm::vec3(static_cast<float>(x - rows / 2), static_cast<float>(random() % 1000) * 1e-3f,
                                  static_cast<float>(y - rows / 2)) *
                        scale;
      vertex.position = glm::round(vertex.position / step) * step;
      vertex.normal = encode_normal(glm::normalize(glm::vec3(static_cast<float>(random() % 100) * 0.01f, 1, 0.1f)));
      vertex.uv = has_uv ? glm::vec2(static_cast<float>(x), static_cast<float>(y)) / 16.0f : glm::vec2(0);
      vertex.colour = is_coloured ? glm::u8vec4(random() % 256, 7, 9, 255) : glm::u8vec4(10, 20, 30, 255);
      chunk.vertices.push_back(vertex);
    }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < rows; ++x) {
      const auto at = [&](int i, int j) { return static_cast<std::uint16_t>((y + j) * (rows + 1) + x + i); };
      chunk.indices.insert(chunk.indices.end(), {at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)});
    }
  return chunk;
}

// Triangles as a set of rotated triples of vertex bytes: what encoding must keep.
std::multiset<std::string> triangles_of(const Chunk& chunk) {
  std::multiset<std::string> result;
  const auto bytes = [&](std::uint16_t index) {
    const ChunkVertex& v = chunk.vertices[index];
    std::string s(24 + 4, '\0');
    std::memcpy(s.data(), &v.position, 12);
    std::memcpy(s.data() + 12, &v.normal, 4);
    std::memcpy(s.data() + 16, &v.uv, 8);
    std::memcpy(s.data() + 24, &v.colour, 4);
    return s;
  };
  for (std::size_t i = 0; i < chunk.indices.size(); i += 3) {
    const std::string a = bytes(chunk.indices[i]), b = bytes(chunk.indices[i + 1]), c = bytes(chunk.indices[i + 2]);
    result.insert(std::min(std::min(a + b + c, b + c + a), c + a + b));
  }
  return result;
}

TEST(ChunkCodec, ComesBackAsItWas) {
  Chunk masked = patch(11, 0.1f, true, true);
  masked.is_alpha_masked = true;
  masked.alpha_cutoff = 0.3f;
  Chunk wide = patch(5, 1000.0f, true, false);
  wide.vertices[3].uv = {70000.25f, -3};
  Chunk odd = patch(3, 1.0f, true, true);
  odd.vertices[0].position = {1e-30f, 3e20f, -0.1f};  // no grid holds these: raw floats
  odd.vertices[1].uv = {1e-20f, 1e10f};
  Chunk single = patch(1, 1.0f, false, false);
  single.indices.resize(3);
  single.vertices.resize(4);
  for (const Chunk& chunk : {patch(11, 0.01f, false, false), masked, wide, odd}) {
    const Bytes bytes = encode_chunk(chunk);
    const auto decoded = decode_chunk(bytes);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(triangles_of(*decoded), triangles_of(chunk));
    EXPECT_EQ(decoded->texture, chunk.texture);
    EXPECT_EQ(decoded->is_alpha_masked, chunk.is_alpha_masked);
    EXPECT_FLOAT_EQ(decoded->alpha_cutoff, chunk.alpha_cutoff);
    EXPECT_EQ(encode_chunk(chunk), bytes) << "deterministic";
  }
  const auto decoded = decode_chunk(encode_chunk(single));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->vertices.size(), 3u) << "vertices no triangle uses are not sent";
}

TEST(ChunkCodec, IsCompact) {
  const Chunk chunk = patch(11, 0.01f, false, false);
  EXPECT_LT(encode_chunk(chunk).size(), chunk.indices.size() / 3 * 7) << "under 7 bytes per triangle of a bumpy patch";
}

TEST(ChunkCodec, AnyTruncationIsAnError) {
  const Bytes bytes = encode_chunk(patch(4, 0.01f, true, true));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto decoded = decode_chunk(ByteView(bytes).first(size));
    EXPECT_FALSE(decoded) << size;
  }
}

TEST(ChunkCodec, AnyBytesGiveAValueWithinTheLimitsOrAnError) {
  const Bytes bytes = encode_chunk(patch(4, 0.01f, true, true));
  std::mt19937 random(5);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes damaged = bytes;
    for (int hits = 1 + static_cast<int>(random() % 3); hits > 0; --hits)
      damaged[random() % (round % 2 ? damaged.size() : 40)] = static_cast<std::uint8_t>(random());
    const auto decoded = decode_chunk(damaged);
    if (!decoded) continue;
    ++accepted;
    ASSERT_LE(decoded->indices.size(), 3u * kMaxChunkTriangles);
    for (const std::uint16_t index : decoded->indices) ASSERT_LT(index, decoded->vertices.size());
    for (const ChunkVertex& v : decoded->vertices)
      ASSERT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
  }
  EXPECT_LT(accepted, 20000);
}

TEST(ChunkCodec, NamesTheVersionItCannotRead) {
  Bytes bytes = encode_chunk(patch(2, 1, false, false));
  bytes[0] = 9;
  const auto decoded = decode_chunk(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::kVersionMismatch);
}

TEST(NormalCode, IsOffByLessThanItsBound) {
  std::mt19937 random(1);
  std::normal_distribution<float> gauss;
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(gauss(random), gauss(random), gauss(random)));
    const glm::dvec3 back(decode_normal(encode_normal(glm::vec3(n))));
    EXPECT_NEAR(glm::length(back), 1.0, 1e-6);
    worst = std::max(worst, glm::length(glm::cross(n, back)));
  }
  EXPECT_LT(worst * 180 / M_PI, 0.004);
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f}) {
      glm::vec3 n(0);
      n[axis] = sign;
      EXPECT_EQ(decode_normal(encode_normal(n)), n) << "axes are exact";
    }
  EXPECT_EQ(decode_normal(encode_normal(glm::vec3(0))), glm::vec3(0, 0, 1));
}

}  // namespace
}  // namespace farfield
