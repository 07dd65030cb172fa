// SPDX-License-Identifier: Apache-2.0
// Whole frames of a small scene that both renderers must agree on: a wall far away as an impostor, a board nearby as
// geometry, the sky around them.
#include "client/frame/frame_renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/impostor/tile_id.h"
#include "common/math/cube_face.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr double kSide = 1.0;
constexpr double kWallZ = -8.0;
const Display kDisplay{120, 90, 1.0};
const glm::u8vec3 kSky{10, 20, 240};

/// The view of the wall z = kWallZ, |x|, |y| < half_width, from the cell's centre through face 5 (-Z). Where
/// `is_hole` says so nothing is known.
template <class IsHole>
std::shared_ptr<DecodedTile> wall_tile(double half_width, IsHole is_hole, std::uint64_t serial) {
  Tile tile;
  tile.id.face = 5;
  tile.edge_samples = face_samples(1);
  tile.width = tile.height = kTileSamples;
  tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
  for (int row = 0; row < kTileSamples; ++row) {
    for (int column = 0; column < kTileSamples; ++column) {
      const double u = sample_tangent(kTileSamples, column), v = sample_tangent(kTileSamples, row);
      const double x = -kWallZ * u, y = -kWallZ * v;
      tile.coverage.push_back(std::max(std::abs(x), std::abs(y)) < half_width && !is_hole(x, y));
      tile.disparity.push_back(tile.coverage.back() ? static_cast<float>(-kSide / kWallZ) : 0.0f);
      tile.rgb.push_back(static_cast<std::uint8_t>(128 + 60 * std::sin(x)));
      tile.rgb.push_back(static_cast<std::uint8_t>(128 + 60 * std::sin(0.7 * y)));
      tile.rgb.push_back(90);
    }
  }
  auto decoded = std::make_shared<DecodedTile>();
  decoded->id = tile.id, decoded->serial = serial, decoded->side_m = kSide;
  decoded->mesh = PackedMesh(build_depth_mesh(tile, 0));
  decoded->splats = build_splats(tile);
  return decoded;
}

/// A white board in the plane z = -1.5, x from 0 to 1, |y| < 1.
PlacedChunk board() {
  auto decoded = std::make_shared<DecodedChunk>();
  decoded->serial = 1000;
  for (const glm::vec2& p : {glm::vec2(0, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(0, 1)}) {
    decoded->chunk.vertices.push_back({{p.x, p.y, -1.5f}, encode_normal({0, 0, 1}), {}, {255, 255, 255, 255}});
  }
  decoded->chunk.indices = {0, 1, 2, 0, 2, 3};
  return {decoded, nullptr, glm::mat4x3{1}};
}

std::shared_ptr<LeafView> scene(std::shared_ptr<DecodedTile> tile) {
  auto leaf = std::make_shared<LeafView>();
  leaf->leaf_box = Box{glm::dvec3(0), glm::dvec3(0)}.grown(kSide / 2);
  leaf->near_region = leaf->leaf_box.grown(2 * kSide);
  leaf->background = kSky;
  leaf->is_complete = true;
  leaf->tiles = {std::move(tile)};
  return leaf;
}

const auto kNoHole = [](double, double) { return false; };

class FrameRendererTest : public testing::TestWithParam<Renderer> {
 protected:
  std::unique_ptr<FrameRenderer> make(const FrameOptions& options = {}) {
    auto renderer = FrameRenderer::create(GetParam(), kDisplay, options);
    EXPECT_TRUE(renderer) << renderer.error().message;
    return std::move(*renderer);
  }
  /// The pixel that shows the point (x, y, z), seen from the origin along -Z.
  std::size_t pixel_of(double x, double y, double z) const {
    const double pitch = kDisplay.pixel_pitch();
    const int column = static_cast<int>(x / -z / pitch + 0.5 * kDisplay.width);
    const int row = static_cast<int>(0.5 * kDisplay.height - y / -z / pitch);
    return static_cast<std::size_t>(row * kDisplay.width + column);
  }
  Frame frame_;
};

TEST_P(FrameRendererTest, NearAndImpostorMeetByDepth) {
  auto leaf = scene(wall_tile(20, kNoHole, 1));
  leaf->chunks.push_back(board());
  const FrameReport report = make()->render(leaf, {}, frame_);
  EXPECT_EQ(report.near.triangles, 2u);
  EXPECT_GT(report.times.total_ms, 0);
  ASSERT_EQ(frame_.pixels(), 120u * 90);
  const std::size_t on_board = pixel_of(0.4, 0.3, -1.5), on_wall = pixel_of(-0.4, 0.3, -1.5);
  EXPECT_EQ(frame_.coverage[on_board], Coverage::kNear);
  EXPECT_NEAR(frame_.disparity[on_board], 1 / 1.5, 1e-4);
  EXPECT_NEAR(frame_.rgba[4 * on_board], linear_to_srgb(vertex_light({0, 0, 1})), 1);
  EXPECT_EQ(frame_.coverage[on_wall], Coverage::kImpostor);
  EXPECT_NEAR(frame_.disparity[on_wall], -1 / kWallZ, 1e-3);
  EXPECT_EQ(frame_.statistics.void_pixels, 0u);
  EXPECT_EQ(frame_.statistics.background_pixels, 0u);
  for (std::size_t p = 0; p < frame_.pixels(); ++p) EXPECT_EQ(frame_.rgba[4 * p + 3], 255);
}

TEST_P(FrameRendererTest, AShiftedEyeSeesTheWallWhereGeometrySays) {
  const auto leaf = scene(wall_tile(60, kNoHole, 1));
  const Pose eye{{0.4, -0.3, -0.45}, glm::dquat(glm::dvec3(0.05, -0.1, 0.2))};
  make()->render(leaf, eye, frame_);
  double squares = 0;
  int count = 0;
  for (int y = 0; y < kDisplay.height; ++y) {
    for (int x = 0; x < kDisplay.width; ++x) {
      const auto p = static_cast<std::size_t>(y * kDisplay.width + x);
      const glm::dvec3 ray = eye.world_from_camera * camera_direction(kDisplay, x + 0.5, y + 0.5);
      const double t = (kWallZ - eye.position.z) / ray.z;
      const glm::dvec3 hit = eye.position + t * ray;
      if (std::max(std::abs(hit.x), std::abs(hit.y)) > 7.5) continue;  // beyond what one face's view holds
      EXPECT_NEAR(frame_.disparity[p], 1 / t, 0.02 / t);
      const double expected[2] = {128 + 60 * std::sin(hit.x), 128 + 60 * std::sin(0.7 * hit.y)};
      for (std::size_t c = 0; c < 2; ++c) squares += std::pow(expected[c] - frame_.rgba[4 * p + c], 2), ++count;
    }
  }
  ASSERT_GT(count, 10000);
  // Splats are placed to a pixel, meshes exactly.
  EXPECT_GT(10 * std::log10(255.0 * 255 * count / squares), GetParam() == Renderer::kGl ? 45 : 28);
}

TEST_P(FrameRendererTest, HolesWhereNoSkyCanBeShowSurface) {
  const auto hole = [](double x, double y) { return std::abs(x) < 0.2 && std::abs(y) < 0.2; };
  const auto leaf = scene(wall_tile(20, hole, 1));
  leaf->background_visible = false;
  make()->render(leaf, {}, frame_);
  const std::size_t middle = pixel_of(0.01, 0.01, kWallZ);
  EXPECT_NE(frame_.coverage[middle], Coverage::kBackground);
  EXPECT_NEAR(frame_.rgba[4 * middle], 128, 25);
  EXPECT_EQ(frame_.statistics.background_pixels, 0u);
  EXPECT_GT(frame_.statistics.void_pixels + frame_.statistics.crack_pixels, 0u);
}

TEST_P(FrameRendererTest, TheSkyIsTheSkyWhereItCanBeSeen) {
  auto leaf = scene(wall_tile(2.0, kNoHole, 1));
  auto renderer = make();
  renderer->render(leaf, {}, frame_);
  const std::size_t beside = pixel_of(4, 0, kWallZ);
  EXPECT_EQ(frame_.coverage[beside], Coverage::kBackground);
  EXPECT_EQ(frame_.rgba[4 * beside + 2], kSky.b);
  EXPECT_EQ(frame_.disparity[beside], 0.0f);
  // The same, where the leaf set says that no ray escapes: the wall's surface goes on.
  leaf = std::make_shared<LeafView>(*leaf);
  leaf->background_visible = false;
  renderer->render(leaf, {}, frame_);
  EXPECT_EQ(frame_.coverage[beside], Coverage::kVoidFilled);
  EXPECT_EQ(frame_.statistics.background_pixels, 0u);
}

TEST_P(FrameRendererTest, EdgesAreMixedWithFourSamplesAndWithOne) {
  auto leaf = scene(wall_tile(60, kNoHole, 1));
  leaf->chunks.push_back(board());
  const int white = linear_to_srgb(vertex_light({0, 0, 1}));
  for (const int samples : {1, 4}) {
    SCOPED_TRACE(samples);
    FrameOptions options;
    options.samples_per_pixel = samples;
    // Turned about the view axis, so that the board's edges cross pixels.
    make(options)->render(leaf, {{0, 0, 0}, glm::dquat(glm::dvec3(0, 0, 0.3))}, frame_);
    ASSERT_EQ(frame_.pixels(), 120u * 90);
    EXPECT_EQ(frame_.statistics.background_pixels, 0u);
    int between = 0;
    for (std::size_t p = 0; p < frame_.pixels(); ++p)
      between += frame_.rgba[4 * p + 2] > 100 && frame_.rgba[4 * p + 2] < white - 5;
    EXPECT_GT(between, 20);
    EXPECT_LT(between, 400);
  }
}

TEST_P(FrameRendererTest, FourSamplesAreChosenOnlyOnAGpu) {
  const auto leaf = scene(wall_tile(2.0, kNoHole, 1));
  const auto drawn_with = [&](int samples) {
    FrameOptions options;
    options.samples_per_pixel = samples;
    Frame frame;
    make(options)->render(leaf, {{0, 0, 0}, glm::dquat(glm::dvec3(0, 0, 0.3))}, frame);
    return frame.rgba;
  };
  const bool is_on_gpu = GetParam() == Renderer::kGl && !make()->abilities().is_software;
  EXPECT_NE(drawn_with(1), drawn_with(4));
  EXPECT_EQ(drawn_with(FrameOptions::kChosen), drawn_with(is_on_gpu ? 4 : 1));
}

TEST_P(FrameRendererTest, NoLeafSetYetIsTheBackground) {
  FrameOptions options;
  options.background = {1, 2, 3};
  make(options)->render(nullptr, {}, frame_);
  EXPECT_EQ(frame_.rgba[4 * 500 + 1], 2);
  EXPECT_EQ(frame_.statistics.background_pixels, frame_.pixels());
}

TEST_P(FrameRendererTest, Resizes) {
  auto renderer = make();
  const auto leaf = scene(wall_tile(20, kNoHole, 1));
  renderer->render(leaf, {}, frame_);
  ASSERT_TRUE(renderer->resize({64, 48, 1.0}));
  renderer->render(leaf, {}, frame_);
  EXPECT_EQ(frame_.pixels(), 64u * 48);
  EXPECT_FALSE(renderer->resize({0, 48, 1.0}));
  renderer->render(leaf, {}, frame_);
  EXPECT_EQ(frame_.pixels(), 64u * 48);
}

TEST_P(FrameRendererTest, ImpossibleSamplesAreOneClearLine) {
  FrameOptions options;
  options.samples_per_pixel = 3;
  const auto renderer = FrameRenderer::create(GetParam(), kDisplay, options);
  ASSERT_FALSE(renderer);
  EXPECT_EQ(renderer.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(renderer.error().message, "3 samples per pixel: 1 and 4 are possible");
}

TEST_P(FrameRendererTest, OneLeafSetFadesIntoTheNext) {
  // The board is in the second set only: its colour comes up frame by frame on the wall's.
  const auto first = scene(wall_tile(20, kNoHole, 1)), second = scene(wall_tile(20, kNoHole, 1));
  second->leaf.x = 7;
  second->chunks.push_back(board());
  auto renderer = make();
  const std::size_t on_board = 4 * pixel_of(0.4, 0.3, -1.5);
  const auto shown_at = [&](const std::shared_ptr<LeafView>& leaf, double time_s) {
    const FrameReport report = renderer->render(leaf, {}, frame_, time_s);
    EXPECT_EQ(report.times.former_ms > 0, report.drawn_share < 1);
    return int{frame_.rgba[on_board + 2]};
  };
  const int wall = shown_at(first, 0), middle = shown_at(second, 0.125), board_colour = shown_at(second, 0.3);
  ASSERT_GT(board_colour, wall + 50);
  EXPECT_NEAR(middle, (wall + board_colour) / 2, 1);
  EXPECT_EQ(shown_at(second, 0.4), board_colour);
  // Where nobody says what time it is, sets are shown at once.
  auto timeless = make();
  timeless->render(first, {}, frame_);
  timeless->render(second, {}, frame_);
  EXPECT_EQ(frame_.rgba[on_board + 2], board_colour);
}

INSTANTIATE_TEST_SUITE_P(Both, FrameRendererTest, testing::Values(Renderer::kCpu, Renderer::kGl),
                         [](const auto& info) { return info.param == Renderer::kCpu ? "Cpu" : "Gl"; });

TEST(FrameRendererUpload, WhatFadesStaysUploadedWhateverTheBudget) {
  FrameOptions options;
  options.impostors.budget_bytes = 1;
  auto renderer = FrameRenderer::create(Renderer::kGl, kDisplay, options);
  ASSERT_TRUE(renderer) << renderer.error().message;
  const auto first = scene(wall_tile(20, kNoHole, 1)), second = scene(wall_tile(20, kNoHole, 2));
  second->leaf.x = 7;
  Frame frame, alone;
  (*renderer)->render(first, {}, alone, 0);
  // Both show the same wall, so every mixture of them does: a tile that has gone would be sky.
  for (const double time_s : {0.01, 0.1, 0.2}) {
    EXPECT_LT((*renderer)->render(second, {}, frame, time_s).drawn_share, 1);
    EXPECT_EQ(frame.rgba, alone.rgba) << time_s;
  }
}

TEST(FrameRendererUpload, ThePreviousLeafSetStaysUntilTheNewOneIsUploaded) {
  FrameOptions options;
  options.frame_upload_bytes = 100'000;  // a fraction of a tile: one tile per frame
  auto renderer = FrameRenderer::create(Renderer::kGl, kDisplay, options);
  ASSERT_TRUE(renderer) << renderer.error().message;
  auto first = scene(wall_tile(20, kNoHole, 1)), second = scene(wall_tile(20, kNoHole, 2));
  second->leaf.x = 7;
  second->tiles.push_back(wall_tile(20, kNoHole, 3));
  second->tiles.push_back(wall_tile(20, kNoHole, 4));
  Frame frame;
  EXPECT_FALSE((*renderer)->render(first, {}, frame).is_previous_leaf);
  EXPECT_TRUE((*renderer)->render(second, {}, frame).is_previous_leaf);
  EXPECT_EQ(frame.statistics.background_pixels, 0u);
  EXPECT_TRUE((*renderer)->render(second, {}, frame).is_previous_leaf);
  const FrameReport report = (*renderer)->render(second, {}, frame);
  EXPECT_FALSE(report.is_previous_leaf);
  EXPECT_EQ(report.drawn, second);
  EXPECT_EQ(report.impostors.missing_tiles, 0u);
}

}  // namespace
}  // namespace farfield::client
