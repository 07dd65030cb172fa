// SPDX-License-Identifier: Apache-2.0
// Impostors of a room with painted walls, whose every ray has a closed form, drawn from its own and from other eyes.
#include "client/warp_gl/impostor_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "client/gl/framebuffer.h"
#include "common/math/cube_face.h"
#include "common/shading/shading.h"

namespace farfield::client {
namespace {

constexpr double kNearPlane = 0.002;
constexpr double kSide = 2.0;
const glm::dvec3 kCentre(5e5 + 1, -2e6 + 1, 1);  // of the cell: nothing may depend on large floats
const Box kRoom{kCentre + glm::dvec3(-9, -7, -8), kCentre + glm::dvec3(8, 9, 10)};

glm::u8vec3 paint(const glm::dvec3& point) {
  const glm::dvec3 p = point - kCentre;
  const auto wave = [](double phase) { return static_cast<std::uint8_t>(128 + 90 * std::sin(phase)); };
  return {wave(0.6 * p.x + 0.3 * p.y), wave(0.5 * p.y - 0.4 * p.z), wave(0.7 * p.z + 0.2 * p.x + 1)};
}

/// What a tile of a view at `position` sees of the room.
Tile room_tile(const glm::dvec3& position, int face, int edge_tiles, int x, int y) {
  Tile tile;
  tile.id.face = static_cast<std::uint8_t>(face);
  tile.id.x = static_cast<std::uint8_t>(x), tile.id.y = static_cast<std::uint8_t>(y);
  tile.edge_samples = face_samples(edge_tiles);
  tile.width = tile.height = kTileSamples;
  const std::size_t count = tile.samples();
  tile.coverage.assign(count, 1), tile.cut_right.assign(count, 0), tile.cut_down.assign(count, 0);
  for (int row = 0; row < kTileSamples; ++row) {
    for (int column = 0; column < kTileSamples; ++column) {
      const glm::dvec3 direction =
          CubeFace::of(face).direction(sample_tangent(tile.edge_samples, x * kTileStride + column),
                                       sample_tangent(tile.edge_samples, y * kTileStride + row));
      const double z = exit_distance(kRoom, position, direction);
      tile.disparity.push_back(static_cast<float>(kSide / z));
      const glm::u8vec3 colour = paint(position + z * direction);
      for (int c = 0; c < 3; ++c) tile.rgb.push_back(colour[c]);
    }
  }
  return tile;
}

std::shared_ptr<DecodedTile> decoded(const Tile& tile, const glm::dvec3& position, float tolerance,
                                     std::uint64_t serial) {
  auto result = std::make_shared<DecodedTile>();
  result->id = tile.id, result->serial = serial;
  result->view_position = position, result->side_m = kSide;
  result->mesh = PackedMesh(build_depth_mesh(tile, tolerance));
  return result;
}

template <class Change>
void change_mesh(DecodedTile& tile, Change change) {
  DepthMesh mesh = tile.mesh.unpack();
  change(mesh);
  tile.mesh = PackedMesh(mesh);
}

class ImpostorRendererTest : public testing::Test {
 protected:
  void SetUp() override {
    auto context = GlContext::create_surfaceless();
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(*context);
    make_renderer({});
    leaf_.leaf_box = Box{kCentre, kCentre}.grown(kSide / 2);
    leaf_.near_region = leaf_.leaf_box.grown(2 * kSide);
  }
  void make_renderer(const ImpostorOptions& options) {
    auto renderer = ImpostorRenderer::create(context_->abilities(), options);
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::move(*renderer);
  }
  void add_room(int edge_tiles, float tolerance) {
    for (int face = 0; face < kCubeFaces; ++face) {
      for (int y = 0; y < edge_tiles; ++y) {
        for (int x = 0; x < edge_tiles; ++x) {
          leaf_.tiles.push_back(decoded(room_tile(kCentre, face, edge_tiles, x, y), kCentre, tolerance, ++serial_));
        }
      }
    }
  }
  ImpostorStatistics draw(const Display& display, const Pose& pose) {
    auto frame = Framebuffer::create(context_->abilities(), display.width, display.height, 1);
    EXPECT_TRUE(frame);
    frame->begin();
    const auto statistics = renderer_->draw(leaf_, ViewTransform::of(display, pose, kNearPlane));
    colour_.resize(4u * static_cast<std::size_t>(display.width * display.height));
    depth_.resize(colour_.size() / 4);
    frame->read_colour(colour_);
    frame->read_depth(depth_);
    return statistics;
  }
  /// Compares every pixel with the room itself. Returns: PSNR in dB.
  double compare_with_room(const Display& display, const Pose& pose, double depth_tolerance) {
    double squares = 0;
    for (int y = 0; y < display.height; ++y) {
      for (int x = 0; x < display.width; ++x) {
        const auto p = static_cast<std::size_t>(y * display.width + x);
        EXPECT_EQ(colour_[4 * p + 3], kImpostorAlpha) << "hole at " << x << ' ' << y;
        const glm::dvec3 ray = pose.world_from_camera * camera_direction(display, x + 0.5, y + 0.5);
        const double z = exit_distance(kRoom, pose.position, ray);
        EXPECT_NEAR(kNearPlane / depth_[p], z, depth_tolerance * z) << x << ' ' << y;
        const glm::u8vec3 expected = paint(pose.position + z * ray);
        for (int c = 0; c < 3; ++c) {
          const double d = double(expected[c]) - colour_[4 * p + static_cast<std::size_t>(c)];
          squares += d * d;
        }
      }
    }
    return 10 * std::log10(255.0 * 255 * 3 * display.width * display.height / squares);
  }

  std::unique_ptr<GlContext> context_;
  std::unique_ptr<ImpostorRenderer> renderer_;
  LeafView leaf_;
  std::uint64_t serial_ = 0;
  std::vector<std::uint8_t> colour_;
  std::vector<float> depth_;
};

TEST_F(ImpostorRendererTest, AViewFromItsOwnEyeGivesItself) {
  // One pixel per sample: the image of 126 pixels over 90 degrees has its centres at samples 1 … 126.
  const Tile tile = room_tile(kCentre, 5, 1, 0, 0);
  leaf_.tiles = {decoded(tile, kCentre, 0, 1)};
  EXPECT_TRUE(renderer_->upload(leaf_).is_complete);
  const Display display{126, 126, 1.5707963267948966};
  draw(display, {kCentre, {1, 0, 0, 0}});
  for (int y = 0; y < 126; ++y) {
    for (int x = 0; x < 126; ++x) {
      const auto p = static_cast<std::size_t>(y * 126 + x);
      const auto sample = static_cast<std::size_t>((126 - y) * kTileSamples + x + 1);  // v grows upwards
      EXPECT_NEAR(kNearPlane / depth_[p], kSide / tile.disparity[sample], 1e-4);
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(colour_[4 * p + c], tile.rgb[3 * sample + c], 1);
    }
  }
}

TEST_F(ImpostorRendererTest, TheRoomLooksRightFromAnywhereInTheCell) {
  add_room(2, 0);
  EXPECT_TRUE(renderer_->upload(leaf_).is_complete);
  const Display display{160, 120, 1.2};
  const Pose poses[] = {{kCentre, {1, 0, 0, 0}},
                        {kCentre + glm::dvec3(0.9, -0.8, 0.7), glm::dquat(glm::dvec3(0.3, 0.8, -0.2))},
                        {kCentre + glm::dvec3(-1, 1, 1), glm::dquat(glm::dvec3(-1.2, 2.5, 0.4))},
                        {kCentre + glm::dvec3(1, 1, -1), glm::dquat(glm::dvec3(1.5707963, 0, 0))}};
  for (const Pose& pose : poses) {
    draw(display, pose);
    // Between samples a quad across the room's edge cuts the corner: up to a sample's width of 1/126.
    EXPECT_GT(compare_with_room(display, pose, 0.02), 42.0);
  }
}

TEST_F(ImpostorRendererTest, VeryWideFieldsOfViewNeedNoSpecialCase) {
  add_room(1, 0);
  renderer_->upload(leaf_);
  const Display display{120, 120, 2.9};  // 166 degrees: triangles reach behind the camera
  const Pose pose{kCentre + glm::dvec3(0.5, 0.5, 0.9), glm::dquat(glm::dvec3(0.4, 0.7, 0))};
  draw(display, pose);
  EXPECT_GT(compare_with_room(display, pose, 0.04), 36.0);
}

TEST_F(ImpostorRendererTest, PlanarMergingChangesNothingVisible) {
  add_room(1, 1e-5f);
  renderer_->upload(leaf_);
  const Display display{160, 120, 1.2};
  const Pose pose{kCentre + glm::dvec3(0.9, -0.8, 0.7), glm::dquat(glm::dvec3(0.3, 0.8, -0.2))};
  const auto statistics = draw(display, pose);
  EXPECT_LT(statistics.triangles_held, 6u * 2 * 127 * 127 / 4);
  EXPECT_GT(compare_with_room(display, pose, 0.04), 40.0);
}

TEST_F(ImpostorRendererTest, InfinityIsDrawnWhereNothingIs) {
  Tile tile = room_tile(kCentre, 5, 1, 0, 0);
  tile.disparity.assign(tile.samples(), 0.0f);
  leaf_.tiles = {decoded(tile, kCentre, 0, 1)};
  renderer_->upload(leaf_);
  draw({32, 32, 1.0}, {kCentre + glm::dvec3(0.5, 0, 0), {1, 0, 0, 0}});
  const std::size_t p = 16 * 32 + 16;
  EXPECT_EQ(colour_[4 * p + 3], kImpostorAlpha);
  EXPECT_LT(depth_[p], 1e-20f);
  // A shifted eye does not move what is infinitely far: pixel (16, 16) is half a pixel off the axis.
  const double tangent = std::tan(0.5) / 32;
  const auto sample = [&](double u) { return static_cast<std::size_t>(std::lround(sample_index(128, u))); };
  const std::size_t s = sample(-tangent) * kTileSamples + sample(tangent);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(colour_[4 * p + c], tile.rgb[3 * s + c], 2);
}

TEST_F(ImpostorRendererTest, NearerShellsHideFartherOnes) {
  Tile near_tile = room_tile(kCentre, 5, 1, 0, 0), far_tile = near_tile;
  for (float& d : far_tile.disparity) d *= 0.5f;
  std::fill(far_tile.rgb.begin(), far_tile.rgb.end(), 0);
  far_tile.id.cell.level = 0, near_tile.id.cell.level = 1;  // drawn second
  leaf_.tiles = {decoded(far_tile, kCentre, 0, 1), decoded(near_tile, kCentre, 0, 2)};
  renderer_->upload(leaf_);
  draw({126, 126, 1.5707963267948966}, {kCentre, {1, 0, 0, 0}});
  for (std::size_t p = 0; p < 126u * 126; ++p) EXPECT_GT(colour_[4 * p] + colour_[4 * p + 1] + colour_[4 * p + 2], 60);
}

TEST_F(ImpostorRendererTest, WhatADeltaViewHoldsOfASurfaceShows) {
  const auto wall = [&](std::uint8_t view, glm::u8vec3 colour, float nearer) {
    Tile tile = room_tile(kCentre, 5, 1, 0, 0);
    for (std::size_t k = 0; k < tile.samples(); ++k) {
      tile.disparity[k] *= nearer;
      for (int c = 0; c < 3; ++c) tile.rgb[3 * k + static_cast<std::size_t>(c)] = colour[c];
    }
    auto result = decoded(tile, kCentre, 1e-5f, ++serial_);
    result->id.view = view;
    return result;
  };
  const Display display{64, 48, 1.0};
  // As coding leaves them: the intra view puts the wall a thousandth nearer, and then by more than that.
  for (const float nearer : {1.001f, 1.01f}) {
    leaf_.tiles = {wall(kIntraView, {255, 0, 0}, nearer), wall(3, {0, 255, 0}, 1.0f)};
    renderer_->upload(leaf_, std::size_t{1} << 30);
    draw(display, Pose{kCentre, {1, 0, 0, 0}});
    const bool delta_shows = nearer < 1.005f;
    for (std::size_t p = 0; p < depth_.size(); ++p) ASSERT_EQ(colour_[4 * p + 1] > 200, delta_shows) << nearer << " " << p;
  }
}

TEST_F(ImpostorRendererTest, TilesOutsideTheViewAreNotDrawn) {
  add_room(2, 0);
  renderer_->upload(leaf_);
  const auto statistics = draw({64, 64, 0.5}, {kCentre, {1, 0, 0, 0}});
  EXPECT_EQ(statistics.tiles_drawn, 4u);  // one face of six
  EXPECT_LE(statistics.draw_calls, 4u);  // unsimplified tiles fill a page each
  EXPECT_EQ(statistics.triangles_held, 24u * 2 * 127 * 127);
}

TEST_F(ImpostorRendererTest, UploadsWithinTheFramesBudget) {
  add_room(1, 0);
  int frames = 0;
  std::uint32_t missing = 6;
  while (!renderer_->upload(leaf_, 600'000).is_complete) {
    const auto statistics = draw({16, 16, 1.0}, {kCentre, {1, 0, 0, 0}});
    EXPECT_LT(statistics.missing_tiles, missing);
    missing = statistics.missing_tiles;
    ASSERT_LT(++frames, 10);
  }
  EXPECT_GE(frames, 2);
  EXPECT_EQ(draw({16, 16, 1.0}, {kCentre, {1, 0, 0, 0}}).missing_tiles, 0u);
}

TEST_F(ImpostorRendererTest, EvictsWhatNoFrameWantsBeforeANewSetTakesItsPlace) {
  const Display display{16, 16, 1.0};
  // Each tile's texture has another shape, so each needs a page of its own.
  const auto show = [&](int set) {
    leaf_.tiles.clear();
    for (int k = 0; k < 4; ++k) {
      auto tile = decoded(room_tile(kCentre, 5, 1, 0, 0), kCentre, 0, ++serial_);
      change_mesh(*tile, [&](DepthMesh& mesh) {
        mesh.width = 32 * (4 * set + k + 5);
        mesh.rgb.assign(3u * static_cast<std::size_t>(mesh.width * mesh.height), 100);
        mesh.cuts.assign(mesh.rgb.size() / 3, 0);
      });
      leaf_.tiles.push_back(tile);
    }
    EXPECT_TRUE(renderer_->upload(leaf_).is_complete);
  };
  show(0);
  const std::size_t one = renderer_->held_bytes();
  EXPECT_GT(one, std::size_t{4} << 20);
  make_renderer({2 * one});
  for (int set = 0; set < 5; ++set) {
    show(set);
    EXPECT_LE(renderer_->held_bytes(), 2 * one + one / 2) << "set " << set << ", still beside the one on the screen";
    EXPECT_EQ(draw(display, {kCentre, {1, 0, 0, 0}}).missing_tiles, 0u);
    EXPECT_LE(renderer_->held_bytes(), 2 * one);
  }
}

TEST_F(ImpostorRendererTest, SurfacesKeepTheirColourUpToWhereTheyEnd) {
  // Stripes and single samples of two paints: wherever two meet, each goes on to its own side of the cut.
  Tile tile = room_tile(kCentre, 5, 1, 0, 0);
  const auto is_white = [](int x, int y) { return y < 64 ? (x / 5 + y / 7) % 2 == 0 : x % 3 == 0 && y % 3 == 0; };
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * kTileSamples + static_cast<std::size_t>(x); };
  for (int y = 0; y < kTileSamples; ++y) {
    for (int x = 0; x < kTileSamples; ++x) {
      for (std::size_t c = 0; c < 3; ++c) tile.rgb[3 * at(x, y) + c] = is_white(x, y) ? 255 : 0;
      const auto cut = static_cast<std::uint8_t>(1 + (3 * x + 5 * y) % 8);
      if (x + 1 < kTileSamples && is_white(x, y) != is_white(x + 1, y)) tile.cut_right[at(x, y)] = cut;
      if (y + 1 < kTileSamples && is_white(x, y) != is_white(x, y + 1)) tile.cut_down[at(x, y)] = cut;
    }
  }
  leaf_.tiles.push_back(decoded(tile, kCentre, 0, ++serial_));
  EXPECT_TRUE(renderer_->upload(leaf_).is_complete);
  // Face 5 looks along -z: an upright camera sees it, several pixels to a sample.
  const Display display{640, 640, 0.9};
  draw(display, {kCentre, {1, 0, 0, 0}});
  int black = 0, white = 0, mixed = 0;
  for (std::size_t p = 0; p < depth_.size(); ++p) {
    if (colour_[4 * p + 3] != kImpostorAlpha) continue;
    const int value = colour_[4 * p];
    (value < 3 ? black : value > 252 ? white : mixed) += 1;
  }
  EXPECT_GT(black, 50000);
  EXPECT_GT(white, 50000);
  // Where three or four surfaces meet in one cell, the mesh's inner point is not on a line between two cuts.
  EXPECT_LT(mixed, (black + white) / 100);
}

TEST_F(ImpostorRendererTest, MeshesThatLieAreRefused) {
  auto bad_index = decoded(room_tile(kCentre, 5, 1, 0, 0), kCentre, 0, 1);
  change_mesh(*bad_index, [](DepthMesh& mesh) { mesh.indices[7] = 1u << 30; });
  auto bad_texture = decoded(room_tile(kCentre, 5, 1, 0, 0), kCentre, 0, 2);
  change_mesh(*bad_texture, [](DepthMesh& mesh) { mesh.rgb.resize(17); });
  leaf_.tiles = {bad_index, bad_texture};
  const auto upload = renderer_->upload(leaf_);
  EXPECT_EQ(upload.refused_tiles, 2u);
  EXPECT_EQ(draw({16, 16, 1.0}, {kCentre, {1, 0, 0, 0}}).triangles, 0u);
}

}  // namespace
}  // namespace farfield::client
