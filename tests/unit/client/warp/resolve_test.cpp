// SPDX-License-Identifier: Apache-2.0
// Closing of cracks, filling of voids, and averaging of samples, on small frames set by hand.
#include <gtest/gtest.h>

#include "client/warp/average_samples.h"
#include "client/warp/close_cracks.h"
#include "client/warp/fill_voids.h"
#include "client/warp/splat_key.h"

namespace farfield::client {
namespace {

constexpr int kSize = 24;

Frame blank_frame() {
  Frame frame;
  frame.width = frame.height = kSize;
  frame.rgba.resize(4 * frame.pixels());
  frame.disparity.resize(frame.pixels());
  frame.coverage.resize(frame.pixels());
  return frame;
}
std::size_t at(int x, int y) { return static_cast<std::size_t>(y) * kSize + x; }
std::uint64_t splat(float disparity, std::uint32_t colour) { return make_key(key_high(disparity), colour); }

struct Resolved {
  Frame frame;
  ResolveCounts counts;
};
Resolved resolve(const std::vector<std::uint64_t>& keys) {
  Resolved r{blank_frame(), {}};
  for (int y = 0; y < kSize; y += 5) {  // in bands, as the warper does
    const ResolveCounts c = resolve_rows(keys.data(), y, std::min(y + 5, kSize), 0x0000ff, r.frame);
    r.counts.crack_pixels += c.crack_pixels;
    r.counts.uncovered_pixels += c.uncovered_pixels;
  }
  return r;
}

TEST(CloseCracks, ALineOfNothingInASurfaceCloses) {
  std::vector<std::uint64_t> keys(kSize * kSize, splat(0.5f, 0x404040));
  for (int y = 0; y < kSize; ++y) keys[at(7, y)] = kNoSplat;
  for (int y = 0; y < kSize; ++y) keys[at(8, y)] = splat(0.51f, 0x606060);
  const Resolved r = resolve(keys);
  EXPECT_EQ(r.counts.crack_pixels, static_cast<std::uint64_t>(kSize));
  EXPECT_EQ(r.counts.uncovered_pixels, 0u);
  EXPECT_EQ(r.frame.coverage[at(7, 12)], Coverage::kCrackClosed);
  EXPECT_EQ(r.frame.rgba[4 * at(7, 12)], 0x50);
  EXPECT_NEAR(r.frame.disparity[at(7, 12)], 0.505f, 1e-6);
}

TEST(CloseCracks, AFartherSurfaceShowingThroughALineCloses) {
  std::vector<std::uint64_t> keys(kSize * kSize, splat(0.5f, 0x404040));
  for (int y = 0; y < kSize; ++y) keys[at(7, y)] = splat(0.1f, 0xffffff);
  const Resolved r = resolve(keys);
  EXPECT_EQ(r.counts.crack_pixels, static_cast<std::uint64_t>(kSize) - 2);  // the ends lack a pair
  EXPECT_EQ(r.frame.rgba[4 * at(7, 12)], 0x40);
}

TEST(CloseCracks, WiderGapsAndEdgesStay) {
  std::vector<std::uint64_t> keys(kSize * kSize, splat(0.5f, 0x404040));
  for (int y = 0; y < kSize; ++y) {
    for (int x = 12; x < kSize; ++x) keys[at(x, y)] = splat(0.1f, 0xffffff);  // an edge between two surfaces
    keys[at(4, y)] = keys[at(5, y)] = kNoSplat;                               // two pixels wide
  }
  const Resolved r = resolve(keys);
  EXPECT_EQ(r.counts.crack_pixels, 0u);
  EXPECT_EQ(r.counts.uncovered_pixels, 2u * kSize);
  EXPECT_EQ(r.frame.coverage[at(4, 3)], Coverage::kBackground);
  EXPECT_EQ(r.frame.rgba[4 * at(4, 3)], 0xff);
  EXPECT_EQ(r.frame.rgba[4 * at(12, 3)], 0xff);
}

TEST(CloseCracks, SidesOfDifferentDepthDoNotClose) {
  std::vector<std::uint64_t> keys(kSize * kSize, splat(0.5f, 0x404040));
  for (int y = 0; y < kSize; ++y) {
    keys[at(7, y)] = kNoSplat;
    for (int x = 8; x < kSize; ++x) keys[at(x, y)] = splat(0.3f, 0x404040);
  }
  EXPECT_EQ(resolve(keys).counts.crack_pixels, 0u);
}

TEST(CloseCracks, NearGeometryIsExact) {
  std::vector<std::uint64_t> keys(kSize * kSize, near_key(0.5f, 0x404040));
  for (int y = 0; y < kSize; ++y) keys[at(7, y)] = splat(0.1f, 0xffffff);  // seen through near bars
  for (int y = 0; y < kSize; ++y) keys[at(15, y)] = kNoSplat;
  const Resolved r = resolve(keys);
  EXPECT_EQ(r.counts.crack_pixels, 0u);
  EXPECT_EQ(r.counts.uncovered_pixels, static_cast<std::uint64_t>(kSize));
  EXPECT_EQ(r.frame.coverage[at(3, 3)], Coverage::kNear);
  EXPECT_EQ(r.frame.coverage[at(7, 3)], Coverage::kImpostor);
}

void set(Frame& frame, int x, int y, Coverage c, float disparity, std::uint8_t grey) {
  frame.coverage[at(x, y)] = c;
  frame.disparity[at(x, y)] = disparity;
  for (int k = 0; k < 3; ++k) frame.rgba[4 * at(x, y) + k] = grey;
}
Frame uncovered_frame() {
  Frame frame = blank_frame();
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) set(frame, x, y, Coverage::kBackground, 0, 9);
  }
  return frame;
}
void columns(Frame& frame, int from, int to, Coverage c, float disparity, std::uint8_t grey) {
  for (int y = 0; y < kSize; ++y) {
    for (int x = from; x < to; ++x) set(frame, x, y, c, disparity, grey);
  }
}

SkyTest no_sky() { return {DirectionMask(), glm::dmat3(1), Display{kSize, kSize, 1.0}}; }
SkyTest sky_everywhere() { return {DirectionMask::all(), glm::dmat3(1), Display{kSize, kSize, 1.0}}; }

TEST(FillVoids, TakesTheFarthestNeighbour) {
  Frame frame = uncovered_frame();
  columns(frame, 0, 10, Coverage::kNear, 0.9f, 100);
  columns(frame, 14, kSize, Coverage::kImpostor, 0.2f, 50);
  EXPECT_EQ(fill_voids(frame, no_sky(), 8), 4u * kSize);
  for (int x = 10; x < 14; ++x) {
    EXPECT_EQ(frame.coverage[at(x, 5)], Coverage::kVoidFilled);
    EXPECT_EQ(frame.rgba[4 * at(x, 5)], 50);
    EXPECT_FLOAT_EQ(frame.disparity[at(x, 5)], 0.2f);
  }
}

TEST(FillVoids, WhereTheBackgroundCanBeSeenItStays) {
  Frame frame = uncovered_frame();
  columns(frame, 0, 4, Coverage::kImpostor, 0.2f, 50);
  EXPECT_EQ(fill_voids(frame, sky_everywhere(), 8), 0u);
  EXPECT_EQ(frame.rgba[4 * at(20, 3)], 9);
}

TEST(FillVoids, TheMaskDecidesByDirection) {
  const Display display{kSize, kSize, 1.0};
  DirectionMask mask;
  for (int y = 0; y < kSize; ++y)  // the right half of the image
    for (int x = kSize / 2; x < kSize; ++x) mask.insert(camera_direction(display, x + 0.5, y + 0.5));
  const SkyTest sky(mask, glm::dmat3(1), display);
  Frame frame = uncovered_frame();
  columns(frame, 0, 4, Coverage::kImpostor, 0.2f, 50);
  fill_voids(frame, sky, 8);
  EXPECT_EQ(frame.coverage[at(8, 5)], Coverage::kVoidFilled);
  EXPECT_EQ(frame.rgba[4 * at(8, 5)], 50);
  EXPECT_EQ(frame.coverage[at(kSize - 2, 5)], Coverage::kBackground);
  EXPECT_EQ(frame.rgba[4 * at(kSize - 2, 5)], 9);
}

TEST(FillVoids, WithoutSkyEverythingIsFilled) {
  Frame frame = uncovered_frame();
  set(frame, 2, 20, Coverage::kImpostor, 0.2f, 50);
  EXPECT_EQ(fill_voids(frame, no_sky(), 4), frame.pixels() - 1);
  for (std::size_t k = 0; k < frame.pixels(); ++k) {
    ASSERT_NE(frame.coverage[k], Coverage::kBackground);
    ASSERT_EQ(frame.rgba[4 * k], 50);
  }
  Frame empty = uncovered_frame();
  EXPECT_EQ(fill_voids(empty, no_sky(), 4), empty.pixels());
  EXPECT_EQ(empty.rgba[4 * at(3, 3)], 9);
}

TEST(AverageSamples, AveragesLinearLight) {
  Frame fine = blank_frame();
  columns(fine, 0, kSize, Coverage::kImpostor, 0.5f, 0);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 1; x < kSize; x += 2) set(fine, x, y, Coverage::kNear, 0.7f, 255);
  }
  Frame frame;
  average_samples(fine, frame);
  ASSERT_EQ(frame.width, kSize / 2);
  EXPECT_EQ(frame.rgba[0], 188);  // half the light is code 187.5 of sRGB
  EXPECT_EQ(frame.rgba[3], 255);
  EXPECT_EQ(frame.coverage[0], Coverage::kNear);
  EXPECT_FLOAT_EQ(frame.disparity[0], 0.7f);
}

TEST(AverageSamples, KeepsEveryUniformCode) {
  Frame fine = blank_frame(), frame;
  for (int code = 0; code < 256; ++code) {
    columns(fine, 0, kSize, Coverage::kImpostor, 0.5f, static_cast<std::uint8_t>(code));
    average_samples(fine, frame);
    ASSERT_EQ(frame.rgba[40], code);
  }
}

}  // namespace
}  // namespace farfield::client
