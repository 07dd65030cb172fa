// SPDX-License-Identifier: Apache-2.0
// The CPU warper: time per landing sample and per whole frame.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "client/warp/cpu_warper.h"
#include "common/impostor/depth_mesh.h"
#include "common/math/cube_face.h"

namespace farfield::client {
namespace {

/// A view of a bumpy room, all six faces of `tiles`² tiles: disparities from 0.1 to 0.45 of 1/side.
LeafView room(int tiles) {
  LeafView leaf;
  std::mt19937 random(1);
  for (int face = 0; face < 6; ++face) {
    for (int index = 0; index < tiles * tiles; ++index) {
      Tile tile;
      tile.id.face = static_cast<std::uint8_t>(face);
      tile.id.x = static_cast<std::uint8_t>(index % tiles), tile.id.y = static_cast<std::uint8_t>(index / tiles);
      tile.edge_samples = face_samples(tiles);
      tile.width = tile.height = kTileSamples;
      tile.coverage.assign(tile.samples(), 1);
      tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
      for (int j = 0; j < kTileSamples; ++j) {
        for (int i = 0; i < kTileSamples; ++i) {
          const double u = sample_tangent(tile.edge_samples, tile.id.x * kTileStride + i);
          const double v = sample_tangent(tile.edge_samples, tile.id.y * kTileStride + j);
          tile.disparity.push_back(static_cast<float>(0.28 + 0.17 * std::sin(5 * u + face) * std::cos(4 * v)));
          for (int c = 0; c < 3; ++c) tile.rgb.push_back(static_cast<std::uint8_t>(random()));
        }
      }
      auto decoded = std::make_shared<DecodedTile>();
      decoded->id = tile.id;
      decoded->splats = build_splats(tile);
      leaf.tiles.push_back(std::move(decoded));
    }
  }
  return leaf;
}

/// Arguments: lines of the display, threads, samples per pixel. Counter: nanoseconds per sample of visible tiles.
void warp_frame(benchmark::State& state) {
  Display display;
  display.height = static_cast<int>(state.range(0));
  display.width = display.height * 16 / 9;
  const int samples = static_cast<int>(std::ceil(2 * 2.5 / (2 * display.pixel_pitch())));
  const LeafView leaf = room(static_cast<int>(std::lround((samples - 2) / double{kTileStride})));
  CpuWarper warper({static_cast<int>(state.range(2)), static_cast<int>(state.range(1)), ProjectionKernel::kVector});
  Frame frame;
  double angle = 0;
  for (auto _ : state) {
    const Pose eye{{0.3 * std::cos(angle), 0.1, 0.3 * std::sin(angle)}, glm::angleAxis(angle, glm::dvec3(0, 1, 0))};
    warper.draw(leaf, eye, display, nullptr, frame);
    angle += 0.4;
    benchmark::DoNotOptimize(frame.rgba.data());
  }
  const auto drawn = static_cast<double>(frame.statistics.samples_drawn);
  state.counters["Msamples"] = drawn * 1e-6;
  state.counters["per_sample"] = benchmark::Counter(drawn, benchmark::Counter::kIsIterationInvariantRate |
                                                                         benchmark::Counter::kInvert);
  state.counters["void_px"] = static_cast<double>(frame.statistics.void_pixels);
  state.counters["crack_px"] = static_cast<double>(frame.statistics.crack_pixels);
}
BENCHMARK(warp_frame)
    ->ArgNames({"lines", "threads", "samples_per_pixel"})
    ->ArgsProduct({{720, 1080}, {1, 2}, {1}})
    ->Args({720, 2, 4})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// One tile of 128² samples. Argument: 1 merges planar quads, 0 keeps all.
void mesh_tile(benchmark::State& state) {
  Tile tile;
  tile.edge_samples = face_samples(12);
  tile.width = tile.height = kTileSamples;
  tile.coverage.assign(tile.samples(), 1);
  tile.rgb.assign(3 * tile.samples(), 90);
  tile.cut_right.assign(tile.samples(), 0), tile.cut_down.assign(tile.samples(), 0);
  for (int j = 0; j < kTileSamples; ++j) {
    for (int i = 0; i < kTileSamples; ++i) {  // facets, with a cut object in front
      const bool is_object = i > 40 && i < 70 && j > 20 && j < 90;
      const double facet = 0.1 + 1e-4 * i + 5e-4 * std::fabs(j - 64.0);
      tile.disparity.push_back(static_cast<float>(is_object ? 0.3 + 1e-3 * std::sin(0.3 * i) : facet));
      const bool at_right = j > 20 && j < 90 && (i == 40 || i == 69), at_bottom = i > 40 && i < 70 && (j == 20 || j == 89);
      if (at_right) tile.cut_right[j * kTileSamples + i] = 3;
      if (at_bottom) tile.cut_down[j * kTileSamples + i] = 6;
    }
  }
  std::size_t triangles = 0;
  for (auto _ : state) {
    const DepthMesh mesh = build_depth_mesh(tile, state.range(0) ? 2e-4f : 0.0f);
    triangles = mesh.indices.size() / 3;
  }
  state.counters["triangles"] = static_cast<double>(triangles);
}
BENCHMARK(mesh_tile)->ArgNames({"merged"})->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace farfield::client
