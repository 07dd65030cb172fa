// SPDX-License-Identifier: Apache-2.0
#include "client/warp/scatter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "client/warp/block_culler.h"
#include "client/warp/piece_on_screen.h"
#include "client/warp/splat_pixel.h"
#include "client/warp/wide_splats.h"
#include "client/warp/write_pixels.h"

namespace farfield::client {
namespace {

/// Collects samples, wherever they stand in the tile, until a piece is full, then draws them; about 40 kB.
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
    samples_.disparity = disparities_.data();
    samples_.colour = colours_.data();
    samples_.colour_left = colour_left_.data(), samples_.colour_right = colour_right_.data();
    samples_.reach = reaches_.data();
    samples_.slope_u = slope_u_.data(), samples_.slope_v = slope_v_.data();
    samples_.colour_up = colour_up_.data(), samples_.colour_down = colour_down_.data();
  }

  /// Samples [begin, end) of a run. Requires: they come after all appended before.
  void append(const SplatRun& run, std::uint32_t begin, std::uint32_t end) {
    while (begin < end) {
      const std::uint32_t room = static_cast<std::uint32_t>(kRowPiece - samples_.count);
      // Counted from a fixed sample whatever part of the run is drawn: rounding must not differ between bands.
      const std::uint32_t block = begin / kRowPiece * kRowPiece;
      const std::uint32_t count = std::min({end - begin, room, block + kRowPiece - begin});
      gather(run.first + begin, count);
      place(run, block, begin - block, count);
      begin += count;
      if (samples_.count == kRowPiece) flush();
    }
  }

  /// Draws what was collected.
  void flush() {
    if (samples_.count == 0) return;
    fill_up();
    find_slopes();
    (is_scalar_ ? project_row_scalar : project_row)(row_projection_, window_, samples_, row_);
    for (int line = 0; line <= (row_.second_line ? 1 : 0); ++line) {
      for (int column = 0; column <= (row_.second_column ? 1 : 0); ++column) draw_pixels(column, line);
    }
    draw_wide();
    samples_.count = 0;
  }

 private:
  /// Makes the piece whole vectors, by samples behind the eye: what is left over costs a vectorised loop as much as
  /// several vectors do.
  void fill_up() {
    for (; samples_.count % kVectorSamples != 0; ++samples_.count) {
      samples_.infinity_x[samples_.count] = samples_.infinity_y[samples_.count] = 0;
      samples_.infinity_w[samples_.count] = -1e30f;
    }
  }

  /// Copies `count` samples from number `first` of the tile's arrays, and their neighbours, to the end of the piece.
  void gather(std::size_t first, std::size_t count) {
    const auto to = static_cast<std::size_t>(samples_.count);
    copy_some(splats_.disparity, first, count, &disparities_[to]);
    copy_some(splats_.colour, first, count, &colours_[to]);
    copy_some(splats_.reach, first, count, &reaches_[to]);
    const std::size_t no_left = first == 0 ? 1 : 0;  // the first of all has none, and says so in its reach
    copy_some(splats_.disparity, first + no_left - 1, count - no_left, &disparity_left_[to + no_left]);
    copy_some(splats_.colour, first + no_left - 1, count - no_left, &colour_left_[to + no_left]);
    const std::size_t no_right = first + count == splats_.size() ? 1 : 0;
    copy_some(splats_.disparity, first + 1, count - no_right, &disparity_right_[to]);
    copy_some(splats_.colour, first + 1, count - no_right, &colour_right_[to]);
    gather_along_v(first, count, to);
  }

  /// Disparities and colours above and below, by the tile's links.
  void gather_along_v(std::size_t first, std::size_t count, std::size_t to) {
    const std::vector<SplatLink>& links = splats_.links;
    while (link_ + 1 < links.size() && links[link_ + 1].first <= first) ++link_;
    for (std::size_t i = 0; i < count;) {
      const std::size_t next = link_ + 1 < links.size() ? links[link_ + 1].first - first : count;
      const std::size_t length = std::min(next, count) - i;
      const std::size_t above = first + i - links[link_].up, below = first + i + links[link_].down;
      copy_some(splats_.disparity, above, length, &disparity_up_[to + i]);
      copy_some(splats_.colour, above, length, &colour_up_[to + i]);
      copy_some(splats_.disparity, below, length, &disparity_down_[to + i]);
      copy_some(splats_.colour, below, length, &colour_down_[to + i]);
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

  /// Slopes, and colours above and below, of what is connected.
  void find_slopes() {
    const auto connected = [](std::uint32_t reach, int shift) { return mask_of((reach >> shift & 15) == kReachConnected); };
    const auto slope = [](int has_before, int has_after, float at_before, float own, float at_after) {
      const float from = std::bit_cast<float>(select(has_before, std::bit_cast<int>(at_before), std::bit_cast<int>(own)));
      const float to = std::bit_cast<float>(select(has_after, std::bit_cast<int>(at_after), std::bit_cast<int>(own)));
      return (to - from) * (1.0f + 0.5f * static_cast<float>(has_before & has_after));  // over one sample or two
    };
    const std::uint16_t* __restrict reaches = reaches_.data();
    const float* __restrict disparity = disparities_.data();
    const std::uint32_t* __restrict colour = colours_.data();
#pragma GCC ivdep  // none of these overlap
    for (int i = 0; i < samples_.count; ++i) {
      const std::uint32_t reach = reaches[i];
      const int up = connected(reach, 8), down = connected(reach, 12);
      slope_u_[i] = slope(connected(reach, 0), connected(reach, 4), disparity_left_[i], disparity[i], disparity_right_[i]);
      slope_v_[i] = slope(up, down, disparity_up_[i], disparity[i], disparity_down_[i]);
      colour_up_[i] = select(up, colour_up_[i], colour[i]);
      colour_down_[i] = select(down, colour_down_[i], colour[i]);
    }
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
  RowSamples samples_;
  ProjectedRow row_;
  SplatPixels pixels_;
  static constexpr std::size_t kCopied = 8;
  template <class T>
  using Piece = std::array<T, kRowPiece + kCopied>;
  std::size_t link_ = 0;  // of the tile's links: that of the last sample gathered, or before
  Piece<std::uint16_t> reaches_{};
  Piece<float> disparities_{}, disparity_left_{}, disparity_right_{}, disparity_up_{}, disparity_down_{};
  Piece<float> slope_u_, slope_v_;
  Piece<std::uint32_t> colours_{}, colour_left_{}, colour_right_{}, colour_up_{}, colour_down_{};
  RowIndices hits_;
};

template <class Draw>
void draw_pieces(const Splats& splats, const TileProjection& projection, const PixelWindow& window, std::size_t square, Draw&& draw) {
  const SurfacePieces& pieces = splats.pieces;
  PlacedPiece placed;
  for (std::size_t p = pieces.squares[square].first_piece; p < pieces.piece_end(square); ++p) {
    if (place_piece(projection, splats, pieces.squares[square], pieces.pieces[p], window, placed)) draw(placed);
  }
}

}  // namespace

void scatter_tile(const Splats& splats, const TileProjection& projection, const PixelWindow& window,
                  ProjectionKernel kernel, ShownDepths& shown, std::uint64_t* keys) {
  if (kernel == ProjectionKernel::kScalar) {  // the reference leaves nothing out
    for (std::size_t s = 0; s < splats.pieces.squares.size(); ++s)
      draw_pieces(splats, projection, window, s, [&](const PlacedPiece& placed) { draw_piece_scalar(placed, window.width, keys); });
    SplatWriter writer(splats, projection, window, kernel, keys);
    for (const SplatRun& run : splats.runs) writer.append(run, 0, run.count);
    writer.flush();
    return;
  }
  for_each_visible_square(projection, splats, window, shown, [&](std::size_t s) {
    draw_pieces(splats, projection, window, s, [&](const PlacedPiece& placed) {
      const PixelRectangle pixels{placed.left, placed.right, placed.top, placed.bottom};
      if (draw_piece(placed, window.width, keys)) shown.drawn(pixels);
    });
  });
  const VisibleBlocks visible = find_visible_blocks(projection, splats, window, shown);
  if (std::all_of(visible.begin(), visible.end(), [](std::uint32_t row) { return row == 0; })) return;
  SplatWriter writer(splats, projection, window, kernel, keys);
  const auto edge = static_cast<std::uint32_t>(splats.blocks.edge);
  for (int row = 0; row < splats.blocks.rows; ++row) {
    if (visible[row] == 0) continue;
    for (std::uint32_t r = splats.blocks.first_run[row]; r < splats.blocks.first_run[row + 1]; ++r) {
      const SplatRun& run = splats.runs[r];
      const auto column = static_cast<std::uint32_t>(first_column(splats, run)), end = column + run.count;
      for (std::uint32_t blocks = visible[row]; blocks != 0;) {  // as many at once as follow each other
        const auto first = static_cast<std::uint32_t>(std::countr_zero(blocks));
        const auto after = first + static_cast<std::uint32_t>(std::countr_one(blocks >> first));
        const std::uint32_t from = std::max(first * edge, column), to = std::min(after * edge, end);
        if (from < to) writer.append(run, from - column, to - column);
        blocks &= ~std::uint32_t{0} << after;
      }
    }
  }
  writer.flush();
}

}  // namespace farfield::client
