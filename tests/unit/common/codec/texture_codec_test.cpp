// SPDX-License-Identifier: Apache-2.0
#include "common/codec/texture_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace farfield {
namespace {

TextureLevel picture(int width, int height, bool has_holes) {
  TextureLevel level{0xfeedfacecafebeefull, 2, 9, width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      level.rgba.push_back(static_cast<std::uint8_t>(128 + 100 * std::sin(x * 0.2)));
      level.rgba.push_back(static_cast<std::uint8_t>(128 + 100 * std::cos(y * 0.15)));
      level.rgba.push_back(static_cast<std::uint8_t>((x + y) % 256));
      level.rgba.push_back(has_holes && (x / 4 + y / 4) % 2 ? static_cast<std::uint8_t>(x) : 255);
    }
  return level;
}

TEST(TextureCodec, KeepsTheHeaderTheAlphaAndNearlyTheColour) {
  for (const bool has_holes : {false, true})
    for (const auto& [width, height] : {std::pair{64, 48}, {100, 17}, {15, 40}, {1, 1}, {3, 500}, {300, 270}}) {
      const TextureLevel level = picture(width, height, has_holes);
      const auto decoded = decode_texture_level(encode_texture_level(level));
      ASSERT_TRUE(decoded) << decoded.error().message;
      EXPECT_EQ(decoded->texture, level.texture);
      EXPECT_EQ(decoded->level, 2);
      EXPECT_EQ(decoded->level_count, 9);
      ASSERT_EQ(decoded->width, width);
      ASSERT_EQ(decoded->height, height);
      ASSERT_EQ(decoded->rgba.size(), level.rgba.size());
      double squares = 0;
      for (std::size_t i = 0; i < level.rgba.size(); ++i) {
        const int error = decoded->rgba[i] - level.rgba[i];
        if (i % 4 == 3) {
          EXPECT_EQ(error, 0) << "alpha";
        }
        squares += error * error;
      }
      const double rms = std::sqrt(squares / static_cast<double>(level.rgba.size()));
      EXPECT_LT(rms, std::min(width, height) < 16 ? 1e-9 
: 2.0) << "small levels are lossless";
    }
}

TEST(TextureCodec, AnyTruncationIsAnError) {
  for (const TextureLevel& level :
       {picture(32, 32, true), picture(32, 20, false), picture(8, 8, false), picture(8, 8, true)}) {
    const Bytes bytes = encode_texture_level(level);
    for (std::size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FALSE(decode_texture_level(ByteView(bytes).first(size))) << size << " of " << bytes.size();
  }
}

TEST(TextureCodec, DamagedBytesGiveAPictureOfTheStatedSizeOrAnError) {
  const Bytes bytes = encode_texture_level(picture(32, 32, true));
  std::mt19937 random(3);
  for (int round = 0; round < 5000; ++round) {
    Bytes damaged = bytes;
    damaged[random() % (round % 2 ? damaged.size() : 60)] = static_cast<std::uint8_t>(random());
    const auto decoded = decode_texture_level(damaged);
    if (!decoded) continue;
    ASSERT_EQ(decoded->rgba.size(),
              std::size_t{4} * static_cast<std::size_t>(decoded->width) * static_cast<std::size_t>(decoded->height));
  }
}

TEST(TextureCodec, RefusesEdgesBeyondTheLimitBeforeLookingAtThePicture) {
  Bytes bytes = encode_texture_level(picture(32, 32, false));
  bytes[13] = 0x10, bytes[12] = 0x01;  // width 4097, little-endian at offset 12
  const auto decoded = decode_texture_level(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::kLimitExceeded);
}

TEST(TextureCodec, RefusesAPictureOfOtherPanels) {
  Bytes bytes = encode_texture_level(picture(32, 32, false));
  bytes[13] = 0x02;  // width 512 + 32: three panels, one came
  EXPECT_FALSE(decode_texture_level(bytes));
  Bytes longer = encode_texture_level(picture(300, 20, false));
  longer[13] = 0, longer[12] = 20;  // one, two came
  EXPECT_FALSE(decode_texture_level(longer));
}

// JPEG's colour differences, rounded to whole codes, would be off by more than half a code all over.
TEST(TextureCodec, TintsNothing) {
  for (const glm::u8vec3 colour : {glm::u8vec3(171, 168, 160), glm::u8vec3(93, 97, 90), glm::u8vec3(200, 41, 33)}) {
    TextureLevel level{1, 0, 1, 64, 64, {}};
    std::mt19937 random(5);
    for (int i = 0; i < 64 * 64; ++i) {
      const int noise = static_cast<int>(random() % 9) - 4;
      for (int c = 0; c < 3; ++c) level.rgba.push_back(static_cast<std::uint8_t>(colour[c] + noise));
      level.rgba.push_back(255);
    }
    const auto decoded = decode_texture_level(encode_texture_level(level));
    ASSERT_TRUE(decoded);
    double bias[3] = {};
    for (std::size_t i = 0; i < level.rgba.size(); ++i)
      if (i % 4 < 3) bias[i % 4] += (decoded->rgba[i] - level.rgba[i]) / (64.0 * 64.0);
    for (const double off : bias) EXPECT_LT(std::abs(off), 0.2);
  }
}

}  // namespace
}  // namespace farfield
