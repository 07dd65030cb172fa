// SPDX-License-Identifier: Apache-2.0
#include "common/base/memory_image.h"

#include <gtest/gtest.h>

#include <numeric>

namespace farfield {
namespace {

struct Written {
  Bytes bytes;
  ContentHash hash = 0;
};

Written written(const std::vector<std::uint32_t>& values) {
  Written result;
  MemoryImageWriter out([&](ByteView block) { result.bytes.insert(result.bytes.end(), block.begin(), block.end()); });
  out.put<std::int16_t>(-5);
  out.put_text("a name");
  out.put_array(values);
  out.put_texts({"one", "", "three"});
  out.flush();
  result.hash = out.hash();
  return result;
}

TEST(MemoryImage, WhatIsWrittenInManyBlocksIsReadBack) {
  std::vector<std::uint32_t> values(3 * kMemoryImageBlock / sizeof(std::uint32_t) + 17);
  std::iota(values.begin(), values.end(), 1000u);
  const Written image = written(values);
  EXPECT_EQ(memory_image_hash(image.bytes), image.hash);
  MemoryImageReader in(image.bytes);
  EXPECT_EQ(in.get<std::int16_t>(), -5);
  EXPECT_EQ(in.get_text(), "a name");
  EXPECT_EQ(in.get_array<std::uint32_t>(), values);
  EXPECT_EQ(in.get_texts(), (std::vector<std::string>{"one", "", "three"}));
  EXPECT_TRUE(in.is_valid() && in.is_at_end());
}

TEST(MemoryImage, OneChangedBitChangesTheHash) {
  Written image = written({1, 2, 3});
  image.bytes[20] ^= 4;
  EXPECT_NE(memory_image_hash(image.bytes), image.hash);
}

TEST(MemoryImage, CutAnywhereItIsInvalidAndTakesNoMemory) {
  const Bytes bytes = written(std::vector<std::uint32_t>(50, 7)).bytes;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    MemoryImageReader in(ByteView(bytes).first(size));
    in.get<std::int16_t>();
    in.get_text();
    EXPECT_LE(in.get_array<std::uint32_t>().size(), 50u);
    in.get_texts();
    EXPECT_FALSE(in.is_valid()) << size;
  }
}

TEST(MemoryImage, ACountBeyondTheRestIsRefused) {
  Bytes bytes(16, 0xff);
  MemoryImageReader in(bytes);
  EXPECT_TRUE(in.get_array<double>().empty());
  EXPECT_FALSE(in.is_valid());
}

}  // namespace
}  // namespace farfield
