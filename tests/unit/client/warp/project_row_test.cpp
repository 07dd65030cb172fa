// SPDX-License-Identifier: Apache-2.0
#include "client/warp/project_row.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "client/warp/splat_key.h"
#include "client/warp/write_pixels.h"

namespace farfield::client {
namespace {

TEST(SplatKey, KeepsDisparityColourAndKind) {
  for (const float disparity : {0.0f, 1e-30f, 0.00123f, 0.7f, 3.1e8f}) {
    const std::uint64_t key = make_key(key_high(disparity), 0x123456u);
    EXPECT_EQ(key_disparity(key), disparity);
    EXPECT_EQ(key_colour(key), 0x123456u);
    EXPECT_FALSE(key_is_near(key));
    EXPECT_NE(key, kNoSplat);
    EXPECT_TRUE(key_is_near(near_key(disparity, 0x123456)));
  }
}

TEST(SplatKey, DisparityDecidesToItsLastBit) {
  const float farther = 0.25f, nearer = std::nextafter(farther, 1.0f);
  EXPECT_GT(make_key(key_high(nearer), 0), make_key(key_high(farther), 0xffffff));
  EXPECT_GT(near_key(farther, 0), make_key(key_high(farther), 0xffffff));
  EXPECT_GT(make_key(key_high(0.0f), 0), kNoSplat);
}

class Rows {
 public:
  explicit Rows(unsigned seed) : random_(seed) {}
  float uniform(float a, float b) { return std::uniform_real_distribution<float>(a, b)(random_); }
  /// Positions from well behind the eye to well in front, across the window and beyond it; cells of 0 to 5 pixels.
  RowProjection next() {
    RowProjection row;
    row.disparity_scale = uniform(0.01f, 10);
    row.per_disparity[2] = uniform(-1, 1);
    row.step_u[2] = uniform(-0.01f, 0.01f), row.step_v[2] = uniform(-0.01f, 0.01f);
    for (int k = 0; k < 2; ++k) {
      row.per_disparity[k] = uniform(-100, 100);
      row.step_u[k] = uniform(-3, 3), row.step_v[k] = uniform(-3, 3);
    }
    samples.count = 1 + static_cast<int>(random_() % kRowPiece);
    for (int i = 0; i < kRowPiece; ++i) {
      samples.infinity_x[i] = uniform(-200, 400), samples.infinity_y[i] = uniform(-200, 400);
      samples.infinity_w[i] = uniform(-1, 2);
      disparity_[i] = random_() % 8 == 0 ? 0.0f : uniform(0, 0.6f);
      const bool is_flat = random_() % 4 == 0;
      slope_u_[i] = is_flat ? 0 : uniform(-0.01f, 0.01f), slope_v_[i] = is_flat ? 0 : uniform(-0.01f, 0.01f);
      reach_[i] = pack_reach(1 + random_() % 15, 1 + random_() % 15, 1 + random_() % 15, 1 + random_() % 15);
      for (auto& colours : colours_) colours[i] = static_cast<std::uint32_t>(random_()) & 0xffffff;
    }
    samples.disparity = disparity_.data();
    samples.slope_u = slope_u_.data(), samples.slope_v = slope_v_.data();
    samples.reach = reach_.data();
    samples.colour = colours_[0].data();
    samples.colour_left = colours_[1].data(), samples.colour_right = colours_[2].data();
    samples.colour_up = colours_[3].data(), samples.colour_down = colours_[4].data();
    return row;
  }
  RowSamples samples;

 private:
  std::mt19937 random_;
  std::array<float, kRowPiece> disparity_, slope_u_, slope_v_;
  std::array<std::uint16_t, kRowPiece> reach_;
  std::array<std::array<std::uint32_t, kRowPiece>, 5> colours_;
};

TEST(ProjectRow, VectorAndScalarAreBitIdenticalAndClipped) {
  const auto rows = std::make_unique<Rows>(1);
  const PixelWindow window{200, 40, 120};
  const auto vector = std::make_unique<ProjectedRow>(), scalar = std::make_unique<ProjectedRow>();
  const auto vector_pixels = std::make_unique<SplatPixels>(), scalar_pixels = std::make_unique<SplatPixels>();
  int landed = 0, missed = 0, wide = 0, written = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const RowProjection row = rows->next();
    project_row(row, window, rows->samples, *vector);
    project_row_scalar(row, window, rows->samples, *scalar);
    ASSERT_EQ(vector->second_column, scalar->second_column);
    ASSERT_EQ(vector->second_line, scalar->second_line);
    for (int i = 0; i < rows->samples.count; ++i) {
      const bool lands = vector->bottom[i] >= vector->top[i];
      ASSERT_EQ(lands, scalar->bottom[i] >= scalar->top[i]) << trial << " " << i;
      ASSERT_EQ(vector->wide[i], scalar->wide[i]);
      ++(lands ? landed : missed);
      if (!lands) continue;
      wide += vector->wide[i] == 0;
      ASSERT_EQ(vector->left[i], scalar->left[i]);
      ASSERT_EQ(vector->right[i], scalar->right[i]);
      ASSERT_EQ(vector->top[i], scalar->top[i]);
      ASSERT_EQ(vector->bottom[i], scalar->bottom[i]);
      ASSERT_TRUE(vector->left[i] >= 0 && vector->right[i] < 200 && vector->top[i] >= 40 && vector->bottom[i] < 120);
      ASSERT_LE(vector->right[i] - vector->left[i], 2 * kMaxReach);
    }
    for (int pixel = 0; pixel < 4; ++pixel) {
      sample_pixels(*vector, rows->samples, window.width, pixel & 1, pixel >> 1, *vector_pixels);
      sample_pixels_scalar(*scalar, rows->samples, window.width, pixel & 1, pixel >> 1, *scalar_pixels);
      for (int i = 0; i < rows->samples.count; ++i) {
        ASSERT_EQ(vector_pixels->offset[i], scalar_pixels->offset[i]) << trial << " " << i;
        if (vector_pixels->offset[i] < 0) continue;
        ++written;
        ASSERT_EQ(vector_pixels->high[i], scalar_pixels->high[i]);
        ASSERT_EQ(vector_pixels->low[i], scalar_pixels->low[i]);
      }
    }
  }
  EXPECT_GT(landed, 1000);
  EXPECT_GT(missed, 1000);
  EXPECT_GT(wide, 500);
  EXPECT_GT(written, 1000);
}

// Steps and slopes whose products overflow: both kernels take what is not a number for the same.
TEST(ProjectRow, VectorAndScalarAgreeWhereFloatsOverflow) {
  const auto rows = std::make_unique<Rows>(2);
  const PixelWindow window{200, 40, 120};
  const auto vector = std::make_unique<ProjectedRow>(), scalar = std::make_unique<ProjectedRow>();
  const auto vector_pixels = std::make_unique<SplatPixels>(), scalar_pixels = std::make_unique<SplatPixels>();
  int overflown = 0;
  for (int trial = 0; trial < 200; ++trial) {
    RowProjection row = rows->next();
    row.step_u[trial % 3] = 3e38f, row.step_v[trial / 3 % 3] = trial % 2 ? -3e38f : 1e30f;
    project_row(row, window, rows->samples, *vector);
    project_row_scalar(row, window, rows->samples, *scalar);
    for (int i = 0; i < rows->samples.count; ++i) {
      ASSERT_EQ(vector->bottom[i] >= vector->top[i], scalar->bottom[i] >= scalar->top[i]);
      if (vector->bottom[i] < vector->top[i]) continue;
      overflown += std::isnan(vector->s_x[i]);
      ASSERT_EQ(vector->left[i], scalar->left[i]);
      ASSERT_EQ(vector->right[i], scalar->right[i]);
      ASSERT_EQ(vector->top[i], scalar->top[i]);
      ASSERT_EQ(vector->bottom[i], scalar->bottom[i]);
    }
    sample_pixels(*vector, rows->samples, window.width, 0, 0, *vector_pixels);
    sample_pixels_scalar(*scalar, rows->samples, window.width, 0, 0, *scalar_pixels);
    for (int i = 0; i < rows->samples.count; ++i) {
      ASSERT_EQ(vector_pixels->offset[i], scalar_pixels->offset[i]);
      if (vector_pixels->offset[i] >= 0) { ASSERT_EQ(vector_pixels->high[i], scalar_pixels->high[i]); }
    }
  }
  EXPECT_GT(overflown, 100);
}

TEST(WritePixels, FindsAllNonNegativeEntriesInOrder) {
  std::mt19937 random(3);
  alignas(64) std::array<std::int32_t, kRowPiece> values;
  RowIndices indices;
  for (int count = 0; count <= kRowPiece; ++count) {
    std::vector<std::int32_t> expected;
    for (int i = 0; i < kRowPiece; ++i) {
      values[i] = static_cast<std::int32_t>(random() % 3) - 1;
      if (i < count && values[i] >= 0) expected.push_back(i);
    }
    const int found = find_non_negative(values.data(), count, indices.data());
    ASSERT_EQ(std::vector<std::int32_t>(indices.begin(), indices.begin() + found), expected);
  }
}

}  // namespace
}  // namespace farfield::client
