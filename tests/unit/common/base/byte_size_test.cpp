// SPDX-License-Identifier: Apache-2.0
#include "common/base/byte_size.h"

#include <gtest/gtest.h>

#include <vector>

namespace farfield {
namespace {

TEST(ByteSize, ReadsSizesAsPeopleWriteThem) {
  for (const auto& [text, bytes] : std::vector<std::pair<const char*, std::size_t>>{
           {"0", 0}, {"1000", 1000}, {"1B", 1}, {"4GiB", std::size_t{4} << 30}, {"4g", std::size_t{4} << 30},
           {"1.5KiB", 1536}, {"512MB", 512'000'000}, {"2tib", std::size_t{2} << 40}}) {
    const auto size = parse_byte_size(text);
    ASSERT_TRUE(size) << text;
    EXPECT_EQ(*size, bytes) << text;
  }
  for (const char* text : {"", "GiB", "-1", "4GiBs", "4 apples", "nan", "1e30GiB"}) EXPECT_FALSE(parse_byte_size(text)) << text;
}

}  // namespace
}  // namespace farfield
