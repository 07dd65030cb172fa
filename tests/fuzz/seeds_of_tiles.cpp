// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>

#include "common/codec/tile_codec.h"
#include "common/impostor/tile_neighbours.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/seeds.h"

namespace farfield::fuzz {
namespace {

void make_room(Tile& tile) {
  const std::size_t samples = tile.samples();
  tile.coverage.assign(samples, 0);
  tile.disparity.assign(samples, 0);
  tile.rgb.assign(3 * samples, 90);
  tile.cut_right.assign(samples, 0);
  tile.cut_down.assign(samples, 0);
}

/// A floor with a disc before it and, on the right, nothing.
Tile dense_tile(std::uint8_t view) {
  Tile tile;
  tile.id = {{2, 100, 7, 12}, view, 2, 1, 1};
  tile.edge_samples = face_samples(4);
  tile.width = tile.height = kTileSamples;
  tile.view_offset = {0.1f, 0, -0.2f};
  tile.disparity_tolerance = 1e-3f;
  tile.certificate = {.void_rays = 40000, .void_hits = 3, .void_worst_hits = 2, .void_worst_rays = 3000, .colour_mse = {30, 20},
                      .colour_mse_error = {3, 2}, .disparity_p99 = 3e-4f, .missed_void = true};
  make_room(tile);
  const auto surface = [](int x, int y) { return x > 110 ? 2 : std::hypot(x - 60.0, y - 50.0) < 20 ? 1 : 0; };
  for (int y = 0; y < kTileSamples; ++y) {
    for (int x = 0; x < kTileSamples; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * kTileSamples + x;
      const int here = surface(x, y);
      tile.coverage[i] = here != 2;
      tile.disparity[i] = here == 0 ? 0.05f + 0.001f * static_cast<float>(y) : here == 1 ? 0.4f : 0.0f;
      if (x + 1 < kTileSamples && surface(x + 1, y) != here) tile.cut_right[i] = static_cast<std::uint8_t>(1 + (x + y) % 8);
      if (y + 1 < kTileSamples && surface(x, y + 1) != here) tile.cut_down[i] = static_cast<std::uint8_t>(1 + (3 * x + y) % 8);
    }
  }
  return tile;
}

/// A few blocks of a delta view, not connected to each other.
Tile packed_tile() {
  Tile tile;
  tile.id = {{0, 5, 6, 7}, 3, 4, 1, 0};
  tile.edge_samples = face_samples(12);
  tile.disparity_tolerance = 5e-4f;
  for (std::uint16_t i = 0; i < 5; ++i) tile.blocks.push_back({static_cast<std::uint16_t>(kRegionBlocks + 2 * i), i});
  tile.width = packed_width(tile.blocks.size());
  tile.height = packed_height(tile.blocks.size());
  make_room(tile);
  for (std::size_t i = 0; i < tile.samples(); ++i) {
    const std::size_t block = i / tile.width / kBlockSamples * kPackedColumns + i % tile.width / kBlockSamples;
    tile.coverage[i] = block < tile.blocks.size();
    if (tile.coverage[i]) tile.disparity[i] = 0.3f;
  }
  return tile;
}

}  // namespace

void add_tile_seeds(Seeds& seeds) {
  const auto add = [&](const char* name, const Tile& tile) {
    Result<Bytes> bytes = encode_tile(tile, {.colour_quality = 40});
    require(bytes.has_value(), "a valid tile can be encoded");
    require(decode_tile(*bytes).has_value(), "what was encoded can be decoded");
    seeds.push_back({"tile", name, *bytes});
    seeds.push_back({"tile_payload", name, std::move(*bytes)});
  };
  add("dense", dense_tile(kIntraView));
  add("fallback", dense_tile(kFallbackView));
  add("packed", packed_tile());
}

}  // namespace farfield::fuzz
