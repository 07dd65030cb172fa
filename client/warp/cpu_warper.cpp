// SPDX-License-Identifier: Apache-2.0
#include "client/warp/cpu_warper.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cassert>

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

  void scatter(const LeafView& leaf, const Pose& eye, const Display& shown, const NearRows* near);
  void finish(Frame& frame);
  void resolve(Frame& frame);
  void find_jobs(const LeafView& leaf, const Pose& eye);
  template <class F>
  void for_each_band(int width, int height, F&& f);

  CpuWarperOptions options;
  tbb::task_arena arena;
  // From scatter() to finish():
  Display display;  // 2×2 samples are drawn as so many pixels
  std::vector<std::uint64_t> keys;
  std::vector<TileJob> jobs;
  SkyTest sky;
  std::uint32_t background = 0;  // 0x00BBGGRR
  FrameStatistics statistics;
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
  jobs.clear();
  statistics = {};
  const glm::dmat3 pixels = pixels_from_directions(eye.world_from_camera, display);
  for (const auto& tile : leaf.tiles) {
    TileJob job;
    job.splats = &tile->splats;
    job.projection = TileProjection::of(*tile, eye.position, pixels);
    job.footprint = find_footprint(job.projection, tile->splats, display);
    if (!job.footprint.is_visible) continue;
    statistics.samples_drawn += tile->splats.drawn;
    ++statistics.tiles_drawn;
    jobs.push_back(job);
  }
}

void CpuWarper::State::scatter(const LeafView& leaf, const Pose& eye, const Display& shown, const NearRows* near) {
  display = shown;
  if (options.samples_per_pixel == 4) display.width *= 2, display.height *= 2;
  find_jobs(leaf, eye);
  sky = SkyTest(leaf.background_visible ? leaf.sky : DirectionMask(), glm::dmat3(glm::mat3_cast(eye.world_from_camera)),
                display);
  background = leaf.background.r | leaf.background.g << 8 | leaf.background.b << 16;
  const auto stride = static_cast<std::size_t>(display.width);
  keys.resize(stride * static_cast<std::size_t>(display.height));
  for_each_band(display.width, display.height, [&](int first_row, int last_row) {
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
  });
}

void CpuWarper::State::resolve(Frame& frame) {
  begin_frame(frame, display.width, display.height);
  frame.statistics = statistics;
  std::atomic<std::uint64_t> cracks{0}, uncovered{0};
  for_each_band(frame.width, frame.height, [&](int first_row, int last_row) {
    const ResolveCounts counts = resolve_rows(keys.data(), first_row, last_row, background, frame);
    cracks += counts.crack_pixels;
    uncovered += counts.uncovered_pixels;
  });
  const int radius = options.samples_per_pixel == 4 ? 2 * kVoidRadius : kVoidRadius;
  frame.statistics.crack_pixels = cracks;
  frame.statistics.void_pixels = uncovered > 0 ? fill_voids(frame, sky, radius) : 0;
  frame.statistics.background_pixels = uncovered - frame.statistics.void_pixels;
}

void CpuWarper::State::finish(Frame& frame) {
  if (options.samples_per_pixel != 4) {
    resolve(frame);
    if (options.smooth_edges) edges.smooth(frame);
    return;
  }
  resolve(fine);
  frame.statistics = fine.statistics;
  average_samples(fine, frame);
}

CpuWarper::CpuWarper(const CpuWarperOptions& options) : state_(std::make_unique<State>(options)) {
  assert(options.samples_per_pixel == 1 || options.samples_per_pixel == 4);
}
CpuWarper::~CpuWarper() = default;

void CpuWarper::draw(const LeafView& leaf, const Pose& eye, const Display& display, const NearRows* near, Frame& frame) {
  assert(display.width > 0 && display.height > 0);
  state_->arena.execute([&] {
    state_->scatter(leaf, eye, display, near);
    state_->finish(frame);
  });
}

}  // namespace farfield::client
