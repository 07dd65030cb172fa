// SPDX-License-Identifier: Apache-2.0
#include "common/codec/surface_colours.h"

#include <gtest/gtest.h>

#include <random>

namespace farfield {
namespace {

// A tile of vertical stripes, three samples wide, every second pair of stripes joined by a bridge in the last row.
Tile striped_tile(int size) {
  Tile tile;
  tile.width = tile.height = size;
  tile.coverage.assign(tile.samples(), 1), tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
  for (int y = 0; y < size; ++y)
    for (int x = 2; x + 1 < size; x += 3)
      if (y + 1 < size || x / 3 % 2 == 1) tile.cut_right[y * size + x] = 4;
  return tile;
}

TEST(SurfaceColours, SurfacesAreNumberedByTheirFirstSamples) {
  Tile tile = striped_tile(12);
  tile.coverage[0] = 0;
  const Surfaces surfaces = find_surfaces(tile, TileBits(tile));
  EXPECT_EQ(surfaces.count, 2);  // four stripes in two bridged pairs
  EXPECT_EQ(surfaces.of_sample[0], -1);
  EXPECT_EQ(surfaces.of_sample[1], 0);
  EXPECT_EQ(surfaces.of_sample[5], 0);
  EXPECT_EQ(surfaces.of_sample[6], 1);
  EXPECT_EQ(surfaces.of_sample[11 * 12 + 11], 1);
}

TEST(SurfaceColours, TakingOutAndPuttingBackIsExactWhileAColourSpansLessThanTheWholeRange) {
  const Tile tile = striped_tile(30);
  const Surfaces surfaces = find_surfaces(tile, TileBits(tile));
  std::mt19937 random(5);
  std::vector<std::uint8_t> rgb(3 * tile.samples());
  for (std::size_t i = 0; i < tile.samples(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rgb[3 * i + c] = static_cast<std::uint8_t>((surfaces.of_sample[i] * 37 + 20 * c) % 60 + random() % 190);
  std::vector<std::uint8_t> left = rgb;
  const Bytes bases = take_out_base_colours(surfaces, left);
  EXPECT_NE(left, rgb);
  put_back_base_colours(bases, surfaces, left);
  EXPECT_EQ(left, rgb);
}

TEST(SurfaceColours, BlackAndWhiteOnOneSurfaceComeBackWithinThreeLevels) {
  Tile tile;
  tile.width = 2, tile.height = 1;
  tile.coverage = {1, 1}, tile.cut_right = {0, 0}, tile.cut_down = {0, 0};
  const Surfaces surfaces = find_surfaces(tile, TileBits(tile));
  const std::vector<std::uint8_t> rgb{0, 0, 0, 255, 255, 255};
  std::vector<std::uint8_t> left = rgb;
  const Bytes bases = take_out_base_colours(surfaces, left);
  put_back_base_colours(bases, surfaces, left);
  for (std::size_t i = 0; i < rgb.size(); ++i) EXPECT_NEAR(left[i], rgb[i], 3);
}

TEST(SurfaceColours, FlatSurfacesLeaveAFlatImageAndFewBytes) {
  const Tile tile = striped_tile(120);
  const Surfaces surfaces = find_surfaces(tile, TileBits(tile));
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < tile.samples(); ++i)
    for (const int value : {40, 80, 160}) rgb.push_back(static_cast<std::uint8_t>(value + surfaces.of_sample[i] % 4 * 16));
  const Bytes bases = take_out_base_colours(surfaces, rgb);
  for (const std::uint8_t value : rgb) EXPECT_NEAR(value, 128, 2);
  EXPECT_LT(bases.size(), static_cast<std::size_t>(surfaces.count));  // four colours in turn: less than a byte each
}

TEST(SurfaceColours, DamagedBytesGiveSomeColours) {
  const Tile tile = striped_tile(30);
  const Surfaces surfaces = find_surfaces(tile, TileBits(tile));
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Bytes bytes(random() % 40);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    std::vector<std::uint8_t> rgb(3 * tile.samples(), 128);
    put_back_base_colours(bytes, surfaces, rgb);
    EXPECT_EQ(rgb.size(), 3 * tile.samples());
  }
}

}  // namespace
}  // namespace farfield
