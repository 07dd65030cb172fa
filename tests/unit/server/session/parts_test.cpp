// SPDX-License-Identifier: Apache-2.0
// The small parts of sessions by themselves: held sets, rates, resume tokens, payload order.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <unordered_set>

#include "server/session/held_set.h"
#include "server/session/payload_order.h"
#include "server/session/resume_registry.h"
#include "server/access/token_bucket.h"
#include "tests/unit/server/session/fake_cell_service.h"

namespace farfield {
namespace {

using namespace std::chrono_literals;

TEST(HeldSet, ForgetsTheOldestBeyondItsBound) {
  HeldSet held(3);
  for (ContentHash key : {1, 2, 3}) held.insert(key);
  EXPECT_TRUE(held.erase(2));
  EXPECT_FALSE(held.erase(2));
  held.insert(4);
  held.insert(2);  // again, now the newest
  EXPECT_FALSE(held.contains(1));
  for (ContentHash key : {2, 3, 4}) EXPECT_TRUE(held.contains(key)) << key;
  held.insert(3);
  EXPECT_EQ(held.size(), 3u);
}

TEST(HeldSet, KnowsTheBytesOfWhatItHolds) {
  HeldSet held(2);
  held.insert(1, 10), held.insert(2);
  held.insert(1, 99);  // known already
  EXPECT_EQ(held.bytes(1), 10u);
  EXPECT_EQ(held.bytes(2), 0u) << "not told";
  held.insert(3, 30);
  EXPECT_EQ(held.bytes(1), 0u) << "forgotten";
  EXPECT_EQ(held.bytes(3), 30u);
}

TEST(HeldSet, StaysBoundedUnderChurn) {
  HeldSet held(100);
  for (ContentHash round = 0; round < 10000; ++round) {
    held.insert(round);
    held.erase(round);
    held.insert(round % 50);
  }
  EXPECT_LE(held.size(), 100u);
}

TEST(TokenBucket, LetsABurstThroughThenTheRate) {
  TokenBucket bucket(10);
  const auto start = TokenBucket::Clock::time_point(1h);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(bucket.take(start)) << i;
  EXPECT_FALSE(bucket.take(start));
  EXPECT_GT(bucket.wait(start), 99ms);
  EXPECT_LT(bucket.wait(start), 101ms);
  EXPECT_TRUE(bucket.take(start + bucket.wait(start)));
  int allowed = 0;
  for (int ms = 200; ms < 1200; ++ms) allowed += bucket.take(start + std::chrono::milliseconds(ms)) ? 1 : 0;
  EXPECT_NEAR(allowed, 10, 1);
}

TEST(ResumeRegistry, TokensAreSpentOnceAndExpire) {
  ResumeRegistry registry(10, 60s);
  const auto now = ResumeRegistry::Clock::now();
  const std::string token = registry.open(nullptr);
  EXPECT_EQ(token.size(), 16u);
  registry.update(token, ResumeState{"scene", {}, 7, nullptr});
  registry.close(token, now);
  const auto state = registry.claim(token, now + 59s);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->next_serial, 7u);
  EXPECT_FALSE(registry.claim(token, now));

  const std::string late = registry.open(nullptr);
  registry.close(late, now);
  EXPECT_FALSE(registry.claim(late, now + 61s));
  const std::string gone = registry.open(nullptr);
  registry.forget(gone);
  EXPECT_FALSE(registry.claim(gone, now));
}

TEST(ResumeRegistry, KeepsABoundedNumber) {
  ResumeRegistry registry(5, 60s);
  const auto now = ResumeRegistry::Clock::now();
  std::vector<std::string> tokens;
  for (int i = 0; i < 20; ++i) {
    tokens.push_back(registry.open(nullptr));
    registry.close(tokens.back(), now + std::chrono::seconds(i));
  }
  EXPECT_EQ(registry.size(), 5u);
  EXPECT_FALSE(registry.claim(tokens.front(), now));
  EXPECT_TRUE(registry.claim(tokens.back(), now));
}

TEST(PayloadKey, DependsOnSceneAndEveryPartOfTheName) {
  const TileId id{{2, 3, 4, 5}, 6, 1, 8, 9};
  std::unordered_set<ContentHash> keys{tile_payload_key(1, id), tile_payload_key(2, id)};
  for (int part = 0; part < 8; ++part) {
    TileId other = id;
    if (part == 0) ++other.cell.level;
    if (part == 1) ++other.cell.x;
    if (part == 2) ++other.cell.y;
    if (part == 3) ++other.cell.z;
    if (part == 4) ++other.view;
    if (part == 5) ++other.face;
    if (part == 6) ++other.x;
    if (part == 7) ++other.y;
    keys.insert(tile_payload_key(1, other));
  }
  EXPECT_EQ(keys.size(), 10u);
  // Written down: clients may keep payloads across restarts of the server.
  EXPECT_EQ(tile_payload_key(1, id), tile_payload_key(1, TileId{{2, 3, 4, 5}, 6, 1, 8, 9}));
}

TEST(PayloadOrder, ListsEveryPayloadOnceWhateverRepeats) {
  const test::FakeCellService service;
  LeafPlan plan = *service.plan_at({1, 1, 1});
  plan.chunks = {0, 1, 0, 1};
  plan.tiles.push_back(plan.tiles.front());
  std::unordered_set<ContentHash> keys;
  for (const PayloadItem& item : payload_order(service, plan)) EXPECT_TRUE(keys.insert(item.key).second);
  EXPECT_EQ(keys.size(), 16u);
}

TEST(PayloadOrder, WhatOtherLeavesShareComesBeforeWhatOnlyThisOneNeeds) {
  const test::FakeCellService service;
  LeafPlan plan = *service.plan_at({1, 1, 1});
  std::rotate(plan.tiles.begin(), plan.tiles.begin() + 2, plan.tiles.end());  // nearest shell first, as plans list them
  std::vector<int> levels;
  std::vector<float> shares;
  for (const PayloadItem& item : payload_order(service, plan)) {
    if (item.kind != PayloadItem::Kind::kTile) continue;
    levels.push_back(plan.tiles[item.index].id.cell.level);
    shares.push_back(plan.tiles[item.index].view_share);
  }
  EXPECT_EQ(levels, (std::vector<int>{5, 5, 0, 0, 0, 0}));
  EXPECT_TRUE(std::is_sorted(shares.begin() + 2, shares.end(), std::greater<>())) << "within a shell as planned";
}

TEST(PayloadOrder, AFallbackViewBringsItsTilesAndOnlyCoarseTextures) {
  const test::FakeCellService service;
  const LeafPlan plan = *service.fallback_at({1, 1, 1});
  std::string kinds;
  for (const PayloadItem& item : payload_order(service, plan)) kinds += "tcm"[static_cast<int>(item.kind)];
  EXPECT_EQ(kinds, "cmmmmmmmct");
}

}  // namespace
}  // namespace farfield
