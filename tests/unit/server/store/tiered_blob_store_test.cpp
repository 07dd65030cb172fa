// SPDX-License-Identifier: Apache-2.0
#include "server/store/tiered_blob_store.h"

#include <gtest/gtest.h>

#include <unordered_map>

namespace farfield {
namespace {

BlobKey key_of(int k) { return {.world = 1, .name = {.cell = {.level = 1, .x = k}}}; }
SharedBytes blob_of(int k) { return std::make_shared<const Bytes>(Bytes(10, static_cast<std::uint8_t>(k))); }

struct MapStore : BlobStore {
  SharedBytes find(const BlobKey& key) override { return ++asked, blobs.contains(key) ? blobs[key] : nullptr; }
  void insert(const BlobKey& key, SharedBytes bytes) override { blobs[key] = std::move(bytes); }
  Status flush() override { return {}; }
  BlobStoreStatistics statistics() const override { return {.hits = 1, .misses = static_cast<std::uint64_t>(asked) - 1}; }
  std::unordered_map<BlobKey, SharedBytes> blobs;
  int asked = 0;
};

TEST(TieredBlobStore, CopiesToTheFrontWhatTheBackHolds) {
  const auto front = std::make_shared<MapStore>(), back = std::make_shared<MapStore>();
  TieredBlobStore tiers(front, back);
  tiers.insert(key_of(1), blob_of(1));
  EXPECT_EQ(front->blobs.size(), 1u);
  EXPECT_EQ(back->blobs.size(), 1u);
  back->insert(key_of(2), blob_of(2));
  EXPECT_EQ(*tiers.find(key_of(2)), *blob_of(2));
  EXPECT_EQ(back->asked, 1);
  EXPECT_EQ(*tiers.find(key_of(2)), *blob_of(2));
  EXPECT_EQ(back->asked, 1) << "from the front by now";
  EXPECT_FALSE(tiers.find(key_of(3)));
  EXPECT_EQ(tiers.tiers().size(), 2u);
  EXPECT_EQ(tiers.statistics().hits, 2u);
}

}  // namespace
}  // namespace farfield
