// SPDX-License-Identifier: Apache-2.0
#include "client/warp/cpu_warper.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <vector>

#include "client/warp/average_samples.h"
#include "client/warp/close_cracks.h"
#include "client/warp/fill_voids.h"
#include "client/warp/smooth_edges.h"
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

  void draw(const LeafView& leaf, const Pose& eye, const Display& shown, const NearRows* near, Frame& frame);
  void scatter_band(const NearRows* near, int first_row, int last_row);
  void resolve(int first_row, int last_row, Frame& frame);
  void find_jobs(const LeafView& leaf, const Pose& eye);
  template <class F>
  void for_each_band(int width, int height, F&& f);

  CpuWarperOptions options;
  tbb::task_arena arena;
  // While a frame is drawn:
  Display display;  // 2×2 samples are drawn as so many pixels
  std::vector<std::uint64_t> keys;
  std::vector<TileJob> jobs;
  std::uint32_t background = 0;  // 0x00BBGGRR
  FrameStatistics statistics;
  std::atomic<std::uint64_t> crack_pixels{0}, uncovered_pixels{0};
  Frame fine;  // of the 2×2 samples
  EdgeSmoother edges;
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

void CpuWarper::State::find_jobs(const LeafView& leaf, const Pose& eye) {
  jobs.resize(leaf.tiles.size());
  const glm::dmat3 pixels = pixels_from_directions(eye.world_from_camera, display);
  constexpr std::size_t kSome = 64;  // tiles at once: one takes a quarter of a microsecond
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, jobs.size(), kSome), [&](const tbb::blocked_range<std::size_t>& some) {
    for (std::size_t k = some.begin(); k < some.end(); ++k) {
      TileJob& job = jobs[k];
      job.splats = &leaf.tiles[k]->splats;
      job.projection = TileProjection::of(*leaf.tiles[k], eye.position, pixels);
      job.footprint = find_footprint(job.projection, *job.splats, display);
    }
  });
  std::erase_if(jobs, [](const TileJob& job) { return !job.footprint.is_visible; });
  statistics = {};
  statistics.tiles_drawn = jobs.size();
  for (const TileJob& job : jobs) statistics.samples_drawn += job.splats->drawn;
}

void CpuWarper::State::scatter_band(const NearRows* near, int first_row, int last_row) {
  const auto stride = static_cast<std::size_t>(display.width);
  if (near) {
    near->draw_rows(display, first_row, last_row, keys.data());
  } else {
    std::fill(keys.data() + first_row * stride, keys.data() + last_row * stride, kNoSplat);
  }
  const PixelWindow window{display.width, first_row, last_row};
  ShownDepths shown(window, keys.data());
  for (const TileJob& job : jobs) {
    const TileFootprint& foot = job.footprint;
    if (foot.last_row < first_row || foot.first_row >= last_row) continue;
    const PixelRectangle within{foot.first_column, foot.last_column, std::max(foot.first_row, first_row),
                                std::min(foot.last_row, last_row - 1)};
    if (options.kernel == ProjectionKernel::kVector && shown.hide(within, foot.nearest)) continue;
    scatter_tile(*job.splats, job.projection, window, options.kernel, shown, keys.data());
  }
}

void CpuWarper::State::resolve(int first_row, int last_row, Frame& frame) {
  if (first_row >= last_row) return;
  const ResolveCounts counts = resolve_rows(keys.data(), first_row, last_row, background, frame);
  crack_pixels += counts.crack_pixels;
  uncovered_pixels += counts.uncovered_pixels;
}

/// Keys to a frame with cracks closed and voids filled.
void CpuWarper::State::draw(const LeafView& leaf, const Pose& eye, const Display& shown, const NearRows* near, Frame& frame) {
  display = shown;
  if (options.samples_per_pixel == 4) display.width *= 2, display.height *= 2;
  find_jobs(leaf, eye);
  const SkyTest sky(leaf.background_visible ? leaf.sky : DirectionMask(), glm::dmat3(glm::mat3_cast(eye.world_from_camera)), display);
  background = leaf.background.r | leaf.background.g << 8 | leaf.background.b << 16;
  keys.resize(static_cast<std::size_t>(display.width) * static_cast<std::size_t>(display.height));
  begin_frame(frame, display.width, display.height);
  crack_pixels = uncovered_pixels = 0;
  // A band is resolved while its keys are in the cache; its first and last row wait for the neighbours'.
  for_each_band(display.width, display.height, [&](int first_row, int last_row) {
    scatter_band(near, first_row, last_row);
    resolve(first_row + 1, last_row - 1, frame);
  });
  for_each_band(display.width, display.height, [&](int first_row, int last_row) {
    resolve(first_row, first_row + 1, frame);
    resolve(std::max(last_row - 1, first_row + 1), last_row, frame);
  });
  const int radius = options.samples_per_pixel == 4 ? 2 * kVoidRadius : kVoidRadius;
  frame.statistics = statistics;
  frame.statistics.crack_pixels = crack_pixels;
  frame.statistics.void_pixels = uncovered_pixels > 0 ? fill_voids(frame, sky, radius) : 0;
  frame.statistics.background_pixels = uncovered_pixels - frame.statistics.void_pixels;
}

CpuWarper::CpuWarper(const CpuWarperOptions& options) : state_(std::make_unique<State>(options)) {
  assert(options.samples_per_pixel == 1 || options.samples_per_pixel == 4);
}
CpuWarper::~CpuWarper() = default;

void CpuWarper::draw(const LeafView& leaf, const Pose& eye, const Display& display, const NearRows* near, Frame& frame) {
  assert(display.width > 0 && display.height > 0);
  State& s = *state_;
  s.arena.execute([&] {
    if (s.options.samples_per_pixel == 4) {
      s.draw(leaf, eye, display, near, s.fine);
      frame.statistics = s.fine.statistics;
      average_samples(s.fine, frame);
      return;
    }
    s.draw(leaf, eye, display, near, frame);
    if (s.options.smooth_edges) s.edges.smooth(frame);
  });
}

}  // namespace farfield::client
