// SPDX-License-Identifier: Apache-2.0
// Near geometry drawn on the processor: a hall of textured pipes around the viewer.
#include <benchmark/benchmark.h>

#include <cmath>

#include "client/near_cpu/near_raster.h"

namespace farfield::client {
namespace {

constexpr int kSides = 12, kRings = 8;

std::shared_ptr<DecodedTexture> chequers() {
  auto texture = std::make_shared<DecodedTexture>();
  texture->hash = texture->serial = 1;
  for (int edge = 1; edge <= 512; edge *= 2) {
    TextureLevel level;
    level.width = level.height = edge;
    for (int k = 0; k < edge * edge; ++k)
      for (int c = 0; c < 4; ++c) level.rgba.push_back(static_cast<std::uint8_t>(c == 3 ? 255 : ((k / edge ^ k) & 8) * 10 + 60));
    texture->levels.push_back(std::move(level));
  }
  return texture;
}

/// A pipe along y, 8 m long, of kRings × kSides quads.
Chunk pipe(const glm::vec2& at, float radius) {
  Chunk chunk;
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int side = 0; side <= kSides; ++side) {
      const float angle = 6.2831853f * static_cast<float>(side) / kSides, along = static_cast<float>(ring) / kRings;
      const glm::vec3 normal(std::cos(angle), 0, std::sin(angle));
      chunk.vertices.push_back({glm::vec3(at.x, 8 * along - 4, at.y) + radius * normal, encode_normal(normal),
                                {static_cast<float>(side) / kSides, 2 * along}, {200, 180, 160, 255}});
    }
  }
  for (int ring = 0; ring < kRings; ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const auto a = static_cast<std::uint16_t>(ring * (kSides + 1) + side), b = static_cast<std::uint16_t>(a + kSides + 1);
      for (const int index : {a + 0, a + 1, b + 1, a + 0, b + 1, b + 0}) chunk.indices.push_back(static_cast<std::uint16_t>(index));
    }
  }
  return chunk;
}

LeafView hall() {
  LeafView leaf;
  leaf.leaf_box = {glm::dvec3(-0.5), glm::dvec3(0.5)};
  leaf.near_region = leaf.leaf_box.grown(10);
  const auto texture = chequers();
  for (int k = 0; k < 60; ++k) {
    auto decoded = std::make_shared<DecodedChunk>();
    decoded->serial = static_cast<std::uint64_t>(k) + 1;
    const float angle = 2.4f * static_cast<float>(k), distance = 1 + 0.1f * static_cast<float>(k);
    decoded->chunk = pipe(distance * glm::vec2(std::cos(angle), std::sin(angle)), 0.15f);
    const bool has_texture = k % 2 == 0;
    decoded->chunk.texture = has_texture ? texture->hash : 0;
    leaf.chunks.push_back({decoded, has_texture ? texture : nullptr, glm::mat4x3{1}});
  }
  return leaf;
}

/// Argument: lines of the display. Bands as the warper has them, on one thread.
void near_frame(benchmark::State& state) {
  constexpr int kBandRows = 64;
  Display display;
  display.height = static_cast<int>(state.range(0));
  display.width = display.height * 16 / 9;
  const LeafView leaf = hall();
  NearRaster raster;
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(display.width) * static_cast<std::size_t>(display.height));
  NearStatistics statistics;
  double angle = 0;
  for (auto _ : state) {
    const Pose eye{{0, 0.1, 0}, glm::angleAxis(angle, glm::dvec3(0, 1, 0))};
    statistics = raster.begin(leaf, eye, display, 1e-3);
    for (int row = 0; row < display.height; row += kBandRows)
      raster.draw_rows(display, row, std::min(row + kBandRows, display.height), keys.data());
    angle += 0.4;
    benchmark::DoNotOptimize(keys.data());
  }
  std::size_t covered = 0;
  for (const std::uint64_t key : keys) covered += key != 0;
  state.counters["triangles"] = static_cast<double>(statistics.triangles);
  state.counters["covered_share"] = static_cast<double>(covered) / static_cast<double>(keys.size());
}
BENCHMARK(near_frame)->ArgNames({"lines"})->Arg(720)->Arg(1080)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace farfield::client
