// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/layered_image.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/bench/baselines/layer_painter.h"
#include "tests/unit/bench/baselines/far_scenes.h"

namespace farfield::bench {
namespace {

TEST(LayeredImage, ConstructionViewsStandAroundTheCentreAsInTheFigure) {
  const Box cell{{0, 0, 0}, {4, 4, 4}};
  const auto positions = construction_positions(cell, CubeFace::of(5));  // looks along -Z
  EXPECT_EQ(positions[0], glm::dvec3(2, 2, 2));
  std::set<std::array<double, 3>> distinct;
  for (std::size_t k = 1; k < 9; ++k) {
    EXPECT_DOUBLE_EQ(positions[k].z, k <= 4 ? 1 : 3);  // towards the image first, then behind
    EXPECT_NEAR(glm::distance(positions[k], positions[0]), std::sqrt(2.0), 1e-12);
    distinct.insert({positions[k].x, positions[k].y, positions[k].z});
  }
  EXPECT_EQ(distinct.size(), 8u);
}

class LayeredCellTest : public testing::Test {
 protected:
  test::PillarRoom room;
  LayeredCell cell = make_layered_cell(room.scene(), room.space, 130).cell;
};

TEST_F(LayeredCellTest, PixelsHoldFallingDisparitiesFartherApartThanTheTolerance) {
  std::size_t deeper = 0;
  for (const LayeredFace& face : cell) {
    const double tolerance = face.frame.pitch / 0.99;  // warp_gain() of a central view is 0.98
    for (std::size_t k = 0; k < face.pixels(); ++k)
      for (std::uint32_t s = face.first[k] + 1; s < face.first[k + 1]; ++s, ++deeper)
        ASSERT_GT(face.samples[s - 1].disparity - face.samples[s].disparity, tolerance);
  }
  EXPECT_GT(deeper, 100u) << "the wall behind the pillar is there";
  const LayeredFace& face = cell[0];
  const std::size_t middle = 65 * 130 + 65 - 8;
  EXPECT_EQ(face.first[middle + 1] - face.first[middle], 1u) << "the pillar's middle hides what no view sees";
}

TEST_F(LayeredCellTest, ComesBackFromItsBytesWithinTheStep) {
  const LayeredEncoding encoding{90, 4e-4};
  const EncodedLayers bytes = encode_layers(cell[0], encoding).value();
  const LayeredFace back = decode_layers(cell[0].frame, bytes, encoding).value();
  ASSERT_EQ(back.first, cell[0].first);
  double off = 0;
  for (std::size_t s = 0; s < back.samples.size(); ++s) {
    EXPECT_NEAR(back.samples[s].disparity, cell[0].samples[s].disparity, 2.1e-4);
    off += std::abs(int{back.samples[s].r} - int{cell[0].samples[s].r});
  }
  EXPECT_LT(off / static_cast<double>(back.samples.size()), 3);
  EncodedLayers bad = bytes;
  bad.depth.resize(bad.depth.size() / 2);
  EXPECT_FALSE(decode_layers(cell[0].frame, bad, encoding));
}

client::Frame painted(const LayeredCell& cell, const Pose& eye, const PaintOptions& options) {
  LayerPainter painter(options);
  painter.set_cell(cell);
  client::Frame frame;
  frame.width = test::kFarDisplay.width, frame.height = test::kFarDisplay.height;
  frame.rgba.assign(4 * frame.pixels(), 0), frame.disparity.assign(frame.pixels(), 0);
  frame.coverage.assign(frame.pixels(), client::Coverage::kBackground);
  painter.paint(eye, test::kFarDisplay, frame);
  return frame;
}

// The order alone decides what is seen where surfaces lie behind one another. Splats of one surface beside each other may
// still change places, and a splat one pixel wide has no rim that could cover another surface's pixel.
TEST_F(LayeredCellTest, TheOccludedComesFirstFromWhereverItIsSeen) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> turn(-3.1, 3.1);
  for (int k = 0; k < 24; ++k) {
    Pose eye{room.random_eye(random), glm::angleAxis(turn(random), glm::dvec3(0, 1, 0)) * glm::angleAxis(0.4 * turn(random), glm::dvec3(1, 0, 0))};
    if (k == 0) eye = test::towards_pillar(room.centre());  // no order at all there
    const client::Frame ordered = painted(cell, eye, {0, false}), nearest = painted(cell, eye, {0, true});
    std::size_t wrong = 0;
    for (std::size_t p = 0; p < ordered.pixels(); ++p) {
      ASSERT_EQ(ordered.coverage[p], nearest.coverage[p]);
      wrong += nearest.disparity[p] - ordered.disparity[p] > 0.03f;  // pillar 0.36 against wall 0.25, at most 0.02 within a pixel
    }
    EXPECT_LT(static_cast<double>(wrong), 2e-3 * static_cast<double>(ordered.pixels())) << "view " << k;
  }
}

TEST_F(LayeredCellTest, FramesLookLikeTheScene) {
  test::FarComparison comparison(room);
  const LayeredCell fine = make_layered_cell(room.scene(), room.space, 258).cell;
  comparison.show(fine);
  std::mt19937 random(2);
  for (int k = 0; k < 4; ++k) {
    const test::Difference d = comparison.at(room.random_eye(random));
    EXPECT_LT(d.mean, 4);
    EXPECT_LT(comparison.uncovered_share(), 0.002);
    EXPECT_GT(comparison.drawn.samples, 0u);
  }
}

}  // namespace
}  // namespace farfield::bench
