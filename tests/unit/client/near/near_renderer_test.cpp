// SPDX-License-Identifier: Apache-2.0
// The near renderer against rays traced on the CPU through the same plane with the same shading function.
#include "client/near/near_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "client/gl/framebuffer.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr Display kDisplay{160, 120, 1.0471975511965976};
constexpr double kNearPlane = 0.001;

/// A wall in the plane z = 0 of the chunk, |x|, |y| <= half, uv from 0 to 1 with v downwards.
Chunk wall(float half, bool is_masked = false) {
  Chunk chunk;
  chunk.is_alpha_masked = is_masked;
  const glm::i16vec2 normal = encode_normal({0, 0, 1});
  for (const glm::vec2& corner : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
    chunk.vertices.push_back({{half * corner.x, half * corner.y, 0},
                              normal,
                              {0.5f + 0.5f * corner.x, 0.5f - 0.5f * corner.y},
                              {230, 200, 90, 255}});
  }
  chunk.indices = {0, 1, 2, 0, 2, 3};
  return chunk;
}

/// A smooth picture and its box-filtered mips; alpha is 255 on the left half only.
std::shared_ptr<DecodedTexture> picture(int size, std::uint64_t serial) {
  auto texture = std::make_shared<DecodedTexture>();
  texture->hash = serial, texture->serial = serial;
  for (int width = 1; width <= size; width *= 2) {
    TextureLevel level;
    level.width = level.height = width;
    for (int y = 0; y < width; ++y) {
      for (int x = 0; x < width; ++x) {
        const double s = (x + 0.5) / width, t = (y + 0.5) / width;
        level.rgba.push_back(static_cast<std::uint8_t>(40 + 200 * s));
        level.rgba.push_back(static_cast<std::uint8_t>(250 - 200 * t));
        level.rgba.push_back(static_cast<std::uint8_t>(128 + 100 * std::sin(6.283 * s)));
        level.rgba.push_back(s < 0.5 ? 255 : 0);
      }
    }
    texture->levels.push_back(std::move(level));
  }
  return texture;
}

class NearRendererTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = GlContext::create_surfaceless();
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(*context);
    auto renderer = NearRenderer::create(context_->abilities());
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::move(*renderer);
    auto frame = Framebuffer::create(context_->abilities(), kDisplay.width, kDisplay.height, 1);
    ASSERT_TRUE(frame) << frame.error().message;
    frame_ = std::move(*frame);
    // A cell far from the scene's zero: nothing may depend on large floats.
    leaf_.leaf_box = {glm::dvec3(1e6, 2e6, -3e6), glm::dvec3(1e6 + 1, 2e6 + 1, -3e6 + 1)};
    leaf_.near_region = leaf_.leaf_box.grown(2);
  }
  void add(Chunk chunk, const glm::mat4x3& placement, std::shared_ptr<const DecodedTexture> texture = nullptr) {
    auto decoded = std::make_shared<DecodedChunk>();
    decoded->serial = ++serial_;
    chunk.texture = texture ? texture->hash : 0;
    decoded->chunk = std::move(chunk);
    leaf_.chunks.push_back({decoded, texture, placement});
  }
  NearStatistics draw(const Pose& offset_from_centre) {
    Pose pose = offset_from_centre;
    pose.position += leaf_.leaf_box.center();
    frame_.begin();
    const NearStatistics statistics = renderer_->draw(leaf_, ViewTransform::of(kDisplay, pose, kNearPlane));
    colour_.resize(4u * kDisplay.width * kDisplay.height);
    depth_.resize(1u * kDisplay.width * kDisplay.height);
    frame_.read_colour(colour_);
    frame_.read_depth(depth_);
    return statistics;
  }
  static std::size_t pixel(int x, int y) { return static_cast<std::size_t>(y * kDisplay.width + x); }

  /// Calls check(pixel, x and y on the wall z = wall_z, distance along the axis) for every pixel's ray.
  static void for_each_hit(const Pose& pose, double wall_z,
                           const std::function<void(std::size_t, double, double, double)>& check) {
    for (int y = 0; y < kDisplay.height; ++y) {
      for (int x = 0; x < kDisplay.width; ++x) {
        const glm::dvec3 ray = pose.world_from_camera * camera_direction(kDisplay, x + 0.5, y + 0.5);
        const double t = (wall_z - pose.position.z) / ray.z;
        if (t > 0) check(pixel(x, y), pose.position.x + t * ray.x, pose.position.y + t * ray.y, t);
      }
    }
  }

  std::unique_ptr<GlContext> context_;
  std::unique_ptr<NearRenderer> renderer_;
  Framebuffer frame_;
  LeafView leaf_;
  std::uint64_t serial_ = 0;
  std::vector<std::uint8_t> colour_;
  std::vector<float> depth_;
};

Pose tilted() {
  return {{0.2, -0.1, 0.4}, glm::dquat(glm::dvec3(0.2, 0.3, 0.1))};
}

TEST_F(NearRendererTest, TexturedWallMatchesRays) {
  const auto texture = picture(64, 1);
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -1.5f};
  add(wall(1.0f), placement, texture);
  const NearStatistics statistics = draw(tilted());
  EXPECT_EQ(statistics.triangles, 2u);
  EXPECT_EQ(statistics.draw_calls, 1u);

  const glm::vec3 light = vertex_radiance({0, 0, 1}, {230, 200, 90, 255});
  double squares = 0;
  int count = 0;
  for_each_hit(tilted(), -1.5, [&](std::size_t p, double x, double y, double z) {
    if (std::max(std::abs(x), std::abs(y)) > 1.02) {
      EXPECT_EQ(colour_[4 * p + 3], 0);
      return;
    }
    if (std::max(std::abs(x), std::abs(y)) > 0.96) return;  // edges and the wrap-around of the texture
    ASSERT_EQ(colour_[4 * p + 3], 255);
    EXPECT_NEAR(kNearPlane / depth_[p], z, 1e-5 * z);
    const double s = 0.5 + 0.5 * x, t = 0.5 - 0.5 * y;
    const double coded[3] = {40 + 200 * s, 250 - 200 * t, 128 + 100 * std::sin(6.283 * s)};
    for (int c = 0; c < 3; ++c) {
      const float expected = light[c] * srgb_to_linear(static_cast<std::uint8_t>(coded[c]));
      const double difference = double(linear_to_srgb(expected)) - colour_[4 * p + static_cast<std::size_t>(c)];
      squares += difference * difference, ++count;
    }
  });
  ASSERT_GT(count, 3000);
  EXPECT_GT(10 * std::log10(255.0 * 255 * count / squares), 46.0);
}

TEST_F(NearRendererTest, NormalsTurnWithThePlacement) {
  // Turned about y and stretched along x: the normal follows the inverse transpose, not the placement.
  glm::mat4x3 placement(glm::vec3(2, 0, 1), glm::vec3(0, 1, 0), glm::vec3(-1, 0, 1), glm::vec3(0, 0, -1.2f));
  add(wall(1.0f), placement);
  draw({});
  const glm::vec3 normal = glm::normalize(glm::cross(placement[0], placement[1]));
  const glm::vec3 expected = vertex_radiance(normal, {230, 200, 90, 255});
  const std::size_t p = pixel(kDisplay.width / 2, kDisplay.height / 2);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(colour_[4 * p + static_cast<std::size_t>(c)], linear_to_srgb(expected[c]), 1);
  }
}

TEST_F(NearRendererTest, CutExactlyAtTheBorderOfTheNearRegion) {
  // A wall along the region's floor of view: it reaches beyond x = ±2.5, where the region ends.
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -2.0f};
  add(wall(6.0f), placement);
  const Pose pose{{0.3, 0.1, 0.2}, glm::dquat(glm::dvec3(0, 0.5, 0))};
  draw(pose);
  int inside = 0, outside = 0;
  for_each_hit(pose, -2.0, [&](std::size_t p, double x, double y, double) {
    if (std::max(std::abs(x), std::abs(y)) > 5.9) return;
    // Floats place the fragment to about 1e-6 m.
    if (std::abs(std::abs(x) - 2.5) < 1e-5 || std::abs(std::abs(y) - 2.5) < 1e-5) return;
    const bool is_inside = leaf_.near_region.contains(leaf_.leaf_box.center() + glm::dvec3(x, y, -2.0));
    EXPECT_EQ(colour_[4 * p + 3], is_inside ? 255 : 0) << x << ' ' << y;
    ++(is_inside ? inside : outside);
  });
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 500);
}

TEST_F(NearRendererTest, BorderIsHalfOpen) {
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -2.5f};  // in the lower face: inside
  add(wall(1.0f), placement);
  draw({});
  EXPECT_EQ(colour_[4 * pixel(80, 60) + 3], 255);
  leaf_.chunks.clear();
  placement[3] = {0, 0, 2.5f};  // in the upper face: outside
  add(wall(1.0f), placement);
  draw({glm::dvec3(0), glm::dquat(glm::dvec3(0, 3.14159265358979, 0))});
  EXPECT_EQ(colour_[4 * pixel(80, 60) + 3], 0);
}

TEST_F(NearRendererTest, OfSurfacesInOnePlaneTheLastDrawnShows) {
  Chunk walls = wall(1.0f);
  for (std::size_t corner = 0; corner < 4; ++corner) {
    walls.vertices.push_back(walls.vertices[corner]);
    walls.vertices.back().colour = {20, 20, 200, 255};
  }
  walls.indices.insert(walls.indices.end(), {4, 5, 6, 4, 6, 7});
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -1.0f};
  add(std::move(walls), placement);
  draw({});
  const std::uint8_t* seen = &colour_[4 * pixel(60, 60)];
  EXPECT_GT(seen[2], seen[0]) << "the blue wall was listed after the yellow one";
}

TEST_F(NearRendererTest, AlphaMaskCutsHoles) {
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -1.0f};
  add(wall(1.0f, true), placement, picture(64, 1));
  draw({});
  EXPECT_EQ(colour_[4 * pixel(60, 60) + 3], 255);
  EXPECT_EQ(colour_[4 * pixel(100, 60) + 3], 0);
}

TEST_F(NearRendererTest, MinifiedTexturesUseTheServersMips) {
  // Level 0 is black, every coarser level white: at a footprint of four texels only white may show.
  auto texture = picture(64, 1);
  for (TextureLevel& level : texture->levels) {
    std::fill(level.rgba.begin(), level.rgba.end(), level.width == 64 ? 0 : 255);
  }
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -2.0f};
  Chunk chunk = wall(1.0f);
  for (ChunkVertex& v : chunk.vertices) v.uv *= 8.0f, v.colour = {255, 255, 255, 255};
  add(std::move(chunk), placement, texture);
  draw({});
  // 120 rows over 2·tan(30°)·2 m = 2.31 m and 8·64 texels over 2 m: 4.9 texels per pixel, level 2.3.
  const std::uint8_t white = linear_to_srgb(vertex_light({0, 0, 1}));
  EXPECT_NEAR(colour_[4 * pixel(80, 60)], white, 1);
}

TEST_F(NearRendererTest, LargeTexturesArriveOverFramesCoarseFirst) {
  NearOptions options;
  options.frame_upload_bytes = 1 << 20;
  auto renderer = NearRenderer::create(context_->abilities(), options);
  ASSERT_TRUE(renderer);
  renderer_ = std::move(*renderer);
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -1.0f};
  add(wall(1.0f), placement, picture(1024, 1));
  std::uint64_t uploaded = draw({}).uploaded_bytes;
  EXPECT_LT(uploaded, 3u << 20);
  EXPECT_EQ(colour_[4 * pixel(80, 60) + 3], 255);
  uploaded += draw({}).uploaded_bytes;
  uploaded += draw({}).uploaded_bytes;
  EXPECT_GT(uploaded, 5u << 20);  // 1024² texels and their mips
  EXPECT_EQ(draw({}).uploaded_bytes, 0u);
}

TEST_F(NearRendererTest, NothingOutsideTheViewIsDrawn) {
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -1.0f};
  add(wall(0.2f), placement);
  placement[3] = {0, 0, 1.0f};
  add(wall(0.2f), placement);
  const NearStatistics statistics = draw({});
  EXPECT_EQ(statistics.triangles_held, 4u);
  EXPECT_EQ(statistics.triangles, 2u);
}

TEST_F(NearRendererTest, TrianglesWithMissingVerticesAreLeftOut) {
  Chunk chunk = wall(1.0f);
  chunk.indices = {0, 1, 2, 0, 2, 900, 7};
  glm::mat4x3 placement{1};
  placement[3] = {0, 0, -1.0f};
  add(std::move(chunk), placement);
  EXPECT_EQ(draw({}).triangles, 1u);
}

}  // namespace
}  // namespace farfield::client
