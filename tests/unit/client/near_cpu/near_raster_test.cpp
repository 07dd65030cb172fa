// SPDX-License-Identifier: Apache-2.0
// The rasteriser of near geometry: against OpenGL, and where only exact answers will do.
#include "client/near_cpu/near_raster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "client/gl/framebuffer.h"
#include "client/warp/splat_key.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr Display kDisplay{161, 120, 1.0471975511965976};
constexpr std::size_t kPixels = 161 * 120;
constexpr double kNearPlane = 0.001;

LeafView empty_leaf() {
  LeafView leaf;
  // A cell far from the scene's zero: nothing may depend on large floats.
  leaf.leaf_box = {glm::dvec3(1e6, 2e6, -3e6), glm::dvec3(1e6 + 1, 2e6 + 1, -3e6 + 1)};
  leaf.near_region = leaf.leaf_box.grown(20);
  return leaf;
}

void add(LeafView& leaf, Chunk chunk, std::shared_ptr<const DecodedTexture> texture = nullptr) {
  static std::uint64_t serial = 0;  // renderers keep what they prepared by it
  auto decoded = std::make_shared<DecodedChunk>();
  decoded->serial = ++serial;
  chunk.texture = texture ? texture->hash : 0;
  decoded->chunk = std::move(chunk);
  leaf.chunks.push_back({decoded, texture, glm::mat4x3{1}});
}

/// Smooth colours and their mips; alpha is 255 on the left half only.
std::shared_ptr<DecodedTexture> picture(int size) {
  auto texture = std::make_shared<DecodedTexture>();
  texture->hash = texture->serial = static_cast<std::uint64_t>(size);
  for (int width = 1; width <= size; width *= 2) {
    TextureLevel level;
    level.width = level.height = width;
    for (int y = 0; y < width; ++y) {
      for (int x = 0; x < width; ++x) {
        const double s = 6.283 * (x + 0.5) / width, t = 6.283 * (y + 0.5) / width;
        for (const double value : {128 + 100 * std::sin(s), 128 + 100 * std::cos(t), 60 + 50 * std::sin(s + t)})
          level.rgba.push_back(static_cast<std::uint8_t>(value));
        level.rgba.push_back(2 * x < width ? 255 : 0);
      }
    }
    texture->levels.push_back(std::move(level));
  }
  return texture;
}

ChunkVertex vertex(const glm::vec3& position, const glm::vec2& uv, const glm::u8vec4& colour) {
  return {position, encode_normal(glm::normalize(position + glm::vec3(0.1f, 0.2f, 0.3f))), uv, colour};
}

/// A wall in the plane z, |x|, |y| <= half.
Chunk wall(float z, float half, const glm::u8vec4& colour) {
  Chunk chunk;
  for (const glm::vec2& c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
    chunk.vertices.push_back({{half * c.x, half * c.y, z}, encode_normal({0, 0, 1}), {0.5f + 0.5f * c.x, 0.5f - 0.5f * c.y}, colour});
  chunk.indices = {0, 1, 2, 0, 2, 3};
  return chunk;
}

std::vector<std::uint64_t> rasterised(const LeafView& leaf, Pose pose, int band = kDisplay.height, double near_plane = kNearPlane) {
  pose.position += leaf.leaf_box.center();
  NearRaster raster;
  raster.begin(leaf, pose, kDisplay, near_plane);
  std::vector<std::uint64_t> keys(kPixels, 99);
  for (int row = 0; row < kDisplay.height; row += band)
    raster.draw_rows(kDisplay, row, std::min(row + band, kDisplay.height), keys.data());
  return keys;
}

std::uint64_t key_at(const std::vector<std::uint64_t>& keys, int x, int y) { return keys[static_cast<std::size_t>(y * kDisplay.width + x)]; }

LeafView random_scene(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
  const auto colour = [&] { return glm::u8vec4(random() % 256, random() % 256, random() % 256, 255); };
  LeafView leaf = empty_leaf();
  const auto texture = picture(64);
  for (int k = 0; k < 40; ++k) {
    Chunk chunk;
    chunk.is_alpha_masked = k % 4 == 3;
    const glm::vec3 middle(uniform(-3, 3), uniform(-3, 3), uniform(-6, 2));  // some around and behind the eye
    for (int corner = 0; corner < 3; ++corner) {
      const glm::vec3 at = middle + glm::vec3(uniform(-2, 2), uniform(-2, 2), uniform(-2, 2));
      chunk.vertices.push_back(vertex(at, {uniform(-2, 2), uniform(-2, 2)}, colour()));
    }
    chunk.indices = {0, 1, 2};
    add(leaf, chunk, k % 2 ? texture : nullptr);
  }
  return leaf;
}

TEST(NearRaster, AgreesWithOpenGl) {
  auto context = GlContext::create_surfaceless();
  ASSERT_TRUE(context) << context.error().message;
  auto renderer = NearRenderer::create((*context)->abilities());
  auto target = Framebuffer::create((*context)->abilities(), kDisplay.width, kDisplay.height, 1);
  ASSERT_TRUE(renderer && target);
  std::vector<std::uint8_t> colour(4 * kPixels);
  std::vector<float> depth(kPixels);
  std::size_t differing = 0, covered = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const LeafView leaf = random_scene(seed);
    Pose pose{{0.1, 0.2, 0.3}, glm::dquat(glm::dvec3(0.1, 0.2 * seed, 0.3))};
    const std::vector<std::uint64_t> keys = rasterised(leaf, pose);
    pose.position += leaf.leaf_box.center();
    target->begin();
    (*renderer)->draw(leaf, ViewTransform::of(kDisplay, pose, kNearPlane));
    target->read_colour(colour);
    target->read_depth(depth);
    for (std::size_t p = 0; p < kPixels; ++p) {
      bool is_alike = (keys[p] != kNoSplat) == (colour[4 * p + 3] != 0);
      covered += keys[p] != kNoSplat;
      if (is_alike && keys[p] != kNoSplat) {
        EXPECT_TRUE(key_is_near(keys[p]));
        const double expected = depth[p] / kNearPlane;
        is_alike = std::abs(key_disparity(keys[p]) - expected) <= 1e-4 * expected;
        for (int c = 0; c < 3; ++c)
          is_alike = is_alike && std::abs(static_cast<int>(key_colour(keys[p]) >> (8 * c) & 255) - colour[4 * p + static_cast<std::size_t>(c)]) <= 3;
      }
      differing += !is_alike;
    }
  }
  EXPECT_GT(covered, 3 * kPixels);
  EXPECT_LT(differing, covered / 100) << "more than pixels along edges, which OpenGL rounds to sixteenths or finer";
}

TEST(NearRaster, SurfacesWithoutGapsHaveNone) {
  constexpr int kAcross = 14;
  std::mt19937 random(3);
  const auto off = [&] { return std::uniform_real_distribution<float>(-0.3f, 0.3f)(random); };
  for (int trial = 0; trial < 12; ++trial) {
    Chunk chunk;
    for (int j = 0; j <= kAcross; ++j)
      for (int i = 0; i <= kAcross; ++i)
        chunk.vertices.push_back(vertex({static_cast<float>(i) - 7 + off(), static_cast<float>(j) - 7 + off(), -2 + off()}, {}, {200, 100, 50, 255}));
    for (std::uint16_t j = 0; j < kAcross; ++j) {
      for (std::uint16_t i = 0; i < kAcross; ++i) {
        const auto a = static_cast<std::uint16_t>(j * (kAcross + 1) + i), b = static_cast<std::uint16_t>(a + kAcross + 1);
        for (const int index : {a + 0, a + 1, b + 1, a + 0, b + 1, b + 0}) chunk.indices.push_back(static_cast<std::uint16_t>(index));
      }
    }
    LeafView leaf = empty_leaf();
    add(leaf, chunk);
    const std::vector<std::uint64_t> keys = rasterised(leaf, {{0, 0, 0.1 * trial}, glm::dquat(glm::dvec3(0.02 * trial, 0.01, 0.5 * trial))});
    EXPECT_EQ(std::count(keys.begin(), keys.end(), kNoSplat), 0) << trial;
  }
}

TEST(NearRaster, BandsChangeNothing) {
  const LeafView leaf = random_scene(5);
  const Pose pose{{0.1, 0.2, 0.3}, glm::dquat(glm::dvec3(0.1, 0.2, 0.3))};
  EXPECT_EQ(rasterised(leaf, pose, 7), rasterised(leaf, pose));
}

TEST(NearRaster, AFloorUnderTheEyeIsExactEverywhere) {
  LeafView leaf = empty_leaf();
  Chunk floor;  // one triangle that reaches far behind the eye
  for (const glm::vec3& p : {glm::vec3(-19, -0.05f, -19), glm::vec3(19, -0.05f, -19), glm::vec3(0, -0.05f, 19)}) floor.vertices.push_back(vertex(p, {}, {255, 255, 255, 255}));
  floor.indices = {0, 1, 2};
  add(leaf, floor);
  const std::vector<std::uint64_t> keys = rasterised(leaf, {});
  for (int y = 0; y < kDisplay.height; ++y) {
    const glm::dvec3 ray = camera_direction(kDisplay, 80.5, y + 0.5);
    const double z = ray.y < 0 ? 0.05 / -ray.y * -ray.z : 1e9;  // along the axis
    if (z > 18.9) {
      if (z > 19.1) { EXPECT_EQ(key_at(keys, 80, y), kNoSplat) << y; }
      continue;
    }
    EXPECT_NEAR(key_disparity(key_at(keys, 80, y)) * z, 1, 1e-4) << y;
  }
}

TEST(NearRaster, OfSurfacesInOnePlaneTheLastDrawnShows) {
  Chunk walls = wall(-1, 1, {230, 200, 90, 255});
  for (std::size_t corner = 0; corner < 4; ++corner) {
    walls.vertices.push_back(walls.vertices[corner]);
    walls.vertices.back().colour = {20, 20, 200, 255};
  }
  walls.indices.insert(walls.indices.end(), {4, 5, 6, 4, 6, 7});
  LeafView leaf = empty_leaf();
  add(leaf, walls);
  const std::uint32_t colour = key_colour(key_at(rasterised(leaf, {}), 60, 60));
  EXPECT_GT(colour >> 16, colour & 255) << "the blue wall was listed after the yellow one";
}

TEST(NearRaster, AlphaMaskCutsHoles) {
  LeafView leaf = empty_leaf();
  Chunk masked = wall(-1, 1, {255, 255, 255, 255});
  masked.is_alpha_masked = true;
  add(leaf, masked, picture(64));
  const std::vector<std::uint64_t> keys = rasterised(leaf, {});
  EXPECT_NE(key_at(keys, 60, 60), kNoSplat);
  EXPECT_EQ(key_at(keys, 100, 60), kNoSplat);
}

TEST(NearRaster, MinifiedTexturesUseTheServersMips) {
  // The finest level is black, every coarser one white: at a footprint of some texels only white may show.
  auto texture = picture(64);
  for (TextureLevel& level : texture->levels) std::fill(level.rgba.begin(), level.rgba.end(), level.width == 64 ? 0 : 255);
  Chunk chunk = wall(-2, 1, {255, 255, 255, 255});
  for (ChunkVertex& v : chunk.vertices) v.uv *= 8.0f;
  LeafView leaf = empty_leaf();
  add(leaf, chunk, texture);
  const std::uint32_t colour = key_colour(key_at(rasterised(leaf, {}), 80, 60));
  EXPECT_NEAR(static_cast<int>(colour & 255), linear_to_srgb(vertex_light({0, 0, 1})), 1);
}

TEST(NearRaster, NothingIsNearerThanItsPlane) {
  LeafView leaf = empty_leaf();
  add(leaf, wall(-0.5f, 1, {255, 255, 255, 255}));
  EXPECT_NE(key_at(rasterised(leaf, {}, kDisplay.height, 0.49), 80, 60), kNoSplat);
  EXPECT_EQ(key_at(rasterised(leaf, {}, kDisplay.height, 0.51), 80, 60), kNoSplat);
}

TEST(NearRaster, WhatIsKnownIsNotPreparedAgain) {
  const LeafView leaf = random_scene(1);
  Pose pose{leaf.leaf_box.center(), {}};
  NearRaster raster;
  const NearStatistics first = raster.begin(leaf, pose, kDisplay, kNearPlane), second = raster.begin(leaf, pose, kDisplay, kNearPlane);
  EXPECT_GT(first.uploaded_bytes, 64u * 64 * 4);
  EXPECT_EQ(second.uploaded_bytes, 0u);
  EXPECT_EQ(first.triangles, second.triangles);
}

}  // namespace
}  // namespace farfield::client
