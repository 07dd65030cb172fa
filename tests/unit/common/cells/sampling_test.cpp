// SPDX-License-Identifier: Apache-2.0
// The figures of design.md section 2, and the promise behind them: disparity within its tolerance moves nothing farther
// than tau pixels, seen from anywhere in the cell.
#include "common/cells/sampling.h"

#include <gtest/gtest.h>

#include <random>

#include "common/math/cube_face.h"

namespace farfield {
namespace {

constexpr double kKappa = 2.0, kTau = 0.25;
const Display k720p{1280, 720};
const Display k1080p{1920, 1080};

double angle_between(const glm::dvec3& a, const glm::dvec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

// The largest angle by which an error of `tolerance` moves any of many samples of a view at `offset` seen by eyes within
// ±eye_range of the cell's centre. Every other choice is an extreme one, so that the worst case is met closely.
double largest_warp(const glm::dvec3& offset, double margin, double eye_range, double tolerance, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> signed_unit(-1, 1), unit(0, 1);
  const auto place = [&] {
    const double free = signed_unit(random);
    return random() % 2 ? free : std::copysign(1.0, free);
  };
  double worst = 0;
  for (int k = 0; k < 200000; ++k) {
    const CubeFace face = CubeFace::of(k % kCubeFaces);
    const glm::dvec3 direction = face.direction(place(), place());
    const glm::dvec3 eye = glm::dvec3(place(), place(), place()) * eye_range - offset;
    const double nearest = 0.5 + margin - face.sign * offset[face.axis];
    const double disparity = (random() % 2 ? 1.0 : unit(random)) / nearest;
    const double wrong = disparity + (random() % 2 ? tolerance : -tolerance);
    worst = std::max(worst, angle_between(direction - eye * disparity, direction - eye * wrong));
  }
  return worst;
}

TEST(Sampling, OneSamplePerPixelNeedsTheSamplesOfTheDesign) {
  EXPECT_NEAR(edge_samples_for(k720p, kKappa), 1560, 0.01 * 1560);
  EXPECT_NEAR(edge_samples_for(k1080p, kKappa), 2340, 0.01 * 2340);
  EXPECT_GT(edge_samples_for(k720p, 1.0), edge_samples_for(k720p, 2.0)) << "a smaller margin magnifies more";
}

TEST(Sampling, WarpGainHasTheValuesOfTheDesign) {
  EXPECT_NEAR(warp_gain({0, 0, 0}, kKappa), 0.98, 0.01);
  const double corner = warp_gain({0.5, 0.5, 0.5}, kKappa);
  EXPECT_GE(corner, 2.34);
  EXPECT_LE(corner, 2.40);
  EXPECT_LT(warp_gain({0, 0, 0}, 3.0), warp_gain({0, 0, 0}, 2.0));
}

TEST(Sampling, WarpGainIsTheSameForMirroredViews) {
  const double gain = warp_gain({0.3, 0.1, -0.4}, kKappa);
  EXPECT_NEAR(warp_gain({-0.3, 0.1, -0.4}, kKappa), gain, 1e-9 * gain);
  EXPECT_NEAR(warp_gain({0.1, -0.4, 0.3}, kKappa), gain, 1e-9 * gain);
}

TEST(Sampling, DisparityWithinItsToleranceStaysWithinTau) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  for (unsigned k = 0; k < 6; ++k) {
    const glm::dvec3 offset = k == 0 ? glm::dvec3(0) : k == 1 ? glm::dvec3(0.5) : glm::dvec3(place(random), place(random), place(random));
    for (const double kappa : {1.0, 2.0}) {
      const double tolerance = disparity_tolerance(offset, kappa, kTau, k720p);
      const double allowed = kTau * k720p.pixel_pitch();
      const double worst = largest_warp(offset, kappa, 0.5, tolerance, 40 + k);
      EXPECT_LE(worst, 1.02 * allowed) << "view " << k << ", kappa " << kappa;
      EXPECT_GE(worst, 0.8 * allowed) << "the bound must not be wasteful either: view " << k << ", kappa " << kappa;
    }
  }
}

TEST(Sampling, ToleranceGrowsWithTauAndWithPixels) {
  const double tolerance = disparity_tolerance({0, 0, 0}, kKappa, kTau, k720p);
  EXPECT_NEAR(disparity_tolerance({0, 0, 0}, kKappa, 2 * kTau, k720p), 2 * tolerance, 1e-12);
  EXPECT_LT(disparity_tolerance({0, 0, 0}, kKappa, kTau, k1080p), tolerance);
}

}  // namespace
}  // namespace farfield
