// SPDX-License-Identifier: Apache-2.0
#include "common/base/duration.h"

#include <gtest/gtest.h>

#include <vector>

namespace farfield {
namespace {

TEST(Duration, ReadsTimesAsPeopleWriteThem) {
  for (const auto& [text, seconds] : std::vector<std::pair<const char*, int>>{
           {"1", 1}, {"90s", 90}, {"15min", 900}, {"2m", 120}, {"1.5h", 5400}, {"7d", 604800}}) {
    const auto duration = parse_duration(text);
    ASSERT_TRUE(duration) << text;
    EXPECT_EQ(duration->count(), seconds) << text;
  }
  for (const char* text : {"", "d", "-1s", "0", "0.1s", "7 days", "nan", "1e9d"}) EXPECT_FALSE(parse_duration(text)) << text;
}

}  // namespace
}  // namespace farfield
