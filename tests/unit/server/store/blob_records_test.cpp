// SPDX-License-Identifier: Apache-2.0
#include "server/store/blob_records.h"

#include <gtest/gtest.h>

#include <random>

namespace farfield {
namespace {

constexpr std::size_t kChunks = 1000;

LeafPlan plan_of(int tiles, bool is_divided) {
  LeafPlan plan;
  plan.leaf = {.level = 3, .x = -5, .y = 7, .z = 123456};
  plan.root = {.level = 9, .x = 1, .y = 2, .z = 3};
  plan.near_triangles = 54321;
  plan.background_visible = true;
  plan.sky.insert(glm::dvec3(0.2, 1, -0.4));
  plan.delta_views = is_divided ? 4 : -1;
  for (int k = 0; k < tiles; ++k) {
    const TileId id{.cell = plan.leaf.ancestor(3 + k % 4), .view = static_cast<std::uint8_t>(k % 5), .face = static_cast<std::uint8_t>(k % 6), .x = 3, .y = 11};
    plan.tiles.push_back({id, 0.25f / static_cast<float>(k + 1)});
  }
  plan.chunks = {7, 0, 999, 300};
  if (is_divided) {
    EnclosureMaskWriter mask;
    mask.divide();
    for (int child = 0; child < 8; ++child) mask.fill(child % 2 == 0);
    LeafPlan part = plan_of(3, false);
    part.enclosure = EnclosureMask::from_bytes(mask.take()).value();
    plan.enclosures.push_back(std::make_shared<const LeafPlan>(part));
  }
  return plan;
}

void expect_same(const LeafPlan& a, const LeafPlan& b) {
  EXPECT_EQ(a.leaf, b.leaf);
  EXPECT_EQ(a.root, b.root);
  EXPECT_EQ(a.near_triangles, b.near_triangles);
  EXPECT_EQ(a.exceeds_budget, b.exceeds_budget);
  EXPECT_EQ(a.background_visible, b.background_visible);
  EXPECT_TRUE(std::equal(a.sky.bytes().begin(), a.sky.bytes().end(), b.sky.bytes().begin()));
  EXPECT_EQ(a.delta_views, b.delta_views);
  EXPECT_EQ(a.chunks, b.chunks);
  EXPECT_EQ(a.enclosure, b.enclosure);
  ASSERT_EQ(a.tiles.size(), b.tiles.size());
  for (std::size_t k = 0; k < a.tiles.size(); ++k) {
    EXPECT_EQ(a.tiles[k].id, b.tiles[k].id);
    EXPECT_EQ(hash_value(a.tiles[k].view_share), hash_value(b.tiles[k].view_share));
  }
  ASSERT_EQ(a.enclosures.size(), b.enclosures.size());
  for (std::size_t k = 0; k < a.enclosures.size(); ++k) expect_same(*a.enclosures[k], *b.enclosures[k]);
}

EncodedTile tile_of(std::size_t bytes) {
  EncodedTile tile;
  Bytes encoded(bytes, 0x5a);
  tile.hash = bytes > 0 ? hash_bytes(encoded) : 0;
  tile.bytes = std::make_shared<const Bytes>(std::move(encoded));
  tile.covered_samples = 11, tile.colour_bytes = 22, tile.disparity_bytes = 33, tile.other_bytes = 44, tile.rays = 55;
  return tile;
}

TEST(BlobRecords, PlansComeBackAsTheyWere) {
  for (const bool is_divided : {false, true}) {
    const LeafPlan plan = plan_of(300, is_divided);
    const auto read = read_plan_record(write_plan_record(plan), kChunks);
    ASSERT_TRUE(read) << read.error().message;
    expect_same(plan, **read);
  }
}

TEST(BlobRecords, TilesComeBackAsTheyWereEmptyOnesToo) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{5000}}) {
    const EncodedTile tile = tile_of(size);
    const auto read = read_tile_record(write_tile_record(tile));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*(*read)->bytes, *tile.bytes);
    EXPECT_EQ((*read)->hash, tile.hash);
    EXPECT_EQ((*read)->covered_samples, 11u);
    EXPECT_EQ((*read)->other_bytes, 44u);
    EXPECT_EQ((*read)->rays, 55u);
  }
}

TEST(BlobRecords, LeafNamesComeBackAsTheyWere) {
  const LeafName name{{.level = 2, .x = 1, .y = -2, .z = 3}, true};
  const auto read = read_leaf_name_record(write_leaf_name_record(name));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->leaf, name.leaf);
  EXPECT_TRUE(read->is_blocked);
}

TEST(BlobRecords, APlanOfAnotherSceneIsRefused) {
  EXPECT_FALSE(read_plan_record(write_plan_record(plan_of(5, false)), 999)) << "chunk 999 of 999";
}

TEST(BlobRecords, OtherVersionsAreRefused) {
  Bytes record = write_tile_record(tile_of(10));
  record[0] ^= 0x40;
  EXPECT_FALSE(read_tile_record(record));
}

TEST(BlobRecords, AnyBytesAreAValueOrAnError) {
  const Bytes whole = write_plan_record(plan_of(40, true));
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_FALSE(read_plan_record(ByteView(whole).first(size), kChunks)) << size;
  std::mt19937 random(7);
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes = whole;
    for (int k = 0; k < 1 + round % 8; ++k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(random() % (bytes.size() + 1));
    bytes.empty() ? void() : void(bytes[0] = 1);
    (void)read_plan_record(bytes, kChunks);
    (void)read_tile_record(bytes);
    (void)read_leaf_name_record(bytes);
  }
}

}  // namespace
}  // namespace farfield
