// SPDX-License-Identifier: Apache-2.0
#include "server/model/texture_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "server/model/row_reducer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/small_jpeg.h"

namespace farfield {
namespace {

TextureImage noise(int width, int height, bool has_alpha) {
  std::mt19937 random(5);
  TextureImage image{.width = width, .height = height};
  for (int i = 0; i < width * height; ++i) {
    for (int c = 0; c < 3; ++c) image.rgba.push_back(static_cast<std::uint8_t>(random()));
    image.rgba.push_back(has_alpha ? static_cast<std::uint8_t>(random()) : 255);
  }
  return image;
}

Bytes jpeg_of(int width, int height, std::uint8_t level) {
  return test::small_jpeg(std::vector<std::uint8_t>(static_cast<std::size_t>(4 * width * height), level), width, height, 75);
}

TEST(TextureFile, PngComesBackExactly) {
  for (const bool has_alpha : {false, true}) {
    const TextureImage image = noise(37, 11, has_alpha);
    const Result<Bytes> png = encode_png(image);
    ASSERT_TRUE(png);
    const Result<TextureImage> back = decode_texture(*png);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->width, 37);
    EXPECT_EQ(back->height, 11);
    EXPECT_EQ(back->rgba, image.rgba);
  }
}

TEST(TextureFile, ReadsJpeg) {
  const Result<TextureImage> image = decode_texture(jpeg_of(33, 9, 100));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, 33);
  ASSERT_EQ(image->rgba.size(), 33u * 9 * 4);
  EXPECT_NEAR(image->rgba[0], 100, 2);
  EXPECT_EQ(image->rgba[3], 255);
}

TEST(TextureFile, EveryTruncationOfAPngIsAnError) {
  const Bytes png = encode_png(noise(16, 16, true)).value();
  for (std::size_t size = 0; size + 12 < png.size(); ++size) {  // the last 12 bytes only mark the end
    EXPECT_FALSE(decode_texture(ByteView(png).first(size))) << size;
  }
}

TEST(TextureFile, DamageNeverDoesHarm) {
  std::mt19937 random(11);
  for (const Bytes& original : {encode_png(noise(24, 24, true)).value(), jpeg_of(24, 24, 50)}) {
    for (int round = 0; round < 500; ++round) {
      Bytes damaged = original;
      for (int k = 0; k < 4; ++k) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      const Result<TextureImage> image = decode_texture(damaged);
      if (!image) continue;
      EXPECT_LE(image->width, kMaxTextureFileEdge);
      EXPECT_EQ(image->rgba.size(),
                std::size_t{4} * static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height));
    }
  }
}

TEST(TextureFile, AHeaderThatClaimsAGiantIsRefused) {
  Bytes png = encode_png(noise(4, 4, false)).value();
  png[16] = 0x7f;  // width 2^31 − …; the checksum is wrong as well, either is an error
  EXPECT_FALSE(decode_texture(png));
}

TEST(TextureFile, LargeImagesAreHalvedWhileTheyAreRead) {
  TextureImage wide{.width = kMaxTextureFileEdge + 2, .height = 2};
  wide.rgba.assign(std::size_t{8} * static_cast<std::size_t>(wide.width), 200);
  const Result<TextureImage> image = decode_texture(encode_png(wide).value());
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->width, kMaxTextureFileEdge / 2 + 1);
  EXPECT_EQ(image->height, 1);
  EXPECT_THAT(image->rgba, testing::Each(200));
}

TEST(TextureFile, AveragesInLinearLight) {
  RowReducer reducer(3, 1, 2);  // a full pair and half a one
  const std::uint8_t row[] = {0, 0, 0, 0, 255, 255, 255, 255, 7, 8, 9, 10};
  reducer.add_row(row);
  const TextureImage image = reducer.take();
  EXPECT_EQ(image.rgba[0], 188) << "half the light of white is sRGB 188";
  EXPECT_EQ(image.rgba[3], 128);
  EXPECT_EQ(image.rgba[4], 7);
}

TEST(TextureFile, SaysWhatItCannotRead) {
  const TemporaryFolder folder;
  EXPECT_THAT(read_texture_file(folder.write("a.tga", "nothing")).error().message,
              testing::HasSubstr("neither PNG nor JPEG"));
  EXPECT_EQ(read_texture_file(folder.path() / "none.png").error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(encode_png(TextureImage{}));
}

Bytes tga(int type, int width, int height, int bits, int descriptor, std::initializer_list<int> data, std::initializer_list<int> map = {}) {
  Bytes bytes(18);
  bytes[1] = map.size() > 0;
  bytes[2] = static_cast<std::uint8_t>(type);
  bytes[5] = static_cast<std::uint8_t>(map.size() / 3);
  bytes[7] = map.size() > 0 ? 24 : 0;
  bytes[12] = static_cast<std::uint8_t>(width), bytes[13] = static_cast<std::uint8_t>(width >> 8);
  bytes[14] = static_cast<std::uint8_t>(height), bytes[15] = static_cast<std::uint8_t>(height >> 8);
  bytes[16] = static_cast<std::uint8_t>(bits);
  bytes[17] = static_cast<std::uint8_t>(descriptor);
  for (const int byte : map) bytes.push_back(static_cast<std::uint8_t>(byte));
  for (const int byte : data) bytes.push_back(static_cast<std::uint8_t>(byte));
  return bytes;
}

TEST(TextureFile, TgaIsReadInAllItsForms) {
  using Texels = std::vector<std::uint8_t>;
  const auto texels = [](const Bytes& bytes) {
    const Result<TextureImage> image = decode_texture(bytes);
    return image ? image->rgba : Texels{};
  };
  const Texels red_over_blue{255, 0, 0, 255, 0, 0, 255, 255};
  EXPECT_EQ(texels(tga(2, 1, 2, 24, 0x20, {0, 0, 255, 255, 0, 0})), red_over_blue) << "top row first";
  EXPECT_EQ(texels(tga(2, 1, 2, 24, 0, {255, 0, 0, 0, 0, 255})), red_over_blue) << "bottom row first";
  EXPECT_EQ(texels(tga(2, 2, 1, 24, 0x30, {255, 0, 0, 0, 0, 255})), red_over_blue) << "right to left";
  EXPECT_EQ(texels(tga(10, 3, 1, 24, 0, {0x81, 1, 2, 3, 0x00, 4, 5, 6})), (Texels{3, 2, 1, 255, 3, 2, 1, 255, 6, 5, 4, 255}));
  EXPECT_EQ(texels(tga(2, 2, 1, 32, 8, {1, 2, 3, 0, 1, 2, 3, 128})), (Texels{3, 2, 1, 0, 3, 2, 1, 128}));
  EXPECT_EQ(texels(tga(2, 1, 1, 32, 8, {1, 2, 3, 0})), (Texels{3, 2, 1, 255})) << "an unused alpha channel";
  EXPECT_EQ(texels(tga(2, 1, 1, 16, 0, {0x00, 0x7c})), (Texels{255, 0, 0, 255}));
  EXPECT_EQ(texels(tga(3, 2, 1, 8, 0, {7, 9})), (Texels{7, 7, 7, 255, 9, 9, 9, 255}));
  EXPECT_EQ(texels(tga(1, 2, 1, 8, 0, {1, 9}, {0, 0, 0, 3, 2, 1})), (Texels{1, 2, 3, 255, 0, 0, 0, 255})) << "9 is beyond the map";
}

TEST(TextureFile, ATgaThatEndsEarlyIsRefusedBeforeMemoryIsTaken) {
  for (const int type : {2, 10}) {
    for (const auto& [width, height] : {std::pair(2, 2), std::pair(65535, 65535)}) {
      const Result<TextureImage> image = decode_texture(tga(type, width, height, 24, 0, {0x83, 1, 2}));
      ASSERT_FALSE(image);
      EXPECT_EQ(image.error().code, ErrorCode::kBadData);
      EXPECT_THAT(image.error().message, testing::HasSubstr("TGA"));
    }
  }
  EXPECT_FALSE(decode_texture(tga(10, 4, 1, 24, 0, {0x81, 1, 2, 3, 0x01, 4, 5, 6}))) << "the last packet lacks a texel";
}

}  // namespace
}  // namespace farfield
