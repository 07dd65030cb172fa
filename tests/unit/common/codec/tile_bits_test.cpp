// SPDX-License-Identifier: Apache-2.0
#include "common/codec/tile_bits.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "common/codec/plane_nodes.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

void scatter(Tile& tile, unsigned seed, unsigned one_in) {
  std::mt19937 random(seed);
  const auto fill = [&](std::vector<std::uint8_t>& values, auto value) {
    values.resize(tile.samples());
    for (auto& v : values) v = static_cast<std::uint8_t>(value());
  };
  fill(tile.coverage, [&] { return random() % one_in != 0; });
  fill(tile.cut_right, [&] { return random() % one_in == 0 ? 1 + random() % 8 : 0; });
  fill(tile.cut_down, [&] { return random() % one_in == 0 ? 1 + random() % 8 : 0; });
}

Tile dense_tile(int width, int height, unsigned seed, unsigned one_in) {
  Tile tile;
  tile.width = width, tile.height = height;
  scatter(tile, seed, one_in);
  return tile;
}

Tile packed_tile(unsigned seed, unsigned one_in) {
  Tile tile;
  tile.id.view = 1;
  for (std::uint16_t x = 3; x < 9; ++x)
    for (std::uint16_t y = 0; y < 6; ++y)
      if ((x * 7 + y * 5) % 4 != 0) tile.blocks.push_back({x, y});
  tile.width = packed_width(tile.blocks.size()), tile.height = packed_height(tile.blocks.size());
  scatter(tile, seed, one_in);
  return tile;
}

void expect_joins_of_neighbours(const Tile& tile) {
  ASSERT_EQ(tile.is_packed(), !tile.blocks.empty());
  const TileBits bits(tile);
  const TileNeighbours neighbours(tile);
  for (int block = 0; block < bits.grid().size(); ++block)
    for (int k = 0; k < 64; ++k) {
      const bool is_inside = bits.grid().samples(block) >> k & 1;
      const int i = bits.grid().first_sample(block) + k / 8 * tile.width + k % 8;
      const auto is_joined = [&](int other, const std::vector<std::uint8_t>& cuts) {
        return other >= 0 && tile.coverage[i] && tile.coverage[other] && cuts[i] == kConnected;
      };
      const int right = is_inside ? neighbours.right(i) : -1, below = is_inside ? neighbours.down(i) : -1;
      ASSERT_EQ(bits[block].covered >> k & 1, is_inside && tile.coverage[i]);
      ASSERT_EQ(bits.grid().with_right(block) >> k & 1, right >= 0);
      ASSERT_EQ(bits.grid().with_below(block) >> k & 1, below >= 0);
      ASSERT_EQ(bits.joined_right(block) >> k & 1, is_joined(right, tile.cut_right));
      ASSERT_EQ(bits.joined_below(block) >> k & 1, is_joined(below, tile.cut_down));
    }
}

TEST(TileBits, JoinsAreThoseOfTheNeighboursOnTheFace) {
  expect_joins_of_neighbours(dense_tile(32, 16, 1, 5));
  expect_joins_of_neighbours(dense_tile(13, 21, 2, 5));  // blocks that are not whole
  expect_joins_of_neighbours(packed_tile(3, 5));
}

// The samples of each surface of a node, by flooding one sample at a time.
std::vector<std::set<int>> flooded(const Tile& tile, const Node& node) {
  std::vector<std::set<int>> surfaces;
  std::set<int> seen;
  for (int k = 0; k < node.size * node.size; ++k) {
    const int first = (node.y + k / node.size) * tile.width + node.x + k % node.size;
    if (!tile.coverage[first] || seen.contains(first)) continue;
    std::set<int>& surface = surfaces.emplace_back();
    std::vector<int> open{first};
    while (!open.empty()) {
      const int i = open.back(), x = i % tile.width, y = i / tile.width;
      open.pop_back();
      if (!seen.insert(i).second) continue;
      surface.insert(i);
      const auto visit = [&](bool is_inside, int other, const std::vector<std::uint8_t>& cuts, int edge) {
        if (is_inside && tile.coverage[other] && cuts[edge] == kConnected) open.push_back(other);
      };
      visit(x + 1 < node.x + node.size, i + 1, tile.cut_right, i), visit(x > node.x, i - 1, tile.cut_right, i - 1);
      visit(y + 1 < node.y + node.size, i + tile.width, tile.cut_down, i), visit(y > node.y, i - tile.width, tile.cut_down, i - tile.width);
    }
  }
  return surfaces;
}

TEST(PlaneNodes, SurfacesAreThoseOfAFlood) {
  for (const unsigned one_in : {2, 3, 5, 20, 400, 100'000}) {
    const Tile tile = dense_tile(64, 64, one_in, one_in);
    const TileBits bits(tile);
    for (int size = kLargestNode; size >= kSmallestNode; size /= 2)
      for (int y = 0; y < tile.height; y += size)
        for (int x = 0; x < tile.width; x += size) {
          const Node node{x, y, size};
          const std::vector<std::set<int>> wanted = flooded(tile, node);
          EXPECT_EQ(is_empty(bits, node), wanted.empty());
          bool is_cut = false;
          for (int k = 0; k < size * size; ++k) {
            const int column = k % size, row = k / size, i = (y + row) * tile.width + x + column;
            is_cut = is_cut || !tile.coverage[i] || (column + 1 < size && tile.cut_right[i]) || (row + 1 < size && tile.cut_down[i]);
          }
          EXPECT_EQ(is_whole(bits, node), !is_cut);
          NodeSurfaces surfaces(bits, node);
          std::vector<std::set<int>> found;
          for (NodeSamples surface; surfaces.next(surface);) {
            std::set<int>& samples = found.emplace_back();
            surface.each_run([&](int row, int first, int end) {
              for (int column = first; column < end; ++column) samples.insert((y + row) * tile.width + x + column);
            });
          }
          ASSERT_EQ(found, wanted) << "node of " << size << " at " << x << ", " << y;
        }
  }
}

}  // namespace
}  // namespace farfield
