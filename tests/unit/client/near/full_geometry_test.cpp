// SPDX-License-Identifier: Apache-2.0
#include "client/near/full_geometry.h"

#include <gtest/gtest.h>

#include <vector>

#include "client/gl/framebuffer.h"
#include "client/near/near_renderer.h"

namespace farfield::client {
namespace {

constexpr Display kDisplay{96, 72, 1.0};

/// A bumpy square patch in the chunk's x-z plane, 8×8 quads over 1 m.
Chunk patch(int seed) {
  Chunk chunk;
  for (int z = 0; z <= 8; ++z) {
    for (int x = 0; x <= 8; ++x) {
      const float height = 0.02f * static_cast<float>((x * 7 + z * 5 + seed) % 11);
      chunk.vertices.push_back({{x / 8.0f, height, z / 8.0f},
                                encode_normal(glm::normalize(glm::vec3(0.3f, 1, 0.1f * static_cast<float>(seed % 3)))),
                                {},
                                {static_cast<std::uint8_t>(60 + 30 * (seed % 6)), 120, 200, 255}});
    }
  }
  for (std::uint16_t z = 0; z < 8; ++z) {
    for (std::uint16_t x = 0; x < 8; ++x) {
      const auto a = static_cast<std::uint16_t>(9 * z + x);
      for (const int offset : {0, 1, 10, 0, 10, 9}) chunk.indices.push_back(static_cast<std::uint16_t>(a + offset));
    }
  }
  return chunk;
}

class FullGeometryTest : public testing::Test {
 protected:
  static constexpr int kAcross = 12;
  void SetUp() override {
    auto context = GlContext::create_surfaceless();
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(*context);
    auto renderer = FullGeometryRenderer::create(context_->abilities(), kOrigin, kAcross * kAcross, [](std::size_t i) {
      return FullGeometryChunk{patch(int(i)), place(i), nullptr};
    });
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::move(*renderer);
    auto frame = Framebuffer::create(context_->abilities(), kDisplay.width, kDisplay.height, 1);
    ASSERT_TRUE(frame);
    frame_ = std::move(*frame);
  }
  static glm::dmat4x3 place(std::size_t i) {
    glm::dmat4x3 placement{1};
    placement[3] = kOrigin + glm::dvec3(double(i % kAcross) - 6, -1.5, double(i / kAcross) - 6);
    return placement;
  }
  template <class Draw>
  std::vector<std::uint8_t> image(Draw draw) {
    std::vector<std::uint8_t> colour(4u * kDisplay.width * kDisplay.height);
    frame_.begin();
    draw();
    frame_.read_colour(colour);
    return colour;
  }
  ViewTransform view() const {
    return ViewTransform::of(kDisplay, {kOrigin + glm::dvec3(0.2, 0, 0.3), glm::dquat(glm::dvec3(-0.2, 0.7, 0))}, 0.01);
  }

  static inline const glm::dvec3 kOrigin{3e6, 1e5, -2e6};
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<FullGeometryRenderer> renderer_;
  Framebuffer frame_;
};

TEST_F(FullGeometryTest, CullingChangesNoPixel) {
  FullGeometryStatistics all, culled;
  const auto whole = image([&] { all = renderer_->draw(view(), false); });
  const auto visible = image([&] { culled = renderer_->draw(view(), true); });
  EXPECT_EQ(all.triangles, 128u * kAcross * kAcross);
  EXPECT_LT(culled.triangles, all.triangles / 2);
  EXPECT_GT(culled.triangles, 0u);
  EXPECT_EQ(whole, visible);
  int covered = 0;
  for (std::size_t p = 3; p < whole.size(); p += 4) covered += whole[p] == 255;
  EXPECT_GT(covered, kDisplay.width * kDisplay.height / 4);
}

TEST_F(FullGeometryTest, LooksLikeNearGeometry) {
  LeafView leaf;
  leaf.leaf_box = Box{kOrigin, kOrigin}.grown(4);
  leaf.near_region = leaf.leaf_box.grown(8);
  for (std::size_t i = 0; i < kAcross * kAcross; ++i) {
    auto chunk = std::make_shared<DecodedChunk>();
    chunk->serial = i + 1;
    chunk->chunk = patch(int(i));
    glm::dmat4x3 placement = place(i);
    placement[3] -= kOrigin;
    leaf.chunks.push_back({chunk, nullptr, glm::mat4x3(placement)});
  }
  auto near = NearRenderer::create(context_->abilities());
  ASSERT_TRUE(near) << near.error().message;
  const auto expected = image([&] { (*near)->draw(leaf, view()); });
  const auto actual = image([&] { renderer_->draw(view(), false); });
  EXPECT_EQ(expected, actual);
}

TEST_F(FullGeometryTest, MemoryIsWhatTheHeaderSays) {
  EXPECT_EQ(renderer_->memory_bytes(), kAcross * kAcross * (81u * 28 + 128u * 12));
}

}  // namespace
}  // namespace farfield::client
