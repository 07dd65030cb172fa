// SPDX-License-Identifier: Apache-2.0
#include "client/warp/project_row.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "client/warp/splat_key.h"

namespace farfield::client {
namespace {

TEST(SplatKey, KeepsDisparityColourAndKind) {
  for (const float disparity : {0.0f, 1e-30f, 0.00123f, 0.7f, 3.1e8f}) {
    const auto bits = std::bit_cast<std::uint32_t>(disparity);
    const std::uint64_t key = make_key(key_high(bits, 254), key_low(bits, 0xff123456u));
    EXPECT_EQ(key_disparity(key), disparity);
    EXPECT_EQ(key_colour(key), 0x123456u);
    EXPECT_FALSE(key_is_near(key));
    EXPECT_NE(key, kNoSplat);
    EXPECT_TRUE(key_is_near(near_key(disparity, 0x123456)));
  }
}

TEST(SplatKey, DepthDecidesThenCloseness) {
  const auto key = [](float disparity, std::uint32_t penalty, std::uint32_t colour) {
    const auto bits = std::bit_cast<std::uint32_t>(disparity);
    return make_key(key_high(bits, penalty), key_low(bits, colour));
  };
  EXPECT_GT(key(1.01f, 200, 0), key(1.0f, 0, 0xffffff));        // nearer by 1 %: whatever the closeness
  EXPECT_GT(key(1.0001f, 10, 0), key(1.00015f, 20, 0xffffff));  // one surface: the closer sample
  EXPECT_GT(key(1.0f, 254, 0), kNoSplat);
}

class Rows {
 public:
  explicit Rows(unsigned seed) : random_(seed) {}
  float uniform(float a, float b) { return std::uniform_real_distribution<float>(a, b)(random_); }
  RowProjection next() {
    RowProjection row;
    // From well behind the eye to well in front, across the window and beyond it.
    row.start[2] = uniform(-1, 2), row.step[2] = uniform(-0.01f, 0.01f), row.per_disparity[2] = uniform(-1, 1);
    for (int k = 0; k < 2; ++k) {
      row.start[k] = uniform(-200, 400), row.step[k] = uniform(-2, 2), row.per_disparity[k] = uniform(-100, 100);
    }
    row.first = static_cast<int>(random_() % 100);
    row.disparity_scale = uniform(0.01f, 10);
    row.reach_x = uniform(0.2f, 5), row.reach_y = uniform(0.2f, 5);
    disparity.resize(kRowPiece), colour.resize(kRowPiece);
    for (float& d : disparity) d = random_() % 8 == 0 ? 0.0f : uniform(0, 0.6f);
    for (auto& c : colour) c = static_cast<std::uint32_t>(random_()) & 0xffffff;
    count = 1 + static_cast<int>(random_() % kRowPiece);
    return row;
  }
  std::vector<float> disparity;
  std::vector<std::uint32_t> colour;
  int count = 0;

 private:
  std::mt19937 random_;
};

TEST(ProjectRow, VectorAndScalarPointsAreBitIdentical) {
  Rows rows(1);
  const PixelWindow window{200, 40, 120};
  ProjectedPoints vector{}, scalar{};
  int landed = 0, missed = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const RowProjection row = rows.next();
    project_points(row, window, rows.disparity.data(), rows.colour.data(), rows.count, vector);
    project_points_scalar(row, window, rows.disparity.data(), rows.colour.data(), rows.count, scalar);
    for (int i = 0; i < rows.count; ++i) {
      ASSERT_EQ(vector.offset[i], scalar.offset[i]) << trial << " " << i;
      ASSERT_TRUE(vector.offset[i] == -1 || (vector.offset[i] >= 200 * 40 && vector.offset[i] < 200 * 120));
      if (vector.offset[i] < 0) {
        ++missed;
        continue;
      }
      ++landed;
      ASSERT_EQ(vector.high[i], scalar.high[i]);
      ASSERT_EQ(vector.low[i], scalar.low[i]);
    }
  }
  EXPECT_GT(landed, 1000);
  EXPECT_GT(missed, 1000);
}

TEST(ProjectRow, VectorAndScalarBoxesAreBitIdenticalAndClipped) {
  Rows rows(2);
  const PixelWindow window{200, 40, 120};
  const auto vector = std::make_unique<ProjectedBoxes>(), scalar = std::make_unique<ProjectedBoxes>();
  int landed = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const RowProjection row = rows.next();
    project_boxes(row, window, rows.disparity.data(), rows.colour.data(), rows.count, *vector);
    project_boxes_scalar(row, window, rows.disparity.data(), rows.colour.data(), rows.count, *scalar);
    for (int i = 0; i < rows.count; ++i) {
      const bool lands = vector->bottom[i] >= vector->top[i];
      ASSERT_EQ(lands, scalar->bottom[i] >= scalar->top[i]) << trial << " " << i;
      if (!lands) continue;
      ++landed;
      ASSERT_EQ(vector->left[i], scalar->left[i]);
      ASSERT_EQ(vector->right[i], scalar->right[i]);
      ASSERT_EQ(vector->top[i], scalar->top[i]);
      ASSERT_EQ(vector->bottom[i], scalar->bottom[i]);
      ASSERT_EQ(vector->high[i], scalar->high[i]);
      ASSERT_EQ(vector->low[i], scalar->low[i]);
      ASSERT_EQ(vector->left_penalty[i], scalar->left_penalty[i]);
      ASSERT_EQ(vector->bottom_penalty[i], scalar->bottom_penalty[i]);
      ASSERT_TRUE(vector->left[i] >= 0 && vector->right[i] < 200 && vector->top[i] >= 40 && vector->bottom[i] < 120);
      ASSERT_LE(vector->right[i] - vector->left[i], 3);
    }
  }
  EXPECT_GT(landed, 1000);
}

}  // namespace
}  // namespace farfield::client
