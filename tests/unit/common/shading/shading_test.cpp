// SPDX-License-Identifier: Apache-2.0
#include "common/shading/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace farfield {
namespace {

glm::vec3 random_unit(std::mt19937& random) {
  std::normal_distribution<float> normal;
  glm::vec3 n;
  do n = {normal(random), normal(random), normal(random)};
  while (glm::dot(n, n) < 1e-6f);
  return glm::normalize(n);
}

TEST(Shading, BothSidesOfASurfaceLookTheSameToTheLastBit) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 n = random_unit(random);
    const float front = vertex_light(n), back = vertex_light(-n);
    EXPECT_EQ(std::memcmp(&front, &back, sizeof front), 0);
  }
}

TEST(Shading, LightStaysInItsRangeAndComesFromAbove) {
  std::mt19937 random(2);
  for (int i = 0; i < 5000; ++i) {
    const float light = vertex_light(random_unit(random));
    EXPECT_GE(light, 0.45f);
    EXPECT_LE(light, 1.05f);
  }
  EXPECT_GT(vertex_light({0, 1, 0}), vertex_light({1, 0, 0}));
  EXPECT_GT(vertex_light({0, 1, 0}), vertex_light({0, 0, 1}));
  EXPECT_GT(std::abs(vertex_light({1, 0, 0}) - vertex_light({0, 0, 1})), 0.05f) << "the sides of a box differ";
}

TEST(Shading, All256SrgbCodesSurviveTheRoundTrip) {
  for (int code = 0; code < 256; ++code) {
    EXPECT_EQ(linear_to_srgb(srgb_to_linear(static_cast<std::uint8_t>(code))), code);
  }
}

// IEC 61966-2-1, evaluated in double.
TEST(Shading, SrgbFollowsItsStandard) {
  for (int code = 0; code < 256; ++code) {
    const double c = code / 255.0;
    const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(srgb_to_linear(static_cast<std::uint8_t>(code)), linear, 1e-6);
  }
}

TEST(Shading, CodingIsMonotonicAndRoundsToTheNearestCode) {
  int last = 0;
  for (int i = 0; i <= 100'000; ++i) {
    const double linear = i / 100'000.0;
    const int code = linear_to_srgb(static_cast<float>(linear));
    EXPECT_GE(code, last);
    last = code;
    const double exact = 255.0 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
    EXPECT_LE(std::abs(code - exact), 0.51) << linear;  // half a code, and what float tables may lose at its border
  }
  EXPECT_EQ(last, 255);
}

TEST(Shading, ValuesOutsideTheRangeAreClamped) {
  EXPECT_EQ(linear_to_srgb(-1.0f), 0);
  EXPECT_EQ(linear_to_srgb(7.0f), 255);
  EXPECT_EQ(linear_to_srgb(std::numeric_limits<float>::infinity()), 255);
  EXPECT_EQ(linear_to_srgb(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Shading, AMipLevelHalvesTheEdgeForEveryFourTexels) {
  EXPECT_FLOAT_EQ(mip_level(0.25f), 0.0f);
  EXPECT_FLOAT_EQ(mip_level(1.0f), 0.0f);
  EXPECT_FLOAT_EQ(mip_level(4.0f), 1.0f);
  EXPECT_FLOAT_EQ(mip_level(1024.0f * 1024.0f), 10.0f);
}

}  // namespace
}  // namespace farfield
