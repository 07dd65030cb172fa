// SPDX-License-Identifier: Apache-2.0
#include "client/warp/scatter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "client/warp/run_clipper.h"
#include "client/warp/splat_pixel.h"
#include "client/warp/wide_splats.h"
#include "client/warp/write_pixels.h"

namespace farfield::client {
namespace {

/// Collects samples until a piece is full, then draws them; about 50 kB.
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
    samples_.disparity = disparities_.data() + 1;
    samples_.colour = colours_.data() + 1;
    samples_.colour_left = colours_.data(), samples_.colour_right = colours_.data() + 2;
    samples_.reach = reaches_.data();
    samples_.slope_u = slope_u_.data(), samples_.slope_v = slope_v_.data();
    samples_.colour_up = colour_up_.data(), samples_.colour_down = colour_down_.data();
  }

  /// Samples [begin, end) of a run. Requires: they come after all appended before.
  void append(const SplatRun& run, std::uint32_t begin, std::uint32_t end) {
    if (samples_.count > 0) skip_to(run.first + begin);
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
    expand(fill_up());
    (is_scalar_ ? project_row_scalar : project_row)(row_projection_, window_, samples_, row_);
    for (int line = 0; line <= (row_.second_line ? 1 : 0); ++line) {
      for (int column = 0; column <= (row_.second_column ? 1 : 0); ++column) draw_pixels(column, line);
    }
    draw_wide();
    samples_.count = 0;
  }

 private:
  /// Fills a small gap, as between the rows of a dense tile, with samples behind the eye: cheaper than another piece.
  void skip_to(std::size_t index) {
    constexpr std::size_t kSmallGap = 8;
    const std::size_t next = first_ + static_cast<std::size_t>(samples_.count), gap = index - next;
    if (gap > kSmallGap || static_cast<std::size_t>(samples_.count) + gap >= kRowPiece) {
      flush();
      return;
    }
    while (samples_.count < static_cast<int>(index - first_)) put_nothing();
  }

  /// Makes the piece whole vectors, by samples behind the eye: what is left over costs a vectorised loop as much as
  /// several vectors do. Returns: how many samples it held before.
  std::size_t fill_up() {
    const int count = samples_.count;
    while (samples_.count % kVectorSamples != 0) put_nothing();
    return static_cast<std::size_t>(count);
  }
  void put_nothing() {
    samples_.infinity_x[samples_.count] = samples_.infinity_y[samples_.count] = 0;
    samples_.infinity_w[samples_.count] = -1e30f;
    ++samples_.count;
  }

  /// From the tile's compact arrays to what the kernels read.
  void expand(std::size_t count) {
    const std::size_t before = first_ > 0 ? 1 : 0, last = std::min(first_ + count + 1, splats_.size());
    std::copy(splats_.disparity.data() + first_ - before, splats_.disparity.data() + last, disparities_.data() + 1 - before);
    std::copy(splats_.colour.data() + first_ - before, splats_.colour.data() + last, colours_.data() + 1 - before);
    std::copy_n(splats_.reach.data() + first_, count, reaches_.data());
    gather_along_v(count);
    const auto connected = [](std::uint32_t reach, int shift) { return mask_of((reach >> shift & 15) == kReachConnected); };
    const auto slope = [](int has_before, int has_after, float at_before, float own, float at_after) {
      const float from = std::bit_cast<float>(select(has_before, std::bit_cast<int>(at_before), std::bit_cast<int>(own)));
      const float to = std::bit_cast<float>(select(has_after, std::bit_cast<int>(at_after), std::bit_cast<int>(own)));
      return (to - from) * (1.0f + 0.5f * static_cast<float>(has_before & has_after));  // over one sample or two
    };
    const std::uint16_t* __restrict reaches = reaches_.data();
    const float* __restrict disparity = disparities_.data() + 1;
    const std::uint32_t* __restrict colour = colours_.data() + 1;
#pragma GCC ivdep  // none of these overlap
    for (int i = 0; i < samples_.count; ++i) {
      const std::uint32_t reach = reaches[i];
      const int up = connected(reach, 8), down = connected(reach, 12);
      slope_u_[i] = slope(connected(reach, 0), connected(reach, 4), disparity[i - 1], disparity[i], disparity[i + 1]);
      slope_v_[i] = slope(up, down, disparity_up_[i], disparity[i], disparity_down_[i]);
      colour_up_[i] = select(up, colour_up_[i], colour[i]);
      colour_down_[i] = select(down, colour_down_[i], colour[i]);
    }
  }

  /// Disparities and colours above and below the piece's samples, by the tile's links.
  void gather_along_v(std::size_t count) {
    const std::vector<SplatLink>& links = splats_.links;
    while (link_ + 1 < links.size() && links[link_ + 1].first <= first_) ++link_;
    for (std::size_t i = 0; i < count;) {
      const std::size_t next = link_ + 1 < links.size() ? links[link_ + 1].first - first_ : count;
      const std::size_t length = std::min(next, count) - i;
      const std::size_t above = first_ + i - links[link_].up, below = first_ + i + links[link_].down;
      copy_some(splats_.disparity, above, length, disparity_up_.data() + i);
      copy_some(splats_.colour, above, length, colour_up_.data() + i);
      copy_some(splats_.disparity, below, length, disparity_down_.data() + i);
      copy_some(splats_.colour, below, length, colour_down_.data() + i);
      i += length;
      if (i < count) ++link_;
    }
  }
  /// Copies `count` values, and up to kCopied - 1 more: most links are short, and a loop of fixed steps is fast.
  template <class T>
  static void copy_some(const std::vector<T>& from, std::size_t at, std::size_t count, T* to) {
    if (at + count + kCopied > from.size()) {
      std::copy_n(from.data() + at, count, to);
      return;
    }
    for (std::size_t i = 0; i < count; i += kCopied) std::memcpy(to + i, from.data() + at + i, kCopied * sizeof(T));
  }

  /// Of every splat, the pixel at this place of its rectangle.
  void draw_pixels(int column, int line) {
    (is_scalar_ ? sample_pixels_scalar : sample_pixels)(row_, samples_, window_.width, column, line, pixels_);
    write_pixels(pixels_, samples_.count, hits_, keys_);
  }

  void draw_wide() {
    if (is_scalar_) {
      draw_wide_splats_scalar(row_, samples_, window_.width, keys_);
      return;
    }
    const int found = find_non_negative(row_.wide.data(), samples_.count, hits_.data());
    for (int k = 0; k < found; ++k) draw_wide_splat(row_, samples_, hits_[k], window_.width, keys_);
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
  static constexpr std::size_t kCopied = 8;
  template <class T>
  using Piece = std::array<T, kRowPiece + kCopied>;
  std::size_t link_ = 0;  // of the tile's links: that of sample first_, or before
  Piece<float> disparities_{};       // of the piece, with the sample before and after it
  Piece<std::uint32_t> colours_{};   // likewise
  Piece<std::uint16_t> reaches_{};
  Piece<float> disparity_up_{}, disparity_down_{}, slope_u_, slope_v_;
  Piece<std::uint32_t> colour_up_{}, colour_down_{};
  RowIndices hits_;
};

}  // namespace

void scatter_tile(const Splats& splats, const TileProjection& projection, const PixelWindow& window,
                  ProjectionKernel kernel, std::uint64_t* keys) {
  constexpr std::uint32_t kLongRun = 24;  // in shorter runs there is little to clip
  const RunClipper clipper(projection, splats, window);
  SplatWriter writer(splats, projection, window, kernel, keys);
  for (const SplatRun& run : splats.runs) {
    if (clipper.is_outside(run)) continue;
    std::uint32_t begin = 0, end = run.count;
    if (run.count >= kLongRun) {
      const SampleRange range = clipper.clip(run);
      if (!(range.first <= range.last)) continue;
      begin = static_cast<std::uint32_t>(range.first);
      end = static_cast<std::uint32_t>(range.last) + 1;
    }
    writer.append(run, begin, end);
  }
  writer.flush();
}

}  // namespace farfield::client
