// SPDX-License-Identifier: Apache-2.0
#include "client/warp/cpu_warper.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>

#include "client/warp/average_samples.h"
#include "client/warp/close_cracks.h"
#include "client/warp/fill_voids.h"
#include "client/warp/splat_key.h"

namespace farfield::client {
namespace {

/// A band's keys take at most this much: half a second-level cache. Runs that cross bands are projected in each.
constexpr std::size_t kBandBytes = 1024 * 1024;
/// How far a void looks for surfaces, in pixels of the display.
constexpr int kVoidRadius = 8;

struct TileJob {
  const Splats* splats = nullptr;
  TileProjection projection;
  TileFootprint footprint;
};

/// Writes the near layer's keys, or nothing, into rows of the key buffer. `scale`: frame pixels per layer pixel.
void begin_rows(const NearLayer* near, int width, int first_row, int last_row, int scale, std::uint64_t* keys) {
  const auto stride = static_cast<std::size_t>(width);
  if (!near) {
    std::fill(keys + first_row * stride, keys + last_row * stride, kNoSplat);
    return;
  }
  for (int y = first_row; y < last_row; ++y) {
    const std::size_t from = static_cast<std::size_t>(y / scale) * near->width;
    for (int x = 0; x < width; ++x) {
      const std::size_t at = from + x / scale;
      std::uint32_t colour;
      std::memcpy(&colour, &near->rgba[4 * at], 4);
      const float disparity = near->disparity[at] * near->disparity_scale;
      keys[y * stride + x] = disparity > 0 ? near_key(disparity, colour) : kNoSplat;
    }
  }
}

void begin_frame(Frame& frame, int width, int height) {
  frame.width = width;
  frame.height = height;
  frame.rgba.resize(4 * frame.pixels());
  frame.disparity.resize(frame.pixels());
  frame.coverage.resize(frame.pixels());
  frame.statistics = {};
}

}  // namespace

struct CpuWarper::State {
  explicit State(const CpuWarperOptions& chosen)
      : options(chosen), arena(chosen.threads > 0 ? chosen.threads : tbb::task_arena::automatic) {}

  void draw(const LeafView& leaf, const Pose& eye, const Display& display, const NearLayer* near, Frame& frame);
  void find_jobs(const LeafView& leaf, const Pose& eye, const Display& display, FrameStatistics& statistics);
  template <class F>
  void for_each_band(int width, int height, F&& f);

  CpuWarperOptions options;
  tbb::task_arena arena;
  std::vector<std::uint64_t> keys;
  std::vector<TileJob> jobs;
  Frame fine;  // of the 2×2 samples
};

template <class F>
void CpuWarper::State::for_each_band(int width, int height, F&& f) {
  const int fitting = static_cast<int>(kBandBytes / (sizeof(std::uint64_t) * static_cast<std::size_t>(width)));
  const int even_share = (height + 4 * arena.max_concurrency() - 1) / (4 * arena.max_concurrency());
  const int rows = std::max(16, std::min(fitting, even_share));
  tbb::parallel_for(
      0, (height + rows - 1) / rows, [&](int band) { f(band * rows, std::min((band + 1) * rows, height)); },
      tbb::simple_partitioner());
}

void CpuWarper::State::find_jobs(const LeafView& leaf, const Pose& eye, const Display& display,
                                 FrameStatistics& statistics) {
  jobs.clear();
  for (const auto& tile : leaf.tiles) {
    TileJob job;
    job.splats = &tile->splats;
    job.projection = TileProjection::of(*tile, eye, display);
    job.footprint = find_footprint(job.projection, tile->splats, display);
    if (!job.footprint.is_visible) continue;
    statistics.samples_drawn += tile->splats.drawn;
    ++statistics.tiles_drawn;
    jobs.push_back(job);
  }
}

void CpuWarper::State::draw(const LeafView& leaf, const Pose& eye, const Display& display, const NearLayer* near,
                            Frame& frame) {
  const int scale = near && near->width < display.width ? display.width / near->width : 1;
  assert(!near || (near->width * scale == display.width && near->height * scale == display.height));
  begin_frame(frame, display.width, display.height);
  keys.resize(frame.pixels());
  find_jobs(leaf, eye, display, frame.statistics);

  for_each_band(frame.width, frame.height, [&](int first_row, int last_row) {
    begin_rows(near, frame.width, first_row, last_row, scale, keys.data());
    const PixelWindow window{frame.width, first_row, last_row};
    for (const TileJob& job : jobs) {
      if (job.footprint.last_row < first_row || job.footprint.first_row >= last_row) continue;
      scatter_tile(*job.splats, job.projection, window, options.kernel, keys.data());
    }
  });

  const std::uint32_t background = leaf.background.r | leaf.background.g << 8 | leaf.background.b << 16;
  std::atomic<std::uint64_t> cracks{0}, uncovered{0};
  for_each_band(frame.width, frame.height, [&](int first_row, int last_row) {
    const ResolveCounts counts = resolve_rows(keys.data(), first_row, last_row, background, frame);
    cracks += counts.crack_pixels;
    uncovered += counts.uncovered_pixels;
  });
  const SkyTest sky{leaf.background_visible ? leaf.sky : DirectionMask(), glm::dmat3(glm::mat3_cast(eye.world_from_camera)), display};
  const int radius = options.samples_per_pixel == 4 ? 2 * kVoidRadius : kVoidRadius;
  frame.statistics.crack_pixels = cracks;
  frame.statistics.void_pixels = uncovered > 0 ? fill_voids(frame, sky, radius) : 0;
  frame.statistics.background_pixels = uncovered - frame.statistics.void_pixels;
}

CpuWarper::CpuWarper(const CpuWarperOptions& options) : state_(std::make_unique<State>(options)) {
  assert(options.samples_per_pixel == 1 || options.samples_per_pixel == 4);
}
CpuWarper::~CpuWarper() = default;

void CpuWarper::draw(const LeafView& leaf, const Pose& eye, const Display& display, const NearLayer* near,
                     Frame& frame) {
  assert(display.width > 0 && display.height > 0);
  State& state = *state_;
  state.arena.execute([&] {
    if (state.options.samples_per_pixel != 4) {
      state.draw(leaf, eye, display, near, frame);
      return;
    }
    Display doubled = display;
    doubled.width *= 2;
    doubled.height *= 2;
    state.draw(leaf, eye, doubled, near, state.fine);
    frame.statistics = state.fine.statistics;
    average_samples(state.fine, frame);
  });
}

}  // namespace farfield::client
