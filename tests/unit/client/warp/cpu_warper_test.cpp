// SPDX-License-Identifier: Apache-2.0
#include "client/warp/cpu_warper.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/client/warp/near_layer.h"
#include "tests/unit/client/warp/warp_scene.h"

namespace farfield::client {
namespace {

std::uint32_t pixel(const Frame& frame, int x, int y) {
  const std::uint8_t* p = &frame.rgba[4 * (static_cast<std::size_t>(y) * frame.width + x)];
  return p[0] | p[1] << 8 | p[2] << 16;
}
Coverage coverage(const Frame& frame, int x, int y) {
  return frame.coverage[static_cast<std::size_t>(y) * frame.width + x];
}
float disparity(const Frame& frame, int x, int y) {
  return frame.disparity[static_cast<std::size_t>(y) * frame.width + x];
}

TEST(CpuWarper, WarpingAViewOntoItselfGivesItself) {
  std::mt19937 random(1);
  const int n = face_samples(1);
  const auto tile = plane_tile({0, 0, 0}, 2.0, 5.0, n, [&](double, double) { return random() & 0xffffffu; });
  Frame frame;
  CpuWarper().draw(leaf_of({tile}), Pose{}, display_on_samples(n, n, 100), nullptr, frame);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < n; ++x) {
      const int i = x, j = n / 2 + 49 - y;  // v goes up, rows go down
      ASSERT_EQ(pixel(frame, x, y), tile->splats.colour[j * n + i]) << x << " " << y;
      ASSERT_EQ(coverage(frame, x, y), Coverage::kImpostor);
      ASSERT_FLOAT_EQ(disparity(frame, x, y), 0.2f);
    }
  }
  EXPECT_EQ(frame.statistics.tiles_drawn, 1u);
  EXPECT_EQ(frame.statistics.samples_drawn, static_cast<std::uint64_t>(n) * n);
  EXPECT_EQ(frame.statistics.void_pixels + frame.statistics.crack_pixels + frame.statistics.background_pixels, 0u);
}

TEST(CpuWarper, AShiftedEyeSeesThePlaneWhereGeometrySays) {
  // Red and green grow by one code per pixel of the plane along x and y, so colour measures position.
  const int n = 510;
  const double distance = 4.0, metres_per_code = distance * sample_pitch(n);
  const auto code = [&](double metres) { return std::clamp(128.0 + metres / metres_per_code, 0.0, 255.0); };
  const auto tile = plane_tile({0.3, -0.2, 0.1}, 1.0, distance, n, [&](double x, double y) {
    return static_cast<std::uint32_t>(std::lround(code(x))) | static_cast<std::uint32_t>(std::lround(code(y))) << 8;
  });
  const Display display = display_on_samples(400, 160, 120);
  for (const glm::dvec3 eye : {glm::dvec3(0, 0, 0), {0.4, 0.1, -0.5}, {-0.31, 0.27, 0.33}}) {
    Frame frame;
    CpuWarper().draw(leaf_of({tile}), Pose{eye, {1, 0, 0, 0}}, display, nullptr, frame);
    double bias_x = 0, bias_y = 0, worst = 0;
    for (int y = 0; y < display.height; ++y) {
      for (int x = 0; x < display.width; ++x) {
        const glm::dvec3 direction = camera_direction(display, x + 0.5, y + 0.5);
        const double reach = distance + eye.z;
        const double dx = (pixel(frame, x, y) & 255) - code(eye.x + direction.x * reach);
        const double dy = (pixel(frame, x, y) >> 8 & 255) - code(eye.y + direction.y * reach);
        bias_x += dx, bias_y += dy;
        worst = std::max({worst, std::abs(dx), std::abs(dy)});
        ASSERT_NEAR(disparity(frame, x, y) * reach, 1.0, 2e-4);  // kDistancePenalty at half a sample
      }
    }
    const double pixels = display.width * display.height;
    EXPECT_LT(std::abs(bias_x / pixels), 0.05);
    EXPECT_LT(std::abs(bias_y / pixels), 0.05);
    EXPECT_LT(worst, 1.3);  // half a sample, at most 0.66 of them per code, and half a code of rounding
  }
}

TEST(CpuWarper, OfTwoViewsOfASurfaceTheFinerSamplesShow) {
  // As coding leaves them: the coarse view puts the plane a thousandth nearer.
  const auto fine = plane_tile({0, 0, 0}, 1.0, 5.0, 256, [](double, double) { return 0x00ff00u; });
  const auto coarse = plane_tile({0, 0, 0}, 1.0, 4.995, 64, [](double, double) { return 0x0000ffu; });
  Frame frame;
  for (const LeafView& leaf : {leaf_of({fine, coarse}), leaf_of({coarse, fine})}) {
    CpuWarper().draw(leaf, Pose{{0.2, 0.1, 0.1}, {1, 0, 0, 0}}, display_on_samples(256, 120, 100), nullptr, frame);
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 120; ++x) ASSERT_EQ(pixel(frame, x, y), 0x00ff00u) << x << " " << y;
  }
  // What is nearer by more than that hides the rest however coarse it is.
  const auto nearer = plane_tile({0, 0, 0}, 1.0, 4.9, 64, [](double, double) { return 0x0000ffu; });
  CpuWarper().draw(leaf_of({fine, nearer}), Pose{}, display_on_samples(256, 120, 100), nullptr, frame);
  EXPECT_EQ(pixel(frame, 60, 50), 0x0000ffu);
}

TEST(CpuWarper, EverySampleCoversThePixelOfItsPoint) {
  std::mt19937 random(2);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  Display display;
  display.width = 320, display.height = 200;
  int landed = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const double side = std::exp(uniform(-3, 6));
    const glm::dvec3 view(uniform(-1e3, 1e3), uniform(-1e3, 1e3), uniform(-1e3, 1e3));
    const int face = trial % 6;
    const float u = static_cast<float>(uniform(-1, 1)), v = static_cast<float>(uniform(-1, 1));
    const float d = static_cast<float>(uniform(0.01, 0.2));
    Pose eye;
    eye.position = view + side * glm::dvec3(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5));
    eye.world_from_camera = glm::normalize(glm::dquat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
    // Wide enough that its cell holds the centre of the pixel it lands in, whichever way it is turned.
    const float pitch = static_cast<float>(4.0 * display.pixel_pitch());
    Frame frame;
    CpuWarper({.smooth_edges = false})
        .draw(leaf_of({single_sample(view, side, face, u, v, d, 0xabcdef, pitch)}), eye, display, nullptr, frame);

    const glm::dvec3 point = view + side / d * CubeFace::of(face).direction<double>(u, v);
    const glm::dvec3 p = glm::conjugate(eye.world_from_camera) * (point - eye.position);
    const double x = 0.5 * display.width + p.x / -p.z / display.pixel_pitch();
    const double y = 0.5 * display.height - p.y / -p.z / display.pixel_pitch();
    const double on_border = std::min(std::abs(x - std::round(x)), std::abs(y - std::round(y)));
    if (on_border < 2e-3) continue;  // float may land it on the other side
    const bool inside = p.z < 0 && x >= 0 && y >= 0 && x < display.width && y < display.height;
    if (!inside) continue;
    ++landed;
    ASSERT_EQ(pixel(frame, static_cast<int>(x), static_cast<int>(y)), 0xabcdefu);
    // The surface is a plane of constant disparity of its own view, turned against the eye's.
    ASSERT_NEAR(disparity(frame, static_cast<int>(x), static_cast<int>(y)) * -p.z, 1.0, 0.02);
  }
  EXPECT_GT(landed, 20);
}

TEST(CpuWarper, ASampleCoversWhatItsCellCovers) {
  // A cell of 3 × 3 pixels with its sample on a pixel's centre, and one of a third of a pixel that holds no centre.
  Display display;
  display.width = display.height = 32;
  const double pixel_pitch = display.pixel_pitch();
  for (const float size : {3.0f, 0.3f}) {
    const float at = static_cast<float>((size > 1 ? 0.5 : 0.2) * pixel_pitch);
    Frame frame;
    CpuWarper().draw(leaf_of({single_sample({0, 0, 0}, 1.0, kMinusZ, at, at, 0.1f, 0x10, size * pixel_pitch)}), Pose{},
                     display, nullptr, frame);
    int covered = 0;
    for (const Coverage c : frame.coverage) covered += c == Coverage::kImpostor;
    EXPECT_EQ(covered, size > 1 ? 9 : 0);
  }
}

TEST(CpuWarper, InfinityDoesNotMoveWithTheEye) {
  Display display;
  display.width = 64, display.height = 48;
  for (const glm::dvec3 eye : {glm::dvec3(0), glm::dvec3(5, -3, 0.4), glm::dvec3(-1e5, 2e5, 1e5)}) {
    Frame frame;
    CpuWarper().draw(leaf_of({single_sample({0, 0, 0}, 1.0, kMinusZ, 0.101f, 0.053f, 0.0f, 0, 0.05f)}),
                     Pose{eye, {1, 0, 0, 0}}, display, nullptr, frame);
    const int x = static_cast<int>(32 + 0.101 / display.pixel_pitch());
    const int y = static_cast<int>(24 - 0.053 / display.pixel_pitch());
    EXPECT_EQ(coverage(frame, x, y), Coverage::kImpostor);
    EXPECT_EQ(pixel(frame, x, y), 0u);  // black at infinity still counts as a surface
    EXPECT_FLOAT_EQ(disparity(frame, x, y), 0.0f);
  }
}

TEST(CpuWarper, ATileBehindTheCameraDrawsNothing) {
  const auto tile = plane_tile({0, 0, 0}, 1.0, 3.0, 64, [](double, double) { return 0xffu; });
  Pose eye;
  eye.world_from_camera = glm::dquat(0, 0, 1, 0);  // half a turn about +Y: looks along +Z
  Frame frame;
  CpuWarper().draw(leaf_of({tile}), eye, Display{}, nullptr, frame);
  EXPECT_EQ(frame.statistics.tiles_drawn, 0u);
  EXPECT_EQ(frame.statistics.background_pixels, frame.pixels());
  EXPECT_EQ(pixel(frame, 100, 100), 0x030201u);
}

TEST(CpuWarper, SamplesBehindTheEyeOfAVisibleTileAreNotMirrored) {
  // An eye beyond the plane: every sample is behind it.
  const auto tile = plane_tile({0, 0, 0}, 4.0, 3.0, 64, [](double, double) { return 0xffu; });
  Frame frame;
  CpuWarper().draw(leaf_of({tile}), Pose{{0, 0, -3.5}, {1, 0, 0, 0}}, Display{}, nullptr, frame);
  EXPECT_EQ(frame.statistics.background_pixels, frame.pixels());
}

TEST(CpuWarper, NearGeometryMergesByDepth) {
  const int n = 128;
  const auto tile = plane_tile({0, 0, 0}, 1.0, 4.0, n, [](double, double) { return 0x0000ffu; });
  const Display display = display_on_samples(n, 40, 30);
  std::vector<std::uint8_t> rgba(40 * 30 * 4, 0);
  std::vector<float> depth(40 * 30, 0.0f);
  for (int x = 0; x < 40; ++x) {
    for (int y = 0; y < 30; ++y) {
      rgba[4 * (y * 40 + x) + 1] = 200;
      rgba[4 * (y * 40 + x) + 3] = 255;
      if (x < 10) depth[y * 40 + x] = 0.1f * (1 / 3.9f);         // in front
      if (x >= 30) depth[y * 40 + x] = 0.1f * (1 / 4.1f);        // behind
    }
  }
  const NearLayer near{40, 30, rgba, depth, 10.0f};
  Frame frame;
  CpuWarper().draw(leaf_of({tile}), Pose{}, display, &near, frame);
  for (int y = 0; y < 30; ++y) {
    EXPECT_EQ(coverage(frame, 5, y), Coverage::kNear);
    EXPECT_EQ(pixel(frame, 5, y), 0x00c800u);
    EXPECT_NEAR(disparity(frame, 5, y), 1 / 3.9, 1e-6);
    EXPECT_EQ(coverage(frame, 20, y), Coverage::kImpostor);
    EXPECT_EQ(coverage(frame, 35, y), Coverage::kImpostor);
    EXPECT_EQ(pixel(frame, 35, y), 0x0000ffu);
  }
}

TEST(CpuWarper, AFrontalSurfaceNeverShowsCracks) {
  const int n = 400;
  const auto tile = plane_tile({0, 0, 0}, 2.0, 5.0, n, [](double, double) { return 0x102030u; });
  for (const double roll : {0.0, 0.2, 0.785, 1.3}) {
    for (const double forward : {-1.0, 0.0, 1.0, 2.5}) {
      Pose eye;
      eye.position.z = -forward;
      eye.world_from_camera = glm::angleAxis(roll, glm::dvec3(0, 0, 1));
      Frame frame;
      CpuWarper().draw(leaf_of({tile}), eye, display_on_samples(n, 150, 130), nullptr, frame);
      for (const Coverage c : frame.coverage) ASSERT_EQ(c, Coverage::kImpostor) << roll << " " << forward;
    }
  }
}

LeafView random_planes(int samples) {
  std::mt19937 random(4);
  std::vector<std::shared_ptr<const DecodedTile>> tiles;
  for (int k = 0; k < 3; ++k) {
    auto tile = plane_tile({0.1 * k, 0, 0}, 2.0, 3.0 + k, samples, [&](double, double) { return random() & 0xffffffu; });
    for (float& d : tile->splats.disparity) d *= 1.0f - 0.01f * static_cast<float>(random() % 10);
    tile->splats.min_disparity *= 0.9f;
    tile->splats.blocks = find_blocks(tile->splats);
    tiles.push_back(tile);
  }
  return leaf_of(std::move(tiles));
}

TEST(CpuWarper, NeitherKernelNorThreadsChangeTheImage) {
  const LeafView leaf = random_planes(200);
  Pose eye{{0.3, 0.2, -0.7}, glm::angleAxis(0.3, glm::normalize(glm::dvec3(1, 2, 0.5)))};
  Display display;
  display.width = 333, display.height = 217;
  for (const int samples_per_pixel : {1, 4}) {
    Frame vector, scalar, single;
    CpuWarper({samples_per_pixel, 2, ProjectionKernel::kVector}).draw(leaf, eye, display, nullptr, vector);
    CpuWarper({samples_per_pixel, 2, ProjectionKernel::kScalar}).draw(leaf, eye, display, nullptr, scalar);
    CpuWarper({samples_per_pixel, 1, ProjectionKernel::kVector}).draw(leaf, eye, display, nullptr, single);
    EXPECT_EQ(vector.rgba, scalar.rgba);
    EXPECT_EQ(vector.coverage, scalar.coverage);
    EXPECT_EQ(vector.disparity, scalar.disparity);
    EXPECT_EQ(vector.rgba, single.rgba);
    EXPECT_EQ(vector.coverage, single.coverage);
    EXPECT_EQ(vector.width, 333);
  }
}

TEST(CpuWarper, AReusedWarperForgetsTheLastFrame) {
  CpuWarper warper;
  Frame frame;
  const Display display = display_on_samples(128, 40, 30);
  const auto tile = plane_tile({0, 0, 0}, 1.0, 4.0, 128, [](double, double) { return 0xffu; });
  warper.draw(leaf_of({tile}), Pose{}, display, nullptr, frame);
  warper.draw(leaf_of({}), Pose{}, display, nullptr, frame);
  EXPECT_EQ(frame.statistics.background_pixels, frame.pixels());
  EXPECT_EQ(frame.statistics.samples_drawn, 0u);
}

TEST(CpuWarper, NoSkyWhereTheLeafSetSaysThereIsNone) {
  auto tile = plane_tile({0, 0, 0}, 1.0, 4.0, 128, [](double, double) { return 0x00ff00u; });
  LeafView leaf = leaf_of({tile});
  leaf.background_visible = false;
  Frame frame;
  Display wide;
  wide.width = 200, wide.height = 100, wide.fovy_rad = 2.6;  // the plane fills only the middle
  CpuWarper().draw(leaf, Pose{}, wide, nullptr, frame);
  EXPECT_EQ(frame.statistics.background_pixels, 0u);
  EXPECT_GT(frame.statistics.void_pixels, 5000u);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 200; ++x) ASSERT_EQ(pixel(frame, x, y), 0x00ff00u);
  }
}

}  // namespace
}  // namespace farfield::client
