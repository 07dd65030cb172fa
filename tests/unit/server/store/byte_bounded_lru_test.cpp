// SPDX-License-Identifier: Apache-2.0
#include "server/store/byte_bounded_lru.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace farfield {
namespace {

using Lru = ByteBoundedLru<int, std::string>;
constexpr std::size_t kOverhead = Lru::kEntryOverheadBytes;

TEST(ByteBoundedLru, ForgetsWhatWasUsedLongestAgo) {
  Lru lru(3 * (kOverhead + 10));
  for (int key : {1, 2, 3}) EXPECT_TRUE(lru.insert(key, std::to_string(key), 10));
  ASSERT_NE(lru.find(1), nullptr);  // now 2 is the oldest
  EXPECT_TRUE(lru.insert(4, "4", 10));
  EXPECT_EQ(lru.peek(2), nullptr);
  for (int key : {1, 3, 4}) EXPECT_NE(lru.peek(key), nullptr) << key;
  EXPECT_EQ(lru.evictions(), 1u);
}

TEST(ByteBoundedLru, APeekIsNoUse) {
  Lru lru(2 * (kOverhead + 10));
  lru.insert(1, "1", 10);
  lru.insert(2, "2", 10);
  EXPECT_NE(lru.peek(1), nullptr);
  lru.insert(3, "3", 10);
  EXPECT_EQ(lru.peek(1), nullptr);
  EXPECT_NE(lru.peek(2), nullptr);
}

TEST(ByteBoundedLru, CountsItsOwnOverhead) {
  Lru lru(10'000);
  lru.insert(1, "1", 100);
  EXPECT_EQ(lru.bytes(), 100 + kOverhead);
  EXPECT_GE(kOverhead, sizeof(int) * 2 + sizeof(std::string) + 4 * sizeof(void*));
}

TEST(ByteBoundedLru, WhatIsLargerThanTheBoundIsNotKeptAndEvictsNothing) {
  Lru lru(kOverhead + 100);
  EXPECT_TRUE(lru.insert(1, "1", 100));
  EXPECT_FALSE(lru.insert(2, "2", 101));
  EXPECT_EQ(lru.peek(2), nullptr);
  EXPECT_NE(lru.peek(1), nullptr);
  EXPECT_FALSE(lru.insert(3, "3", ~std::size_t{0}));  // no wrap-around
  EXPECT_FALSE(Lru(0).insert(1, "1", 0));
}

TEST(ByteBoundedLru, ReplacingAValueFreesTheOldOnesBytes) {
  Lru lru(kOverhead + 100);
  lru.insert(1, "old", 100);
  EXPECT_TRUE(lru.insert(1, "new", 50));
  EXPECT_EQ(*lru.find(1), "new");
  EXPECT_EQ(lru.bytes(), kOverhead + 50);
  EXPECT_EQ(lru.size(), 1u);
  EXPECT_EQ(lru.evictions(), 0u);
}

// Against a plain list that is searched from end to end.
TEST(ByteBoundedLru, AgreesWithASimpleModelOnRandomUse) {
  struct Entry {
    int key;
    std::size_t bytes;
  };
  std::mt19937 random(7);
  const std::size_t capacity = 5 * kOverhead + 700;
  Lru lru(capacity);
  std::vector<Entry> model;  // most recently used first
  for (int step = 0; step < 20'000; ++step) {
    const int key = static_cast<int>(random() % 12);
    const auto at = std::find_if(model.begin(), model.end(), [&](const Entry& e) { return e.key == key; });
    if (random() % 2) {
      EXPECT_EQ(lru.find(key) != nullptr, at != model.end());
      if (at != model.end()) std::rotate(model.begin(), at, at + 1);
    } else {
      const std::size_t bytes = random() % 400;
      lru.insert(key, "x", bytes);
      if (at != model.end()) model.erase(at);
      model.insert(model.begin(), {key, bytes + kOverhead});
      std::size_t used = 0;
      std::size_t fitting = 0;
      while (fitting < model.size() && used + model[fitting].bytes <= capacity) used += model[fitting++].bytes;
      model.resize(fitting);
      ASSERT_EQ(lru.bytes(), used);
    }
    ASSERT_EQ(lru.size(), model.size());
    ASSERT_LE(lru.bytes(), capacity);
  }
}

}  // namespace
}  // namespace farfield
