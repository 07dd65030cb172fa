// SPDX-License-Identifier: Apache-2.0
// The CPU warper: time per landing sample and per whole frame.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <bit>
#include <chrono>
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
      tile.disparity_tolerance = 7e-4f;  // as tiles for 1080 lines have it: one pixel
      auto decoded = std::make_shared<DecodedTile>();
      decoded->id = tile.id;
      decoded->splats = build_splats(tile);
      leaf.tiles.push_back(std::move(decoded));
    }
  }
  return leaf;
}

/// The least a forward warp can do: samples of a plane projected row by row, each written to its one pixel where it is the
/// nearest, nothing culled, no footprint, no colour but its own. Returns: seconds per sample, one thread, the best of five.
double bare_kernel_seconds(const Display& display, std::size_t samples) {
  const auto columns = static_cast<std::size_t>(display.width);
  const std::size_t rows = std::max<std::size_t>(1, samples / columns);
  std::vector<float> disparity(columns * rows, 0.3f);
  const std::vector<std::uint32_t> colour(columns * rows, 0x405060u);
  std::vector<std::uint64_t> keys(columns * static_cast<std::size_t>(display.height));
  for (std::size_t k = 0; k < disparity.size(); ++k) disparity[k] += 1e-3f * static_cast<float>(k % 7);
  std::vector<std::int32_t> place(columns);
  std::vector<float> eye(columns);
  double best = 1e9;
  for (int run = 0; run < 5; ++run) {
    std::fill(keys.begin(), keys.end(), 0);
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t j = 0; j < rows; ++j) {
      const float y = static_cast<float>(j) * static_cast<float>(display.height - 2) / static_cast<float>(rows);
      const float* d = &disparity[j * columns];
      for (std::size_t i = 0; i < columns; ++i) {
        const float inverse = 1.0f / (1.0f + 0.001f * d[i]);
        const float x = (0.999f * static_cast<float>(static_cast<int>(i)) + 0.5f * d[i]) * inverse;
        place[i] = static_cast<int>((y + d[i]) * inverse) * display.width + static_cast<int>(x);
        eye[i] = d[i] * inverse;
      }
      for (std::size_t i = 0; i < columns; ++i) {
        std::uint64_t& cell = keys[static_cast<std::size_t>(place[i])];
        cell = std::max(cell, static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(eye[i])) << 32 | colour[j * columns + i]);
      }
    }
    benchmark::DoNotOptimize(keys.data());
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best / static_cast<double>(columns * rows);
}

/// Arguments: lines of the display, threads, samples per pixel. Counters: seconds per sample of visible tiles (per_sample), the
/// same of the bare kernel on one thread in the same run (bare), how many of these a sample takes (times_bare).
void warp_frame(benchmark::State& state) {
  Display display;
  display.height = static_cast<int>(state.range(0));
  display.width = display.height * 16 / 9;
  const int samples = static_cast<int>(std::ceil(2 * 2.5 / (2 * display.pixel_pitch())));
  const LeafView leaf = room(static_cast<int>(std::lround((samples - 2) / double{kTileStride})));
  CpuWarper warper({static_cast<int>(state.range(2)), static_cast<int>(state.range(1)), ProjectionKernel::kVector});
  Frame frame;
  double angle = 0, seconds = 0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const Pose eye{{0.3 * std::cos(angle), 0.1, 0.3 * std::sin(angle)}, glm::angleAxis(angle, glm::dvec3(0, 1, 0))};
    warper.draw(leaf, eye, display, nullptr, frame);
    angle += 0.4;
    benchmark::DoNotOptimize(frame.rgba.data());
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const auto drawn = static_cast<double>(frame.statistics.samples_drawn);
  state.counters["Msamples"] = drawn * 1e-6;
  state.counters["per_sample"] = benchmark::Counter(drawn, benchmark::Counter::kIsIterationInvariantRate |
                                                                         benchmark::Counter::kInvert);
  const double bare = bare_kernel_seconds(display, static_cast<std::size_t>(drawn));
  state.counters["bare"] = bare;
  state.counters["times_bare"] = seconds / (static_cast<double>(state.iterations()) * drawn * bare);
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
