// SPDX-License-Identifier: Apache-2.0
#include "server/schedule/transition_table.h"

#include <gtest/gtest.h>

#include "server/schedule/likely_ways.h"

namespace farfield {
namespace {

CellId leaf(int x, int z = 0) { return {.level = 1, .x = x, .z = z}; }

TEST(TransitionTable, RemembersTheWayByWhereOneCameFrom) {
  TransitionTable table;
  for (int n = 0; n < 9; ++n) table.note(leaf(0), leaf(1), leaf(2), {4, 0, 0}), table.note(leaf(2), leaf(1), leaf(0), {2, 0, 0});
  const Departures onwards = table.from(leaf(0), leaf(1));
  EXPECT_EQ(onwards.seen, 9u);
  ASSERT_EQ(onwards.next.size(), 1u);
  EXPECT_EQ(onwards.next[0].leaf, leaf(2));
  EXPECT_DOUBLE_EQ(onwards.next[0].probability, 0.9) << "one more might go elsewhere";
  const Departures from_anywhere = table.from(std::nullopt, leaf(1));
  EXPECT_EQ(from_anywhere.seen, 18u);
  EXPECT_EQ(from_anywhere.next.size(), 2u);
  EXPECT_EQ(table.from(leaf(7), leaf(1)).seen, 18u) << "nobody came that way: all who were here";
  EXPECT_EQ(table.from(leaf(7), leaf(9)).seen, 0u);
}

TEST(TransitionTable, IsWrittenAndRead) {
  TransitionTable table, again;
  table.note(leaf(0), leaf(1), leaf(2), {4, 1.5, 0}), table.note(std::nullopt, leaf(5), leaf(6), {1, 2, 3});
  ASSERT_TRUE(again.read(table.write()));
  EXPECT_EQ(again.noted(), 0u);
  EXPECT_EQ(again.from(leaf(0), leaf(1)).next.at(0).entry, glm::dvec3(4, 1.5, 0));
  EXPECT_EQ(again.from(std::nullopt, leaf(5)).next.at(0).leaf, leaf(6));
  const Bytes bytes = table.write();
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    TransitionTable damaged;
    // Cut between two rows it is a shorter table.
    if (!damaged.read(ByteView(bytes).first(size))) EXPECT_EQ(damaged.from(leaf(0), leaf(1)).seen, 0u);
  }
  Bytes wrong = bytes;
  wrong[1] = 77;  // a level that does not exist
  EXPECT_FALSE(again.read(wrong));
  EXPECT_EQ(again.from(leaf(0), leaf(1)).seen, 1u) << "what was there stays";
}

TEST(TransitionTable, IsBoundedAndKeepsWhatIsUsed) {
  TransitionTable table(100);
  for (int n = 0; n < 50; ++n) table.note(leaf(0), leaf(1), leaf(2), {0, 0, 0});
  for (int x = 10; x < 2000; ++x) table.note(std::nullopt, leaf(x), leaf(x + 1), {0, 0, 0});
  EXPECT_EQ(table.from(leaf(0), leaf(1)).seen, 50u);
  EXPECT_LT(table.write().size(), 110u * 100u);
}

TEST(TransitionTable, NewHabitsReplaceOldOnes) {
  TransitionTable table;
  for (int n = 0; n < 200'000; ++n) table.note(std::nullopt, leaf(1), leaf(2), {0, 0, 0});
  for (int n = 0; n < 200'000; ++n) table.note(std::nullopt, leaf(1), leaf(3), {0, 0, 0});
  EXPECT_EQ(table.from(std::nullopt, leaf(1)).next.at(0).leaf, leaf(3));
  EXPECT_GT(table.from(std::nullopt, leaf(1)).next.at(0).probability, 0.8);
}

// ── what they say about a straight path: finest cells of 1 m, leaves of 2 m ──

struct LikelyWaysTest : testing::Test {
  LikelyWays ways() {
    return LikelyWays(grid, std::nullopt, here, [this](const auto& previous, const CellId& from) { return table.from(previous, from); });
  }
  /// One metre apart along x.
  std::vector<PrefetchTarget> ahead() const {
    std::vector<PrefetchTarget> targets;
    for (int n = 1; n < 6; ++n) targets.push_back({from + glm::dvec3(n, 0, 0), static_cast<double>(n), 0.1});
    return targets;
  }
  CellId leaf_at(const glm::dvec3& place) const { return grid.cell_at(place, 1); }
  void walk(int times, const glm::dvec3& to) {
    for (int n = 0; n < times; ++n) table.note(std::nullopt, here, leaf_at(to), to);
  }
  CellGrid grid{1.0};
  TransitionTable table;
  glm::dvec3 from{0.5, 0.5, 0.5};
  CellId here = grid.cell_at(from, 1);
};

TEST_F(LikelyWaysTest, WhereNobodyWasTheStraightPathIsAllThereIs) {
  EXPECT_EQ(ways().weighed(ahead(), from, 1).size(), 5u);
  walk(3, from + glm::dvec3(0, 0, 2));
  EXPECT_GE(ways().weighed(ahead(), from, 1).size(), 5u) << "three viewers are not enough to say that nobody goes straight on";
}

TEST_F(LikelyWaysTest, WhereEverybodyTurnedTheTurnIsPreparedAndTheRestIsNot) {
  const glm::dvec3 turn = from + glm::dvec3(0, 0, 2);
  walk(20, turn);
  const auto targets = ways().weighed(ahead(), from, 2);
  ASSERT_FALSE(targets.empty());
  bool has_turn = false;
  for (const PrefetchTarget& target : targets) {
    const bool is_here = grid.box(here).contains(target.viewpoint);
    EXPECT_TRUE(is_here || leaf_at(target.viewpoint) == leaf_at(turn));
    if (is_here) continue;
    has_turn = true;
    EXPECT_DOUBLE_EQ(target.seconds_until_needed, 1.0) << "2 m at 2 m/s";
  }
  EXPECT_TRUE(has_turn);
}

TEST_F(LikelyWaysTest, AFewWhoWentStraightOnKeepTheStraightPath) {
  walk(20, from + glm::dvec3(0, 0, 2)), walk(1, from + glm::dvec3(2, 0, 0));
  const auto targets = ways().weighed(ahead(), from, 1);
  bool has_straight = false;
  for (const PrefetchTarget& target : targets) has_straight = has_straight || leaf_at(target.viewpoint) == leaf_at(from + glm::dvec3(2, 0, 0));
  EXPECT_TRUE(has_straight);
  for (std::size_t n = 1; n < targets.size(); ++n) EXPECT_LE(targets[n - 1].seconds_until_needed, targets[n].seconds_until_needed);
}

}  // namespace
}  // namespace farfield
