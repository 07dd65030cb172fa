// SPDX-License-Identifier: Apache-2.0
#include "client/warp/smooth_edges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "client/warp/light_tables.h"

namespace farfield::client {
namespace {

// Disparity jumps where it changes by more than this share beside what slopes explain: some thirty times what the distance
// penalty of splats (kDistancePenalty) makes of one surface, and about what coding leaves between two samples of the surfaces
// next to a cell.
constexpr float kJump = 1.0f / 256;
// A slope changes little from pixel to pixel; what it does not tell by half is a jump.
constexpr float kSteeper = 2;
// Fainter steps, in codes of the sharpest channel, are left alone: blended, they would change by less than half of it.
constexpr int kContrast = 8;
// Longer steps are as good as straight, and to look for their ends would take longer than to draw them.
constexpr int kLongest = 256;

constexpr std::uint8_t kLeft = 1, kAbove = 2;  // edges between a pixel and its neighbour there
constexpr int kBandRows = 32;

/// Whether disparity jumps between b and c, in a row a b c d: by more than a surface's slope on either side tells.
inline bool is_jump(float a, float b, float c, float d) {
  const float jump = std::abs(c - b), slope = std::min(std::abs(b - a), std::abs(d - c));
  return jump > kSteeper * slope + kJump * std::max(b, c);
}

void mark_row(const Frame& frame, int y, std::uint8_t* __restrict marks) {
  const int width = frame.width;
  const auto row = [&](int at) { return frame.disparity.data() + static_cast<std::size_t>(std::clamp(at, 0, frame.height - 1)) * width; };
  const float* __restrict here = row(y);
  const float* __restrict above = row(y - 1);
  const float* __restrict above2 = row(y - 2);
  const float* __restrict below = row(y + 1);
  for (int x = 0; x < width; ++x) marks[x] = is_jump(above2[x], above[x], here[x], below[x]) ? kAbove : 0;
  for (int x = 2; x + 1 < width; ++x) marks[x] |= is_jump(here[x - 2], here[x - 1], here[x], here[x + 1]) ? kLeft : 0;
}

int contrast(const std::uint8_t* a, const std::uint8_t* b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Calls f(x) for all bytes of the row that are not 0.
template <class F>
void for_each_marked(const std::uint8_t* marks, int width, F&& f) {
  for (int x = 0; x < width;) {
    if (std::uint64_t eight = 0; x + 8 <= width && (std::memcpy(&eight, marks + x, 8), eight == 0)) {
      x += 8;
      continue;
    }
    const int end = std::min(x + 8, width);
    for (; x < end; ++x)
      if (marks[x]) f(x);
  }
}

void drop_faint(const Frame& frame, int y, std::uint8_t* marks) {
  const std::uint8_t* row = frame.rgba.data() + static_cast<std::size_t>(y) * frame.width * 4;
  for_each_marked(marks, frame.width, [&](int x) {
    const std::uint8_t* here = row + 4 * x;
    if (marks[x] & kLeft && contrast(here, here - 4) < kContrast) marks[x] &= static_cast<std::uint8_t>(~kLeft);
    if (marks[x] & kAbove && contrast(here, here - 4 * static_cast<std::size_t>(frame.width)) < kContrast) marks[x] &= static_cast<std::uint8_t>(~kAbove);
  });
}

/// The area between a step's boundary and a line from height `from` at its pixel's near side to `to` at its far side:
/// on the upper side of the boundary, and on the lower.
struct Areas {
  float upper = 0, lower = 0;
  void add(float from, float to, float width) {
    if (from >= 0 && to >= 0) {
      upper += 0.5f * (from + to) * width;
    } else if (from <= 0 && to <= 0) {
      lower -= 0.5f * (from + to) * width;
    } else {
      const float crossing = from / (from - to);
      const float first = 0.5f * from * crossing * width, second = 0.5f * to * (1 - crossing) * width;
      if (from > 0) upper += first, lower -= second;
      else lower -= first, upper += second;
    }
  }
};

/// Areas of the pixel `at` of a step of `length` pixels whose line starts at height `from` and ends at `to`: straight if
/// they lie on different sides, else down to the boundary in the middle.
Areas areas_of(int at, int length, float from, float to) {
  Areas result;
  const float n = static_cast<float>(length), x = static_cast<float>(at);
  if (from * to < 0) {
    const float slope = (to - from) / n;
    result.add(from + slope * x, from + slope * (x + 1), 1);
    return result;
  }
  const float middle = 0.5f * n;
  if (x < middle) {
    const float end = std::min(x + 1, middle);
    result.add(from * (1 - x / middle), from * (1 - end / middle), end - x);
  }
  if (x + 1 > middle) {
    const float begin = std::max(x, middle);
    result.add(to * (begin / middle - 1), to * ((x + 1) / middle - 1), x + 1 - begin);
  }
  return result;
}

}  // namespace

/// Finds steps. In what follows a boundary runs between two lines of pixels, upper and lower; for columns they are the left
/// and the right one.
class EdgeSmoother::Steps {
 public:
  Steps(const Frame& frame, const std::uint8_t* edges, Band& band) : frame_(frame), edges_(edges), band_(band) {}

  void find() {
    const int width = frame_.width, height = frame_.height;
    for (int y = std::max(band_.first_row, 1); y <= std::min(band_.last_row, height - 1); ++y)
      for_each_marked(edges_ + static_cast<std::size_t>(y) * width, width, [&](int x) {
        if (is_edge(x, y, kAbove) && (x == 0 || !is_edge(x - 1, y, kAbove) || crosses(x, y, kAbove))) take(x, y, kAbove);
      });
    for (int y = band_.first_row; y < band_.last_row; ++y)
      for_each_marked(edges_ + static_cast<std::size_t>(y) * width, width, [&](int x) {
        if (!is_edge(x, y, kLeft)) return;
        if (y == 0 || !is_edge(x, y - 1, kLeft) || crosses(x, y, kLeft)) take(x, y, kLeft);
        else if (y == band_.first_row) take_from_above(x, y);
      });
  }

 private:
  bool is_edge(int x, int y, std::uint8_t side) const { return edges_[static_cast<std::size_t>(y) * frame_.width + x] & side; }
  // Edges that cross the boundary at the near end of its pixel (x, y): on the upper line, on the lower.
  bool crosses_upper(int x, int y, std::uint8_t side) const { return side == kAbove ? is_edge(x, y - 1, kLeft) : is_edge(x - 1, y, kAbove); }
  bool crosses_lower(int x, int y, std::uint8_t side) const { return is_edge(x, y, side == kAbove ? kLeft : kAbove); }
  bool crosses(int x, int y, std::uint8_t side) const { return crosses_upper(x, y, side) || crosses_lower(x, y, side); }
  /// Where the line meets the end of a step: half a pixel on the side of the edge that crosses; 0: none, or both.
  float height_at(int x, int y, std::uint8_t side) const {
    const bool upper = crosses_upper(x, y, side), lower = crosses_lower(x, y, side);
    return upper == lower ? 0.0f : upper ? 0.5f : -0.5f;
  }

  /// A step that begins in an earlier band.
  void take_from_above(int x, int y) {
    int top = y;
    while (top > 0 && is_edge(x, top - 1, kLeft) && !crosses(x, top, kLeft)) --top;
    take(x, top, kLeft);
  }

  void take(int x, int y, std::uint8_t side) {
    const int along_x = side == kAbove, along_y = 1 - along_x;
    const int most = side == kAbove ? frame_.width - x : frame_.height - y;
    int length = 1;
    while (length < most && is_edge(x + along_x * length, y + along_y * length, side) && !crosses(x + along_x * length, y + along_y * length, side)) ++length;
    if (length > kLongest) return;
    const float from = height_at(x, y, side);
    const float to = length < most ? height_at(x + along_x * length, y + along_y * length, side) : 0.0f;
    if (!(std::abs(from) + std::abs(to) > 0)) return;
    const int across = side == kAbove ? frame_.width : 1;
    for (int at = 0; at < length; ++at) {
      const Areas areas = areas_of(at, length, from, to);
      const int row = y + along_y * at;
      const int lower = row * frame_.width + x + along_x * at, upper = lower - across;
      blend(upper, lower, areas.upper);
      blend(lower, upper, areas.lower);
    }
  }

  void blend(int pixel, int neighbour, float area) {
    if (!(area > 0.01f) || pixel < band_.first_row * frame_.width || pixel >= band_.last_row * frame_.width) return;
    std::uint32_t colour;
    std::memcpy(&colour, &frame_.rgba[4 * static_cast<std::size_t>(neighbour)], 4);
    band_.blends.push_back({static_cast<std::uint32_t>(pixel), colour, area});
  }

  const Frame& frame_;
  const std::uint8_t* edges_;
  Band& band_;
};

void EdgeSmoother::smooth(Frame& frame) {
  if (frame.width < 3 || frame.height < 2) return;
  edges_.resize(frame.pixels());
  const int bands = (frame.height + kBandRows - 1) / kBandRows;
  bands_.resize(static_cast<std::size_t>(bands));
  tbb::parallel_for(0, bands, [&](int b) {
    Band& band = bands_[b];
    band.first_row = b * kBandRows, band.last_row = std::min((b + 1) * kBandRows, frame.height);
    for (int y = band.first_row; y < band.last_row; ++y) {
      std::uint8_t* marks = edges_.data() + static_cast<std::size_t>(y) * frame.width;
      mark_row(frame, y, marks);
      drop_faint(frame, y, marks);
    }
  });
  tbb::parallel_for(0, bands, [&](int b) {
    bands_[b].blends.clear();
    Steps(frame, edges_.data(), bands_[b]).find();
  });
  const LightTables& tables = LightTables::get();
  tbb::parallel_for(0, bands, [&](int b) {
    for (const Blend& blend : bands_[b].blends) {
      std::uint8_t* pixel = frame.rgba.data() + 4 * static_cast<std::size_t>(blend.pixel);
      for (int c = 0; c < 3; ++c) {
        const float own = tables.linear[pixel[c]], other = tables.linear[blend.colour >> (8 * c) & 255];
        pixel[c] = tables.code[static_cast<std::size_t>(own + blend.share * (other - own)) >> (16 - LightTables::kCodeBits)];
      }
    }
  });
}

}  // namespace farfield::client
