// SPDX-License-Identifier: Apache-2.0
#include "client/warp_gl/range_allocator.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace farfield::client {
namespace {

TEST(RangeAllocator, FreedNeighboursMerge) {
  RangeAllocator ranges(30);
  const auto a = ranges.allocate(10), b = ranges.allocate(10), c = ranges.allocate(10);
  ASSERT_TRUE(a && b && c);
  EXPECT_FALSE(ranges.allocate(1));
  ranges.release(*a, 10);
  ranges.release(*c, 10);
  EXPECT_FALSE(ranges.allocate(20));
  ranges.release(*b, 10);
  EXPECT_EQ(ranges.allocate(30), 0u);
}

TEST(RangeAllocator, TenantsNeverOverlap) {
  std::mt19937 random(7);
  RangeAllocator ranges(1000);
  std::vector<int> owner(1000, 0);
  struct Tenant {
    std::uint32_t first, count;
  };
  std::vector<Tenant> tenants;
  for (int step = 0; step < 5000; ++step) {
    if (random() % 2 == 0 || tenants.empty()) {
      const std::uint32_t count = 1 + random() % 60;
      const auto first = ranges.allocate(count);
      if (!first) continue;
      for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(owner.at(*first + i)++, 0);
      tenants.push_back({*first, count});
    } else {
      const std::size_t which = random() % tenants.size();
      for (std::uint32_t i = 0; i < tenants[which].count; ++i) --owner[tenants[which].first + i];
      ranges.release(tenants[which].first, tenants[which].count);
      tenants[which] = tenants.back();
      tenants.pop_back();
    }
  }
  for (const Tenant& t : tenants) ranges.release(t.first, t.count);
  EXPECT_EQ(ranges.free_units(), 1000u);
  EXPECT_EQ(ranges.allocate(1000), 0u);
}

}  // namespace
}  // namespace farfield::client
