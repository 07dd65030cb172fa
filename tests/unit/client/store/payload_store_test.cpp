// SPDX-License-Identifier: Apache-2.0
#include "client/store/payload_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/store/made_leaf_sets.h"

namespace farfield::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

std::vector<ContentHash> gone_payloads(PayloadStore& store) {
  std::vector<ContentHash> keys;
  for (const PayloadStore::Gone& gone : store.take_gone()) keys.push_back(gone.payload);
  return keys;
}

TEST(PayloadStore, EvictsTheLeastRecentlyUsedUnpinned) {
  PayloadStore store(3000);
  for (const ContentHash key : {1, 2, 3}) store.insert(made::tile(key), false);
  store.set_pins({1});
  EXPECT_TRUE(store.make_room(1000));
  EXPECT_THAT(gone_payloads(store), ElementsAre(2));
  store.set_pins({});  // 1 was used after 3
  EXPECT_TRUE(store.make_room(2000));
  EXPECT_THAT(gone_payloads(store), ElementsAre(3));
  EXPECT_TRUE(store.contains(1));
  EXPECT_EQ(store.size_bytes(), 1000u);
}

TEST(PayloadStore, NeverEvictsWhatIsPinned) {
  PayloadStore store(2000);
  store.insert(made::tile(1), true);
  store.insert(made::tile(2), true);
  EXPECT_FALSE(store.make_room(1));
  EXPECT_THAT(gone_payloads(store), IsEmpty());
  store.erase(1);
  EXPECT_THAT(gone_payloads(store), ElementsAre(1));
  EXPECT_TRUE(store.make_room(1000));
}

TEST(PayloadStore, TextureLevelsGatherCoarsestFirstInWhateverOrderTheyCome) {
  PayloadStore store(1 << 20);
  store.insert(made::texture_level(5, 2, 4), false);
  const auto before = store.texture(5);
  store.insert(made::texture_level(5, 0, 16), false);
  store.insert(made::texture_level(5, 1, 8), false);
  const auto after = store.texture(5);
  ASSERT_EQ(after->levels.size(), 3u);
  EXPECT_EQ(after->levels[0].level, 2);
  EXPECT_EQ(after->levels[1].level, 1);
  EXPECT_EQ(after->levels[2].level, 0);
  EXPECT_NE(after->serial, before->serial);
  EXPECT_EQ(before->levels.size(), 1u) << "snapshots stay as they were";
  EXPECT_EQ(store.size_bytes(), 3 * sizeof(TextureLevel) + 4u * (16 + 64 + 256));
}

TEST(PayloadStore, DropsTheFinestLevelButNeverTheLast) {
  PayloadStore store(1 << 20);
  store.insert(made::texture_level(5, 1, 8), true);
  store.insert(made::texture_level(5, 0, 16), true);
  EXPECT_TRUE(store.drop_finest_level(5));
  EXPECT_THAT(gone_payloads(store), ElementsAre(500));
  EXPECT_EQ(store.texture(5)->levels.size(), 1u);
  EXPECT_FALSE(store.drop_finest_level(5));
  EXPECT_EQ(store.size_bytes(), sizeof(TextureLevel) + 4u * 64);
  store.erase(5);
  EXPECT_EQ(store.size_bytes(), 0u);
  EXPECT_THAT(gone_payloads(store), ElementsAre(501));
}

TEST(PayloadStore, HeldListsPayloadsNotItems) {
  PayloadStore store(1 << 20);
  store.insert(made::tile(1), false);
  store.insert(made::texture_level(5, 1, 8), true);
  store.insert(made::texture_level(5, 0, 16), true);
  EXPECT_THAT(store.held_payloads(10), UnorderedElementsAre(1, 500, 501));
  EXPECT_EQ(store.held_payloads(2).size(), 2u);
}

TEST(PayloadStore, OneNameForATextureAndATileKeepsTheFirst) {
  PayloadStore store(1 << 20);
  store.insert(made::texture_level(5, 1, 8), false);
  const std::size_t bytes = store.size_bytes();
  store.insert(made::tile(5), false);
  EXPECT_EQ(store.size_bytes(), bytes);
  EXPECT_EQ(store.tile(5), nullptr);
  store.insert(made::tile(6), false);
  store.insert(made::texture_level(6, 0, 4), false);
  EXPECT_EQ(store.texture(6), nullptr);
  store.erase(5);
  store.erase(6);
  EXPECT_EQ(store.size_bytes(), 0u);
}

}  // namespace
}  // namespace farfield::client
