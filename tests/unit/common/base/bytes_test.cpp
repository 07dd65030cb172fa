// SPDX-License-Identifier: Apache-2.0
#include "common/base/bytes.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace farfield {
namespace {

TEST(Bytes, ValuesComeBackAsTheyWent) {
  ByteWriter writer;
  writer.put<std::uint8_t>(0xab);
  writer.put<std::uint32_t>(0x01020304);
  writer.put<double>(-1.5);
  writer.put_bytes(Bytes{1, 2, 3});
  const Bytes bytes = writer.take();
  EXPECT_EQ(bytes.size(), 1u + 4 + 8 + 3);
  EXPECT_EQ(bytes[1], 4);  // little-endian
  ByteReader reader(bytes);
  EXPECT_EQ(reader.get<std::uint8_t>(), 0xab);
  EXPECT_EQ(reader.get<std::uint32_t>(), 0x01020304u);
  EXPECT_DOUBLE_EQ(reader.get<double>(), -1.5);
  const ByteView view = reader.get_bytes(3);
  EXPECT_EQ(Bytes(view.begin(), view.end()), (Bytes{1, 2, 3}));
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.remaining(), 0u);
}

TEST(Bytes, VarintsRoundTripAtEveryLength) {
  for (int bit = 0; bit < 64; ++bit) {
    for (const std::int64_t offset : {-1, 0, 1}) {
      const std::uint64_t value = (std::uint64_t{1} << bit) + static_cast<std::uint64_t>(offset);
      ByteWriter writer;
      writer.put_varint(value);
      writer.put_signed(static_cast<std::int64_t>(value));
      EXPECT_LE(writer.size(), 20u);
      ByteReader reader(writer.bytes());
      EXPECT_EQ(reader.get_varint(), value);
      EXPECT_EQ(reader.get_signed(), static_cast<std::int64_t>(value));
      EXPECT_TRUE(reader.ok());
      EXPECT_EQ(reader.remaining(), 0u);
    }
  }
}

TEST(Bytes, SmallMagnitudesAreShort) {
  for (const std::int64_t value : {0, 1, -1, 63, -64}) {
    ByteWriter writer;
    writer.put_signed(value);
    EXPECT_EQ(writer.size(), 1u) << value;
  }
  ByteWriter writer;
  writer.put_signed(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(writer.size(), 10u);
}

TEST(Bytes, EveryTruncationIsNoticedAndReadsZero) {
  ByteWriter writer;
  writer.put<std::uint16_t>(7);
  writer.put_varint(1'000'000);
  writer.put<std::uint64_t>(9);
  writer.put_bytes(Bytes(5, 1));
  const Bytes whole = writer.take();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    ByteReader reader(ByteView(whole).first(length));
    reader.get<std::uint16_t>();
    reader.get_varint();
    reader.get<std::uint64_t>();
    const ByteView tail = reader.get_bytes(5);
    EXPECT_FALSE(reader.ok()) << length;
    EXPECT_TRUE(tail.empty());
    EXPECT_EQ(reader.get<std::uint32_t>(), 0u);
    EXPECT_FALSE(reader.ok()) << "an error stays";
  }
}

TEST(Bytes, AVarintWithoutAnEndIsAnError) {
  ByteReader reader{ByteView()};
  EXPECT_EQ(reader.get_varint(), 0u);
  EXPECT_FALSE(reader.ok());
  const Bytes endless(11, 0xff);
  ByteReader overlong(endless);
  EXPECT_EQ(overlong.get_varint(), 0u);
  EXPECT_FALSE(overlong.ok());
}

TEST(Bytes, ALengthBeyondAnyBufferIsAnError) {
  const Bytes bytes(4);
  ByteReader reader(bytes);
  EXPECT_TRUE(reader.get_bytes(std::numeric_limits<std::size_t>::max()).empty());
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.remaining(), 0u);
}

}  // namespace
}  // namespace farfield
