// SPDX-License-Identifier: Apache-2.0
#include "client/warp/scatter.h"

#include <algorithm>
#include <array>

#include "client/warp/run_clipper.h"
#include "client/warp/wide_splats.h"

namespace farfield::client {
namespace {

/// Collects samples until a piece is full, then draws them; about 40 kB.
class SplatWriter {
 public:
  SplatWriter(const Splats& splats, const TileProjection& projection, const PixelWindow& window,
              ProjectionKernel kernel, std::uint64_t* keys)
      : splats_(splats), projection_(projection), window_(window), is_scalar_(kernel == ProjectionKernel::kScalar),
        keys_(keys) {
    for (int k = 0; k < 3; ++k) {
      row_projection_.step_u[k] = static_cast<float>(projection.per_u[k] * splats.pitch);
      row_projection_.step_v[k] = static_cast<float>(projection.per_v[k] * splats.pitch);
      row_projection_.per_disparity[k] = static_cast<float>(projection.per_disparity[k]);
    }
    row_projection_.disparity_scale = static_cast<float>(projection.disparity_scale);
    samples_.count = 0;
  }

  /// Samples [begin, end) of a run.
  void append(const SplatRun& run, std::uint32_t begin, std::uint32_t end) {
    if (samples_.count > 0 && first_ + samples_.count != run.first + begin) flush();
    while (begin < end) {
      if (samples_.count == 0) first_ = run.first + begin;
      const std::uint32_t room = static_cast<std::uint32_t>(kRowPiece - samples_.count);
      // Counted from a fixed sample whatever part of the run is drawn: rounding must not differ between bands.
      const std::uint32_t block = begin / kRowPiece * kRowPiece;
      const std::uint32_t count = std::min({end - begin, room, block + kRowPiece - begin});
      place(run, block, begin - block, count);
      begin += count;
      if (samples_.count == kRowPiece) flush();
    }
  }

  /// Draws what was collected.
  void flush() {
    if (samples_.count == 0) return;
    samples_.disparity = splats_.disparity.data() + first_;
    samples_.slopes = splats_.slopes.data() + first_;
    samples_.colour_up = splats_.colour_up.data() + first_;
    samples_.colour_down = splats_.colour_down.data() + first_;
    samples_.reach = splats_.reach.data() + first_;
    const std::size_t before = first_ > 0 ? 1 : 0;
    const std::size_t last = std::min(first_ + samples_.count + 1, splats_.size());
    std::copy(splats_.colour.data() + first_ - before, splats_.colour.data() + last, colours_.data() + 1 - before);
    samples_.colour = colours_.data() + 1;
    samples_.colour_left = colours_.data(), samples_.colour_right = colours_.data() + 2;

    (is_scalar_ ? project_row_scalar : project_row)(row_projection_, window_, samples_, row_);
    (is_scalar_ ? sample_pixels_scalar : sample_pixels)(row_, samples_, window_.width, 0, 0, pixels_);
    write_pixels(pixels_, samples_.count, hits_, keys_);
    take_wide();
    samples_.count = 0;
  }

  void finish() {
    flush();
    draw_wide();
  }

 private:
  void take_wide() {
    const int found = find_non_negative(row_.wide, samples_.count, hits_);
    for (int k = 0; k < found; ++k) {
      wide_.append(row_, samples_, hits_[k]);
      if (wide_.is_full()) draw_wide();
    }
  }
  void draw_wide() {
    wide_.draw(is_scalar_ ? sample_pixels_scalar : sample_pixels, window_.width, pixels_, wide_hits_, keys_);
  }

  /// Where `count` samples from number block + from of the run would be if they were at infinity.
  void place(const SplatRun& run, std::uint32_t block, std::uint32_t from, std::uint32_t count) {
    const glm::vec3 start(projection_.at(run.u0 + static_cast<double>(splats_.pitch) * block, run.v, 0));
    float* x = samples_.infinity_x.data() + samples_.count;
    float* y = samples_.infinity_y.data() + samples_.count;
    float* w = samples_.infinity_w.data() + samples_.count;
    const RowProjection& p = row_projection_;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float at = static_cast<float>(static_cast<int>(from + i));
      x[i] = start.x + at * p.step_u[0];
      y[i] = start.y + at * p.step_u[1];
      w[i] = start.z + at * p.step_u[2];
    }
    samples_.count += static_cast<int>(count);
  }

  const Splats& splats_;
  const TileProjection& projection_;
  const PixelWindow window_;
  const bool is_scalar_;
  std::uint64_t* keys_;
  RowProjection row_projection_;
  std::size_t first_ = 0;  // of samples_, in the tile's arrays
  RowSamples samples_;
  ProjectedRow row_;
  SplatPixels pixels_;
  std::array<std::uint32_t, kRowPiece + 2> colours_;  // of the piece, with the sample before and after it
  WideSplats wide_;
  RowIndices hits_, wide_hits_;
};

}  // namespace

void scatter_tile(const Splats& splats, const TileProjection& projection, const PixelWindow& window,
                  ProjectionKernel kernel, std::uint64_t* keys) {
  constexpr std::uint32_t kLongRun = 24;  // for shorter runs clipping costs as much as it saves
  const RunClipper clipper(projection, splats, window);
  SplatWriter writer(splats, projection, window, kernel, keys);
  for (const SplatRun& run : splats.runs) {
    std::uint32_t begin = 0, end = run.count;
    if (run.count >= kLongRun) {
      const SampleRange range = clipper.clip(run);
      if (!(range.first <= range.last)) continue;
      begin = static_cast<std::uint32_t>(range.first);
      end = static_cast<std::uint32_t>(range.last) + 1;
    }
    writer.append(run, begin, end);
  }
  writer.finish();
}

}  // namespace farfield::client
