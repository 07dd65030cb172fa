// SPDX-License-Identifier: Apache-2.0
#include "client/warp/block_culler.h"

#include <gtest/gtest.h>

#include <random>

#include "client/warp/cpu_warper.h"
#include "client/warp/splat_key.h"
#include "tests/unit/client/warp/near_layer.h"
#include "tests/unit/client/warp/warp_scene.h"

namespace farfield::client {
namespace {

constexpr int kEdge = 96;

/// Surfaces of many slopes with steps between them, some samples missing, cuts anywhere.
std::shared_ptr<DecodedTile> rough_tile(std::mt19937& random, float least, float most, bool with_pieces) {
  const auto uniform = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
  Tile tile;
  tile.edge_samples = face_samples(1);
  tile.id.face = kMinusZ;
  tile.width = tile.height = kTileSamples;
  for (int j = 0; j < kTileSamples; ++j) {
    for (int i = 0; i < kTileSamples; ++i) {
      const float slope_u = uniform(-1, 1) > 0.9f ? 0.02f : 0.001f;
      const int step = (i / 23 + j / 31) % 3;
      tile.disparity.push_back(least + (most - least) * (0.3f * static_cast<float>(step) + slope_u * static_cast<float>(i % 20)));
      tile.coverage.push_back(random() % 16 != 0);
      tile.cut_right.push_back(random() % 12 == 0 ? 1 + random() % 8 : 0);
      tile.cut_down.push_back(random() % 12 == 0 ? 1 + random() % 8 : 0);
      for (int c = 0; c < 3; ++c) tile.rgb.push_back(static_cast<std::uint8_t>(random()));
    }
  }
  auto decoded = std::make_shared<DecodedTile>();
  decoded->id = tile.id;
  tile.disparity_tolerance = 4e-4f;
  decoded->splats = build_splats(tile, with_pieces);
  return decoded;
}

int count(const VisibleBlocks& visible) {
  int sum = 0;
  for (const std::uint32_t row : visible) sum += __builtin_popcount(row);
  return sum;
}

class BlockCuller : public testing::Test {
 protected:
  VisibleBlocks find(const DecodedTile& tile, const Pose& eye, const PixelWindow& window) const {
    const glm::dmat3 pixels = pixels_from_directions(eye.world_from_camera, display);
    ShownDepths shown(window, keys.data());
    return find_visible_blocks(TileProjection::of(tile, eye.position, pixels), tile.splats, window, shown);
  }
  Display display = display_on_samples(kEdge, 80, 80);
  std::shared_ptr<DecodedTile> tile = plane_tile({0, 0, 0}, 1.0, 4.0, kEdge, [](double, double) { return 0xffu; });
  std::vector<std::uint64_t> keys = std::vector<std::uint64_t>(80 * 80, kNoSplat);
};

TEST_F(BlockCuller, DrawsWhatLandsInTheWindow) {
  ASSERT_EQ(tile->splats.blocks.edge, kEdge / SplatBlocks::kColumns);
  // 80 pixels in the middle of 96 samples, and a sample's reach: columns 1 to 14 of 16.
  EXPECT_EQ(count(find(*tile, Pose{}, {80, 0, 80})), 14 * 14);
  EXPECT_EQ(count(find(*tile, Pose{}, {80, 0, 6})), 14 * 2);
}

TEST_F(BlockCuller, LeavesOutWhatIsHidden) {
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 40; ++x) keys[static_cast<std::size_t>(y) * 80 + x] = near_key(0.26f, 0);
    for (int x = 40; x < 80; ++x) keys[static_cast<std::size_t>(y) * 80 + x] = near_key(0.24f, 0);
  }
  EXPECT_EQ(count(find(*tile, Pose{}, {80, 0, 80})), 8 * 14) << "columns from the seventh on reach the right half";
  keys[3 * 80 + 3] = kNoSplat;  // one pixel open is enough
  EXPECT_GT(count(find(*tile, Pose{}, {80, 0, 80})), 8 * 14);
}

TEST_F(BlockCuller, DrawsNothingBehindTheEyeAndAllThatIsTooCloseToTell) {
  Pose eye;
  eye.world_from_camera = glm::dquat(0, 0, 1, 0);  // half a turn about +Y
  EXPECT_EQ(count(find(*tile, eye, {80, 0, 80})), 0);
  eye = Pose{{0, 0, -4.0}, glm::angleAxis(1.5, glm::dvec3(1, 0, 0))};  // on the plane, along it
  EXPECT_GT(count(find(*tile, eye, {80, 0, 80})), 0);
}

TEST(BlockCulling, ChangesNoPixel) {
  std::mt19937 random(8);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  std::vector<std::shared_ptr<const DecodedTile>> tiles;
  for (int k = 0; k < 4; ++k) tiles.push_back(rough_tile(random, 0.3f - 0.07f * k, 0.45f - 0.07f * k, k % 2 == 0));
  ASSERT_GT(tiles[0]->splats.pieces.samples, 5000u);
  const LeafView leaf = leaf_of(tiles);
  Display display;
  display.width = 211, display.height = 133;
  for (int trial = 0; trial < 16; ++trial) {
    const Pose eye{{uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(trial % 4 == 0 ? -3 : -0.5, 0.5)},
                   glm::angleAxis(uniform(-1, 1), glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))))};
    display.fovy_rad = uniform(0.2, 2.2);
    std::vector<std::uint8_t> rgba(display.width * display.height * 4, 99);
    std::vector<float> depth(display.width * display.height, 0.0f);
    for (std::size_t k = 0; k < depth.size(); ++k) depth[k] = k / 37 % 3 == 0 ? 0.31f : 0.0f;
    const NearLayer near{display.width, display.height, rgba, depth, 1.0f};
    Frame culled, reference;
    CpuWarper({1, 2, ProjectionKernel::kVector}).draw(leaf, eye, display, &near, culled);
    CpuWarper({1, 2, ProjectionKernel::kScalar}).draw(leaf, eye, display, &near, reference);
    ASSERT_EQ(culled.rgba, reference.rgba) << trial;
    ASSERT_EQ(culled.disparity, reference.disparity) << trial;
    ASSERT_EQ(culled.coverage, reference.coverage) << trial;
  }
}

}  // namespace
}  // namespace farfield::client
