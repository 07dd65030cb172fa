// SPDX-License-Identifier: Apache-2.0
#include "client/frame/resolve_gl_frame.h"

#include <gtest/gtest.h>

#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr int kWidth = 24, kHeight = 16;

/// What OpenGL drew: left of column 12 a white board at 2 m, the rest nothing.
struct Drawn {
  std::vector<std::uint8_t> rgba = std::vector<std::uint8_t>(4 * kWidth * kHeight, 0);
  std::vector<float> depth = std::vector<float>(kWidth * kHeight, 0.0f);

  explicit Drawn(std::uint8_t alpha) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < 12; ++x) set(x, y, 255, alpha, 0.01f / 2);
    }
  }
  void set(int x, int y, std::uint8_t value, std::uint8_t alpha, float d) {
    const auto at = static_cast<std::size_t>(y * kWidth + x);
    for (std::size_t c = 0; c < 3; ++c) rgba[4 * at + c] = value;
    rgba[4 * at + 3] = alpha;
    depth[at] = d;
  }
  Frame resolve(bool sky) const {
    Frame frame;
    GlResolveOptions options;
    options.background = {0, 0, 200};
    options.sky = SkyTest(sky ? DirectionMask::all() : DirectionMask(), glm::dmat3(1), {kWidth, kHeight, 1.0});
    resolve_gl_frame({kWidth, kHeight, rgba, depth, 0.01}, options, frame);
    return frame;
  }
};

TEST(ResolveGlFrame, AlphaTellsNearFromImpostor) {
  EXPECT_EQ(Drawn(255).resolve(true).coverage[5], Coverage::kNear);
  EXPECT_EQ(Drawn(254).resolve(true).coverage[5], Coverage::kImpostor);
  EXPECT_EQ(Drawn(254).resolve(true).coverage[20], Coverage::kBackground);
  EXPECT_FLOAT_EQ(Drawn(254).resolve(true).disparity[5], 0.5f);
}

TEST(ResolveGlFrame, SilhouettesMixWithTheSkyInLinearLight) {
  for (const std::uint8_t alpha : {std::uint8_t{255}, std::uint8_t{254}}) {
    Drawn drawn(alpha);
    // Three of four samples of column 12 are white; depth came from the fourth.
    drawn.set(12, 8, linear_to_srgb(0.75f), 191, 0);
    const Frame frame = drawn.resolve(true);
    const std::size_t at = 8 * kWidth + 12;
    EXPECT_NEAR(frame.rgba[4 * at], linear_to_srgb(0.75f), 1);
    EXPECT_NEAR(frame.rgba[4 * at + 2], linear_to_srgb(0.75f + 0.25f * srgb_to_linear(200)), 1);
    EXPECT_EQ(frame.coverage[at], alpha == 255 ? Coverage::kNear : Coverage::kImpostor);
    EXPECT_FLOAT_EQ(frame.disparity[at], 0.5f);
  }
}

TEST(ResolveGlFrame, SilhouettesWhereNoSkyCanBeMixWithSurface) {
  Drawn drawn(254);
  drawn.set(12, 8, linear_to_srgb(0.25f), 64, 0);
  const Frame frame = drawn.resolve(false);
  const std::size_t at = 8 * kWidth + 12;
  EXPECT_NEAR(frame.rgba[4 * at + 2], 255, 1);
  EXPECT_EQ(frame.coverage[at], Coverage::kImpostor);  // one sample of four is: no void
  EXPECT_EQ(frame.coverage[at + 1], Coverage::kVoidFilled);
  EXPECT_EQ(frame.statistics.background_pixels, 0u);
  EXPECT_GT(frame.statistics.void_pixels, 0u);
}

}  // namespace
}  // namespace farfield::client
