// SPDX-License-Identifier: Apache-2.0
#include "common/codec/plane_coder.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace farfield {
namespace {

struct Coded {
  SurfaceFrame frame;
  PlaneGuesses guesses;
  PlaneChoice choice;
};

SurfaceFrame frame_of(int columns, int rows, int x, int y) {
  NodeSamples box{.first_row = 0, .end_row = rows};
  for (int row = 0; row < rows; ++row) box.rows[row] = 0xffffffffu >> (32 - columns);
  return SurfaceFrame(Node{x, y, 32}, box);
}

std::int64_t steps_of(std::int64_t value, int shift) { return round_shift(value, shift) * (std::int64_t{1} << shift); }

TEST(PlaneCoder, EveryWayComesBackFromEveryGuess) {
  std::mt19937 random(4);
  const auto number = [&](int most) { return static_cast<std::int64_t>(random() % (2 * most + 1)) - most; };
  std::vector<Coded> all;
  for (int i = 0; i < 2000; ++i) {
    Coded coded{frame_of(1 + static_cast<int>(random() % 32), 1 + static_cast<int>(random() % 32), static_cast<int>(random() % 96), static_cast<int>(random() % 96)), {}, {}};
    const auto wanted = static_cast<int>(1 + random() % PlaneGuesses::kMost);
    for (int g = 0; g < wanted; ++g) coded.guesses.add({number(1 << 23), number(i % 3 ? 4000 : 1 << 20), number(4000)});
    coded.guesses.is_connected = coded.guesses.count == 1;
    coded.choice.guess = static_cast<int>(random() % coded.guesses.count);
    const Plane guess = coded.guesses.planes[coded.choice.guess];
    coded.choice.way = static_cast<PlaneChoice::Way>(random() % 3);
    if (coded.frame.size_class() == 0 && coded.choice.way == PlaneChoice::Way::kNew) coded.choice.way = PlaneChoice::Way::kShifted;
    std::int64_t gx = guess.gx, gy = guess.gy;
    const bool is_new = coded.choice.way == PlaneChoice::Way::kNew;
    if (is_new && coded.frame.columns > 1) gx = steps_of(number(1 << 20), SurfaceFrame::slope_shift(coded.frame.columns));
    if (is_new && coded.frame.rows > 1) gy = steps_of(number(5000), SurfaceFrame::slope_shift(coded.frame.rows));
    const std::int64_t value = steps_of(number(1 << 23), PlaneCoder<BitWriter>::offset_shift(coded.frame));
    coded.choice.plane = coded.choice.way == PlaneChoice::Way::kSame ? guess : Plane::through(value, coded.frame.x, coded.frame.y, gx, gy);
    all.push_back(coded);
  }
  BitWriter writer;
  auto encoder = std::make_unique<PlaneCoder<BitWriter>>(writer);
  for (const Coded& coded : all) ASSERT_EQ(encoder->code(coded.frame, coded.guesses, coded.choice), coded.choice.plane);
  const Bytes bytes = writer.finish();
  BitReader reader(bytes);
  auto decoder = std::make_unique<PlaneCoder<BitReader>>(reader);
  for (const Coded& coded : all) ASSERT_EQ(decoder->code(coded.frame, coded.guesses, {}), coded.choice.plane);
  EXPECT_EQ(decoder->recent(), encoder->recent());
}

TEST(PlaneCoder, AnyBytesGiveBoundedPlanes) {
  std::mt19937 random(8);
  for (int round = 0; round < 40; ++round) {
    Bytes bytes(400);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(round % 4 == 0 ? 0xff : random());
    BitReader reader(bytes);
    auto decoder = std::make_unique<PlaneCoder<BitReader>>(reader);
    PlaneGuesses guesses;
    guesses.add({});
    for (int i = 0; i < 500; ++i) {
      const SurfaceFrame frame = frame_of(1 + i % 32, 1 + i / 7 % 32, i % 96, i / 5 % 96);
      const Plane plane = decoder->code(frame, guesses, {});
      ASSERT_LE(std::abs(plane.gx), PlaneCoder<BitReader>::kLargestUnits);
      ASSERT_LE(std::abs(plane.gy), PlaneCoder<BitReader>::kLargestUnits);
      ASSERT_LE(std::abs(plane.c), PlaneCoder<BitReader>::kLargestUnits * 257);
      guesses = {};
      for (const Plane& recent : decoder->recent()) guesses.add(recent);
    }
  }
}

}  // namespace
}  // namespace farfield
