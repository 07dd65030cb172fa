// SPDX-License-Identifier: Apache-2.0
#include "client/frame/close_mesh_cracks.h"

#include <gtest/gtest.h>

namespace farfield::client {
namespace {

/// A grey surface at disparity 0.1 whose red grows by 10 per column.
Frame surface(int width, int height) {
  Frame frame;
  frame.width = width, frame.height = height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int c : {100 + 10 * x, 100, 100, 255}) frame.rgba.push_back(static_cast<std::uint8_t>(c));
      frame.disparity.push_back(0.1f);
      frame.coverage.push_back(Coverage::kImpostor);
    }
  }
  return frame;
}
void open_pixel(Frame& frame, int x, int y) {
  const auto at = static_cast<std::size_t>(y * frame.width + x);
  frame.coverage[at] = Coverage::kBackground;
  frame.disparity[at] = 0;
  frame.rgba[4 * at] = 0;
}

TEST(CloseMeshCracks, ALineOnePixelWideIsClosedFromBothSides) {
  Frame frame = surface(9, 7);
  for (int y = 0; y < 7; ++y) open_pixel(frame, 4, y);
  EXPECT_EQ(close_mesh_cracks(frame), 5u);  // the frame's own border has no neighbours on one side
  const std::size_t at = 3 * 9 + 4;
  EXPECT_EQ(frame.coverage[at], Coverage::kCrackClosed);
  EXPECT_NEAR(frame.rgba[4 * at], 140, 1);
  EXPECT_FLOAT_EQ(frame.disparity[at], 0.1f);
}

TEST(CloseMeshCracks, WiderGapsStayOpen) {
  Frame frame = surface(9, 7);
  for (int y = 0; y < 7; ++y) open_pixel(frame, 4, y), open_pixel(frame, 5, y);
  EXPECT_EQ(close_mesh_cracks(frame), 0u);
}

TEST(CloseMeshCracks, SurfacesAtDifferentDepthsDoNotCloseAGap) {
  Frame frame = surface(9, 7);
  for (int y = 0; y < 7; ++y) {
    open_pixel(frame, 4, y);
    for (int x = 5; x < 9; ++x) frame.disparity[static_cast<std::size_t>(y * 9 + x)] = 0.2f;
  }
  // Up and down the line nothing is covered either; diagonals cross from one surface to the other.
  EXPECT_EQ(close_mesh_cracks(frame), 0u);
}

TEST(CloseMeshCracks, NearGeometryClosesNothing) {
  Frame frame = surface(9, 7);
  for (Coverage& c : frame.coverage) c = Coverage::kNear;
  open_pixel(frame, 4, 3);
  EXPECT_EQ(close_mesh_cracks(frame), 0u);
}

TEST(CloseMeshCracks, TinyFramesHaveNoCracks) {
  Frame frame = surface(1, 1);
  open_pixel(frame, 0, 0);
  EXPECT_EQ(close_mesh_cracks(frame), 0u);
}

}  // namespace
}  // namespace farfield::client
