// SPDX-License-Identifier: Apache-2.0
#include "client/warp/fill_voids.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace farfield::client {
namespace {

struct Filling {
  std::size_t pixel = 0, source = 0;  // the pixel takes the source's surface
};

bool is_covered(Coverage c) { return c != Coverage::kBackground; }

/// Which squares of radius × radius pixels hold anything: far from everything, nothing encloses.
class Occupancy {
 public:
  Occupancy(const Frame& frame, int radius)
      : radius_(radius), columns_((frame.width + radius - 1) / radius), rows_((frame.height + radius - 1) / radius) {
    states_.resize(static_cast<std::size_t>(columns_) * rows_);
    tbb::parallel_for(0, rows_, [&](int row) {
      // By columns of pixels first, which is vectorised, then by squares.
      const auto width = static_cast<std::size_t>(frame.width);
      std::vector<std::uint8_t> found(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(radius_), 0);
      for (int y = row * radius; y < std::min((row + 1) * radius, frame.height); ++y) {
        const Coverage* __restrict line = frame.coverage.data() + static_cast<std::size_t>(y) * width;
        std::uint8_t* __restrict states = found.data();
        for (std::size_t x = 0; x < width; ++x) states[x] |= is_covered(line[x]) ? kSomeCovered : kSomeOpen;
      }
      for (int column = 0; column < columns_; ++column) {
        const std::uint8_t* first = found.data() + static_cast<std::size_t>(column) * static_cast<std::size_t>(radius);
        std::uint8_t& state = states_[static_cast<std::size_t>(row) * columns_ + column];
        for (int x = 0; x < radius; ++x) state |= first[x];
      }
    });
  }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool has_open(int column, int row) const { return states_[static_cast<std::size_t>(row) * columns_ + column] & kSomeOpen; }
  bool is_surrounded_by_nothing(int column, int row) const {
    for (int j = std::max(row - 1, 0); j <= std::min(row + 1, rows_ - 1); ++j) {
      for (int i = std::max(column - 1, 0); i <= std::min(column + 1, columns_ - 1); ++i) {
        if (states_[static_cast<std::size_t>(j) * columns_ + i] & kSomeCovered) return false;
      }
    }
    return true;
  }

 private:
  static constexpr std::uint8_t kSomeCovered = 1, kSomeOpen = 2;

  int radius_, columns_, rows_;
  std::vector<std::uint8_t> states_;
};

constexpr std::size_t kNone = ~std::size_t{0};

/// Looks from (x, y) in eight directions. Returns: the pixel whose surface fills it, or kNone if there is none so near.
std::size_t find_source(const Frame& frame, int x, int y, int radius) {
  constexpr std::array<std::array<int, 2>, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  std::size_t farthest = kNone, farthest_near = kNone;
  const auto look = [&](int dx, int dy) {
    int i = x, j = y;
    for (int step = 1; step <= radius; ++step) {
      i += dx;
      j += dy;
      if (i < 0 || j < 0 || i >= frame.width || j >= frame.height) return kNone;
      const std::size_t at = static_cast<std::size_t>(j) * frame.width + i;
      if (is_covered(frame.coverage[at])) return at;
    }
    return kNone;
  };
  const auto consider = [&](std::size_t at) {
    if (at == kNone) return;
    std::size_t& best = frame.coverage[at] == Coverage::kNear ? farthest_near : farthest;
    if (best == kNone || frame.disparity[at] < frame.disparity[best]) best = at;
  };
  for (const auto& [dx, dy] : kDirections) {
    consider(look(dx, dy));
    consider(look(-dx, -dy));
  }
  return farthest != kNone ? farthest : farthest_near;
}

void copy_pixel(Frame& frame, const Filling& filling) {
  std::memcpy(&frame.rgba[4 * filling.pixel], &frame.rgba[4 * filling.source], 4);
  frame.disparity[filling.pixel] = frame.disparity[filling.source];
  frame.coverage[filling.pixel] = Coverage::kVoidFilled;
}

/// Fills all that is left and cannot be sky, however far from any surface: along each row from whichever end is farther
/// away, and rows without any surface from the row above, or below. A frame with nothing in it keeps its colour.
std::uint64_t fill_rest(Frame& frame, const SkyTest& sky) {
  std::uint64_t filled = 0;
  const auto width = static_cast<std::size_t>(frame.width);
  std::vector<std::uint8_t> has_surface(frame.height, 0);
  for (int y = 0; y < frame.height; ++y) {
    const std::size_t begin = y * width, end = begin + width;
    std::size_t left = kNone;
    for (std::size_t at = begin; at < end;) {
      if (is_covered(frame.coverage[at]) || sky.may_be_sky(static_cast<int>(at - begin), y)) {
        if (is_covered(frame.coverage[at])) left = at;
        ++at;
        continue;
      }
      std::size_t right = at;
      while (right < end && !is_covered(frame.coverage[right]) && !sky.may_be_sky(static_cast<int>(right - begin), y)) ++right;
      std::size_t source = left;
      if (right < end && is_covered(frame.coverage[right]) && (left == kNone || frame.disparity[right] < frame.disparity[left])) source = right;
      filled += right - at;
      for (; at < right; ++at) {
        if (source != kNone) {
          copy_pixel(frame, {at, source});
        } else {
          frame.coverage[at] = Coverage::kVoidFilled;  // its colour follows from another row
        }
      }
      if (source != kNone) left = at - 1;
    }
    has_surface[y] = left != kNone || std::none_of(frame.coverage.begin() + begin, frame.coverage.begin() + end,
                                                   [](Coverage c) { return c == Coverage::kVoidFilled; });
  }
  const auto copy_row = [&](int to, int from) {
    for (std::size_t x = 0; x < width; ++x)
      if (frame.coverage[to * width + x] == Coverage::kVoidFilled) copy_pixel(frame, {to * width + x, from * width + x});
    has_surface[to] = 1;
  };
  for (int y = 1; y < frame.height; ++y) {
    if (!has_surface[y] && has_surface[y - 1]) copy_row(y, y - 1);
  }
  for (int y = frame.height - 2; y >= 0; --y) {
    if (!has_surface[y] && has_surface[y + 1]) copy_row(y, y + 1);
  }
  return filled;
}

}  // namespace

std::uint64_t fill_voids(Frame& frame, const SkyTest& sky, int radius) {
  const Occupancy occupancy(frame, radius);
  std::vector<std::vector<Filling>> fillings(occupancy.rows());
  std::vector<std::uint8_t> has_rest(occupancy.rows(), 0);
  tbb::parallel_for(0, occupancy.rows(), [&](int row) {
    for (int column = 0; column < occupancy.columns(); ++column) {
      if (!occupancy.has_open(column, row)) continue;
      const int left = column * radius, right = std::min(left + radius, frame.width) - 1;
      const int top = row * radius, bottom = std::min(top + radius, frame.height) - 1;
      const DirectionMask::Share share = sky.share_of_sky(left, right, top, bottom);
      if (share == DirectionMask::Share::kAll) continue;
      const bool is_alone = occupancy.is_surrounded_by_nothing(column, row);
      for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
          const std::size_t at = static_cast<std::size_t>(y) * frame.width + x;
          if (is_covered(frame.coverage[at])) continue;
          if (share == DirectionMask::Share::kUnknown && sky.may_be_sky(x, y)) continue;
          const std::size_t source = is_alone ? kNone : find_source(frame, x, y, radius);
          if (source != kNone) {
            fillings[row].push_back({at, source});
          } else {
            has_rest[row] = 1;
          }
        }
      }
    }
  });
  // Only now: what was filled must not count as a surface for its neighbours.
  std::uint64_t filled = 0;
  for (const auto& list : fillings) {
    filled += list.size();
    for (const Filling& filling : list) copy_pixel(frame, filling);
  }
  const bool any_rest = std::find(has_rest.begin(), has_rest.end(), 1) != has_rest.end();
  if (any_rest) filled += fill_rest(frame, sky);
  return filled;
}

}  // namespace farfield::client
