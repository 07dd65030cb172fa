// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/measure_frames.h"

#include <gtest/gtest.h>

#include "tests/bench/baselines/geometry.h"
#include "tests/unit/server/scene/scene_models.h"

namespace farfield::bench {
namespace {

// Three looks at a sphere.
World world() {
  World world;
  world.options.display = {.width = 48, .height = 32};
  world.scene = test::build(test::model_of(test::sphere(12)));
  for (const double x : {-0.2, 0.0, 0.3}) {
    world.poses.push_back({glm::dvec3(x, 0, 3) - world.scene->origin(), {1, 0, 0, 0}});
    world.truth.push_back(render_reference(*world.scene, world.poses.back(), world.options.display, 16));
  }
  return world;
}

TEST(MeasureFrames, TruthIsWithoutErrorAndTheFirstDrawingDoesNotCount) {
  World w = world();
  w.is_far.assign(3, std::vector<std::uint8_t>(48 * 32, 1));
  int drawn = 0;
  MethodResult result;
  const Status status = measure_frames(
      w,
      [&](const Pose& eye) -> Result<DrawnFrame> {
        DrawnFrame frame;
        frame.seen.rgb = render_reference(*w.scene, eye, w.options.display, 16).rgb;
        frame.ms = drawn == 0 ? 1000 : drawn, frame.triangles = 10 * drawn;
        ++drawn;
        return frame;
      },
      result);
  ASSERT_TRUE(status);
  EXPECT_EQ(drawn, 4);
  EXPECT_DOUBLE_EQ(result.frame_p50, 2);
  EXPECT_DOUBLE_EQ(result.frame_p99, 3);
  EXPECT_DOUBLE_EQ(result.triangles, 20);
  EXPECT_TRUE(std::isnan(result.samples));
  EXPECT_DOUBLE_EQ(result.error.psnr_min, 100);
  EXPECT_DOUBLE_EQ(result.error.impostor_psnr_min, 100);
  EXPECT_DOUBLE_EQ(result.error.flip_max, 0);
  EXPECT_TRUE(std::isnan(result.error.void_mean));
  EXPECT_EQ(result.pictures.size(), 3u);
}

TEST(MeasureFrames, AFailedFrameIsTheMethodsFailure) {
  MethodResult result;
  const Status status = measure_frames(
      world(), [](const Pose&) -> Result<DrawnFrame> { return fail(ErrorCode::kUnavailable, "no picture"); }, result);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message, "no picture");
}

// A method without its own pixels' mask is judged over the same far pixels as all others.
TEST(MeasureFrames, FarPixelsAreJudgedAlone) {
  World w = world();
  std::vector<std::uint8_t> left(48 * 32);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i % 48 < 24;
  w.is_far.assign(3, left);
  MethodResult result;
  ASSERT_TRUE(measure_frames(
      w,
      [&](const Pose& eye) -> Result<DrawnFrame> {
        DrawnFrame frame;
        frame.seen.rgb = render_reference(*w.scene, eye, w.options.display, 16).rgb;
        for (std::size_t i = 0; i < left.size(); ++i)
          if (!left[i]) frame.seen.rgb[3 * i] ^= 0x80;
        return frame;
      },
      result));
  EXPECT_DOUBLE_EQ(result.error.impostor_psnr_mean, 100);
  EXPECT_LT(result.error.psnr_mean, 20);
}

TEST(OverBackground, MixesPartlyCoveredPixelsInLinearLight) {
  const auto scene = test::build(test::model_of(test::sphere(4)));
  const glm::u8vec3 sky = scene->background();
  // Nothing, a whole pixel, and half a pixel of black.
  const std::vector<std::uint8_t> rgb = over_background(*scene, {0, 0, 0, 0, 10, 20, 30, 255, 0, 0, 0, 128});
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(rgb[c], sky[c]);
    EXPECT_EQ(rgb[3 + c], 10 * (c + 1));
    EXPECT_GT(rgb[6 + c], sky[c] / 2 + 20);  // half the light is more than half the code
    EXPECT_LT(rgb[6 + c], sky[c]);
  }
}

}  // namespace
}  // namespace farfield::bench
