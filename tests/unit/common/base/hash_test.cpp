// SPDX-License-Identifier: Apache-2.0
#include "common/base/hash.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace farfield {
namespace {

ByteView view_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Published values of XXH3, 64 bits: hashes name what clients keep across versions, so they must never change.
TEST(Hash, IsTheStandardXxh3) {
  EXPECT_EQ(hash_bytes({}), 0x2d06800538d394c2ull);
  EXPECT_EQ(hash_bytes(view_of("a")), 0xe6c632b61e964e1full);
}

TEST(Hash, EveryByteLengthAndSeedCounts) {
  Bytes bytes(300, 0);
  std::set<ContentHash> seen;
  for (std::size_t length = 0; length <= bytes.size(); ++length) seen.insert(hash_bytes(ByteView(bytes).first(length)));
  EXPECT_EQ(seen.size(), 301u);
  const ContentHash plain = hash_bytes(bytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] ^= 1;
    EXPECT_NE(hash_bytes(bytes), plain) << i;
    bytes[i] ^= 1;
  }
  EXPECT_NE(hash_bytes(bytes, 1), plain);
}

TEST(Hash, ValuesHashAsTheirBytes) {
  const std::array<std::uint16_t, 2> values{0x0201, 0x0403};
  EXPECT_EQ(hash_values(std::span<const std::uint16_t>(values)), hash_bytes(Bytes{1, 2, 3, 4}));
  EXPECT_EQ(hash_value(std::uint16_t{0x0201}), hash_bytes(Bytes{1, 2}));
}

}  // namespace
}  // namespace farfield
