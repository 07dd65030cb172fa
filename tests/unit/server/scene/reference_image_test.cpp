// SPDX-License-Identifier: Apache-2.0
#include "server/scene/reference_image.h"

#include <gtest/gtest.h>

#include "common/shading/shading.h"
#include "tests/unit/server/scene/scene_models.h"

namespace farfield {
namespace {

using namespace test;

// Looking at a sphere from 3 m away: outlines, so that many pixels are covered in part.
const Pose kEye{{0.1, 0.2, 3}, {1, 0, 0, 0}};

class SamplesPerPixel : public testing::TestWithParam<int> {};

TEST_P(SamplesPerPixel, AreTheSamplesOfALargerImageAveraged) {
  const auto scene = build(model_of(sphere(12)));
  const int per_axis = GetParam();
  Display display{.width = 37, .height = 25};  // no multiple of a packet's edge
  const ReferenceImage image = render_reference(*scene, kEye, display, per_axis * per_axis);
  display.width *= per_axis, display.height *= per_axis;
  const ReferenceImage large = render_reference(*scene, kEye, display, 1);
  int partly_covered = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      glm::vec3 sum(0);
      int surfaces = 0;
      for (int k = 0; k < per_axis * per_axis; ++k) {
        const std::size_t at = static_cast<std::size_t>(per_axis * y + k / per_axis) * large.width + per_axis * x + k % per_axis;
        for (int c = 0; c < 3; ++c) sum[c] += srgb_to_linear(large.rgb[3 * at + c]);
        surfaces += large.has_surface[at];
      }
      const std::size_t at = static_cast<std::size_t>(y) * image.width + x;
      const int samples = per_axis * per_axis;
      // Eight-bit codes were averaged instead of light: half a code each, and half for the result.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.rgb[3 * at + c], linear_to_srgb(sum[c] / static_cast<float>(samples)), 1);
      EXPECT_EQ(image.has_surface[at], 2 * surfaces > samples);
      partly_covered += surfaces > 0 && surfaces < samples;
    }
  EXPECT_GT(partly_covered, per_axis > 1 ? 10 : -1);
}

INSTANTIATE_TEST_SUITE_P(ReferenceImage, SamplesPerPixel, testing::Values(1, 2, 4));

}  // namespace
}  // namespace farfield
