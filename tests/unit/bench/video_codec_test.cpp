// SPDX-License-Identifier: Apache-2.0
#ifdef FARFIELD_HAS_VIDEO
#  include "tests/bench/baselines/video_codec.h"

#  include <gtest/gtest.h>

#  include <cmath>

#  include "common/image/psnr.h"

namespace farfield::bench {
namespace {

constexpr int kWidth = 160, kHeight = 96;

// Soft stripes in three colours that move by two pixels a picture.
Image8 stripes(int time) {
  Image8 image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = static_cast<std::uint8_t>(128 + 90 * std::sin(0.12 * (x + 2 * time) + 0.07 * (c + 1) * y));
  return image;
}

struct Outcome {
  double psnr_db = 0;
  std::size_t first_bytes = 0, later_bytes = 0;
};

Outcome run(VideoSettings settings) {
  settings.width = kWidth, settings.height = kHeight;
  auto encoder = VideoEncoder::create(settings);
  auto decoder = VideoDecoder::create();
  EXPECT_TRUE(encoder && decoder);
  Outcome outcome;
  for (int k = 0; k < 12; ++k) {
    const Image8 image = stripes(k);
    const auto bytes = encoder->encode(image.values);
    EXPECT_TRUE(bytes);
    (k == 0 ? outcome.first_bytes : outcome.later_bytes) += bytes->size();
    const auto decoded = decoder->decode(*bytes);
    EXPECT_TRUE(decoded);
    Image8 seen(kWidth, kHeight, 3);
    seen.values = *decoded;
    outcome.psnr_db = psnr_db(image, seen);
  }
  return outcome;
}

TEST(VideoCodec, EveryPictureComesBackAtOnceAndAsItWas) {
  const Outcome outcome = run({.crf = 10, .has_full_chroma = true});
  EXPECT_GT(outcome.psnr_db, 36);
  EXPECT_GT(outcome.first_bytes, outcome.later_bytes / 11);  // later ones are coded from those before
}

TEST(VideoCodec, TheRateFactorTradesBytesForError) {
  const Outcome fine = run({.crf = 12}), coarse = run({.crf = 36});
  EXPECT_GT(fine.psnr_db, coarse.psnr_db + 3);
  EXPECT_GT(fine.later_bytes, 2 * coarse.later_bytes);
}

TEST(VideoCodec, FullChromaIsCloser) {
  EXPECT_GT(run({.crf = 8, .has_full_chroma = true}).psnr_db, run({.crf = 8}).psnr_db);
}

// Rounding in the conversions must not make pictures brighter or darker: a tenth of a code on average would show in FLIP.
TEST(VideoCodec, ColoursComeBackWithoutBias) {
  for (const bool has_full_chroma : {false, true}) {
    Image8 image(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        image.at(x, y)[0] = static_cast<std::uint8_t>(60 + x), image.at(x, y)[1] = static_cast<std::uint8_t>(50 + y);
        image.at(x, y)[2] = static_cast<std::uint8_t>(220 - x / 2 - y / 2);
      }
    auto encoder = VideoEncoder::create({.width = kWidth, .height = kHeight, .crf = 1, .has_full_chroma = has_full_chroma});
    auto decoder = VideoDecoder::create();
    ASSERT_TRUE(encoder && decoder);
    const auto bytes = encoder->encode(image.values);
    ASSERT_TRUE(bytes);
    const auto decoded = decoder->decode(*bytes);
    ASSERT_TRUE(decoded);
    double sum[3] = {};
    for (std::size_t i = 0; i < decoded->size(); ++i) sum[i % 3] += (*decoded)[i] - image.values[i];
    for (const double s : sum) EXPECT_NEAR(s / (kWidth * kHeight), 0, 0.15) << has_full_chroma;
  }
}

TEST(VideoCodec, RefusesWhatItCannotDo) {
  EXPECT_FALSE(VideoEncoder::create({.width = 33, .height = 32}));
  auto decoder = VideoDecoder::create();
  ASSERT_TRUE(decoder);
  EXPECT_FALSE(decoder->decode(Bytes(100, 7)));
}

}  // namespace
}  // namespace farfield::bench
#endif
