// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream. Nodes of 32×32 samples in raster order (packed tiles: their 8×8 blocks), each split
// in four while a bit says so, down to 4×4. A leaf codes, for each connected surface in it (found from the coverage
// and the cuts, in raster order of first samples): a bit "plane", then the three parameters as differences from the
// prediction; or, without the bit, one level per sample as the difference from the sample before it.
//
// Units: U = tolerance/256. A plane is value(i, j) = (c + gx·(i - i0) + gy·(j - j0))·U with (i0, j0) the node's corner,
// c a multiple of 32 and gx, gy multiples of 2^slope_shift. Rounding c adds at most tolerance/16, rounding a slope
// over a node of s samples at most (s - 1)·2^(shift-1)/256 tolerances: 0.06 for shift 0 at 32, …, 0.05 for shift 3 at
// 4; so planes are rounded by less than a fifth of the tolerance and the encoder checks the rest exactly.
#include "common/codec/disparity_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "common/codec/bit_coder.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

constexpr int kLargestNode = 32, kSmallestNode = 4;
constexpr int kOffsetShift = 5;
constexpr std::int64_t kLevel = 510;  // a sample's level: twice the tolerance, less a unit each way for float rounding
constexpr std::int64_t kLargestUnits = std::int64_t{1} << 40;

int slope_shift(int node) { return node >= 32 ? 0 : node >= 16 ? 1 : node >= 8 ? 2 : 3; }
int size_class(int node) { return slope_shift(node); }

struct Plane {
  std::int64_t c = 0, gx = 0, gy = 0;  // c at the tile's sample (0, 0), so that planes of different nodes compare
  std::int64_t at(int i, int j) const { return c + gx * i + gy * j; }
};

struct Contexts {
  std::array<BitContext, 16> split{};
  std::array<BitContext, 8> is_plane{};
  std::array<IntegerContext, 8> offset{}, slope_x{}, slope_y{};
  std::array<IntegerContext, 2> level{};
};

std::int64_t round_shift(std::int64_t value, int shift) {
  return shift == 0 ? value : (value + (std::int64_t{1} << (shift - 1))) >> shift;
}

// Counts of non-zero entries in any rectangle of a tile's array, by a summed-area table (Crow 1984).
class AreaCounts {
 public:
  AreaCounts(const std::vector<std::uint8_t>& values, int width, int height)
      : stride_(width + 1), sums_(static_cast<std::size_t>(width + 1) * (height + 1), 0) {
    for (int y = 0; y < height; ++y) {
      int row = 0;
      const std::size_t above = static_cast<std::size_t>(y) * stride_;
      for (int x = 0; x < width; ++x) {
        row += values[static_cast<std::size_t>(y) * width + x] != 0;
        sums_[above + stride_ + x + 1] = sums_[above + x + 1] + row;
      }
    }
  }
  int count(int x, int y, int x_end, int y_end) const {
    const auto at = [&](int i, int j) { return sums_[static_cast<std::size_t>(j) * stride_ + i]; };
    return at(x_end, y_end) - at(x, y_end) - at(x_end, y) + at(x, y);
  }

 private:
  int stride_;
  std::vector<int> sums_;
};

// A sample of a surface: its index in the tile's arrays, and where that is.
struct Member {
  int index, x, y;
};

// The structure both sides share: nodes, surfaces and predictions.
class PlaneTree {
 protected:
  explicit PlaneTree(const Tile& tile)
      : tile_(tile), covered_(tile.coverage, tile.width, tile.height), cut_right_(tile.cut_right, tile.width, tile.height),
        cut_down_(tile.cut_down, tile.width, tile.height), neighbours_(tile), units_(tile.samples(), 0), plane_of_(tile.samples(), -1), label_(tile.samples(), -1) {}

  struct Node {
    int x, y, size;
    int x_end, y_end;
    int depth;
  };
  std::vector<Node> roots() const {
    const int size = tile_.is_packed() ? kBlockSamples : kLargestNode;
    std::vector<Node> nodes;
    for (int y = 0; y < tile_.height; y += size)
      for (int x = 0; x < tile_.width; x += size) nodes.push_back(node_at(x, y, size, 0));
    return nodes;
  }
  Node node_at(int x, int y, int size, int depth) const {
    return {x, y, size, std::min(x + size, tile_.width), std::min(y + size, tile_.height), depth};
  }
  template <class Visit>
  void each_child(const Node& node, Visit visit) const {
    const int half = node.size / 2;
    for (int k = 0; k < 4; ++k) {
      const int x = node.x + (k & 1) * half, y = node.y + (k >> 1) * half;
      if (x < node.x_end && y < node.y_end) visit(node_at(x, y, half, node.depth + 1));
    }
  }
  bool is_empty(const Node& n) const { return covered_.count(n.x, n.y, n.x_end, n.y_end) == 0; }
  // One surface over the whole node: covered everywhere, cut nowhere inside.
  bool is_whole(const Node& n) const {
    return covered_.count(n.x, n.y, n.x_end, n.y_end) == (n.x_end - n.x) * (n.y_end - n.y) &&
           cut_right_.count(n.x, n.y, n.x_end - 1, n.y_end) == 0 && cut_down_.count(n.x, n.y, n.x_end, n.y_end - 1) == 0;
  }
  int index(int x, int y) const { return y * tile_.width + x; }

  // Samples of each connected surface of a node, surfaces in raster order of their first sample.
  // Packed tiles: nodes never reach across blocks, so image neighbours are face neighbours.
  void find_surfaces(const Node& n, std::vector<std::vector<Member>>& surfaces) {
    surfaces.clear();
    if (is_whole(n)) {
      std::vector<Member>& members = surfaces.emplace_back();
      members.reserve(static_cast<std::size_t>(n.size) * n.size);
      for (int y = n.y; y < n.y_end; ++y)
        for (int x = n.x; x < n.x_end; ++x) members.push_back({index(x, y), x, y});
      return;
    }
    for (int y = n.y; y < n.y_end; ++y)
      for (int x = n.x; x < n.x_end; ++x) label_[index(x, y)] = -1;
    int count = 0;
    for (int y = n.y; y < n.y_end; ++y)
      for (int x = n.x; x < n.x_end; ++x) {
        const int first = index(x, y);
        if (!tile_.coverage[first] || label_[first] >= 0) continue;
        const int label = count++;
        label_[first] = label;
        open_.assign(1, {first, x, y});
        while (!open_.empty()) {
          const auto [i, ix, iy] = open_.back();
          open_.pop_back();
          const auto join = [&](const Member& other, std::uint8_t cut) {
            if (cut != kConnected || !tile_.coverage[other.index] || label_[other.index] >= 0) return;
            label_[other.index] = label;
            open_.push_back(other);
          };
          if (ix + 1 < n.x_end) join({i + 1, ix + 1, iy}, tile_.cut_right[i]);
          if (iy + 1 < n.y_end) join({i + tile_.width, ix, iy + 1}, tile_.cut_down[i]);
          if (ix > n.x) join({i - 1, ix - 1, iy}, tile_.cut_right[i - 1]);
          if (iy > n.y) join({i - tile_.width, ix, iy - 1}, tile_.cut_down[i - tile_.width]);
        }
      }
    surfaces.resize(static_cast<std::size_t>(count));
    for (int y = n.y; y < n.y_end; ++y)
      for (int x = n.x; x < n.x_end; ++x)
        if (const int i = index(x, y); label_[i] >= 0) surfaces[label_[i]].push_back({i, x, y});
  }

  // Members of the surface have no plane yet, so any plane found beside them belongs to a sample coded before.
  // The plane of an already coded sample connected to the surface, else a flat one at the last coded value.
  Plane predict(const std::vector<Member>& members, bool& is_connected) const {
    is_connected = true;
    for (const Member& member : members) {
      const int left = neighbours_.left(member.index), up = neighbours_.up(member.index);
      if (left >= 0 && plane_of_[left] >= 0 && tile_.cut_right[left] == kConnected)
        return planes_[plane_of_[left]];
      if (up >= 0 && plane_of_[up] >= 0 && tile_.cut_down[up] == kConnected)
        return planes_[plane_of_[up]];
    }
    is_connected = false;
    return Plane{last_units_, 0, 0};
  }

  void adopt(const std::vector<Member>& members, const Plane& plane) {
    planes_.push_back(plane);
    const int id = static_cast<int>(planes_.size()) - 1;
    for (const Member& member : members) {
      plane_of_[member.index] = id;
      units_[member.index] = std::clamp<std::int64_t>(plane.at(member.x, member.y), 0, kLargestUnits);
    }
    last_units_ = units_[members.front().index];
  }

  const Tile& tile_;
  const AreaCounts covered_, cut_right_, cut_down_;
  TileNeighbours neighbours_;
  std::vector<std::int64_t> units_;
  std::vector<int> plane_of_;
  std::vector<int> label_;
  std::vector<Member> open_;
  std::vector<Plane> planes_;
  std::int64_t last_units_ = 0;
  Contexts contexts_;
};

class DisparityEncoder : PlaneTree {
 public:
  explicit DisparityEncoder(const Tile& tile) : PlaneTree(tile), units_per_disparity_(256.0 / tile.disparity_tolerance) {}

  Bytes run() {
    for (const Node& root : roots()) encode(root);
    return coder_.finish();
  }

 private:
  double wanted(int i) const { return static_cast<double>(tile_.disparity[i]) * units_per_disparity_; }

  void encode(const Node& node) {
    if (is_empty(node)) return;
    if (node.size > kSmallestNode && is_hopeless(node)) {
      coder_.put(true, contexts_.split[size_class(node.size)]);
      each_child(node, [&](const Node& child) { encode(child); });
      return;
    }
    std::vector<std::vector<Member>> surfaces;
    find_surfaces(node, surfaces);
    std::vector<Plane> planes(surfaces.size());
    std::vector<char> fits(surfaces.size());
    bool all_fit = true;
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      fits[k] = fit(node, surfaces[k], planes[k]);
      all_fit = all_fit && fits[k];
      if (!all_fit && node.size > kSmallestNode) break;
    }
    if (node.size > kSmallestNode) {
      const bool split = !all_fit;
      coder_.put(split, contexts_.split[size_class(node.size)]);
      if (split) {
        each_child(node, [&](const Node& child) { encode(child); });
        return;
      }
    }
    for (std::size_t k = 0; k < surfaces.size(); ++k) put_surface(node, surfaces[k], fits[k], planes[k]);
  }

  // A whole node whose corners, edge middles and centre leave one plane by far cannot be one: no need to fit it.
  // Over a plane the second differences vanish; rounding and tolerance allow four tolerances (256 units each).
  bool is_hopeless(const Node& n) const {
    if (!is_whole(n)) return false;
    const int x2 = n.x_end - 1, y2 = n.y_end - 1, xm = n.x + (x2 - n.x) / 2, ym = n.y + (y2 - n.y) / 2;
    if ((x2 - n.x) % 2 != 0 || (y2 - n.y) % 2 != 0) return is_bent(n.x, n.y, xm, ym, 2 * xm - n.x, 2 * ym - n.y);
    return is_bent(n.x, n.y, xm, ym, x2, y2);
  }
  bool is_bent(int x0, int y0, int xm, int ym, int x2, int y2) const {
    const auto d = [&](int x, int y) { return wanted(index(x, y)); };
    const auto bent = [](double a, double middle, double b) { return std::abs(a + b - 2 * middle) > 4 * 256.0 + 8; };
    return bent(d(x0, y0), d(xm, y0), d(x2, y0)) || bent(d(x0, y0), d(x0, ym), d(x0, y2)) ||
           bent(d(x0, y0), d(xm, ym), d(x2, y2)) || bent(d(x2, y0), d(xm, ym), d(x0, y2));
  }

  // Least squares over the surface's samples, recentred between the extremes, then rounded as it will be coded.
  bool fit(const Node& node, const std::vector<Member>& members, Plane& plane) const {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sd = 0, sxd = 0, syd = 0;
    for (const Member& member : members) {
      const double x = member.x - node.x, y = member.y - node.y, d = wanted(member.index);
      n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y, sd += d, sxd += x * d, syd += y * d;
    }
    const double mx = sx / n, my = sy / n, md = sd / n;
    const double cxx = sxx / n - mx * mx, cxy = sxy / n - mx * my, cyy = syy / n - my * my;
    const double cxd = sxd / n - mx * md, cyd = syd / n - my * md;
    const double determinant = cxx * cyy - cxy * cxy;
    double gx = 0, gy = 0;
    // Sample positions are integers: a determinant below 1/1024 means that they lie on one line (or are one point).
    if (determinant > 1.0 / 1024) {
      gx = (cxd * cyy - cyd * cxy) / determinant;
      gy = (cyd * cxx - cxd * cxy) / determinant;
    } else if (cxx + cyy > 1.0 / 1024) {
      const double along = (cxd + cyd) / (cxx + cyy + 2 * std::abs(cxy));
      gx = cxx > 1.0 / 1024 ? along : 0, gy = cyy > 1.0 / 1024 ? (cxy < 0 ? -along : along) : 0;
      if (cxy < 0) {
        const double slope = (cxd - cyd) / (cxx + cyy - 2 * cxy);
        gx = slope, gy = -slope;
      }
    }
    const int shift = slope_shift(node.size);
    const auto quantised = [&](double value, int s) {
      return static_cast<std::int64_t>(std::llround(std::ldexp(value, -s))) * (std::int64_t{1} << s);
    };
    if (!(std::abs(gx) < 1e9 && std::abs(gy) < 1e9)) return false;
    plane.gx = quantised(gx, shift), plane.gy = quantised(gy, shift);
    double low = 1e300, high = -1e300;
    for (const Member& member : members) {
      const double rest = wanted(member.index) - static_cast<double>(plane.gx * (member.x - node.x) + plane.gy * (member.y - node.y));
      low = std::min(low, rest), high = std::max(high, rest);
    }
    const std::int64_t corner = quantised(0.5 * (low + high), kOffsetShift);
    plane.c = corner - plane.gx * node.x - plane.gy * node.y;
    // One unit below the tolerance absorbs the float the decoder rounds to.
    return std::max(high - static_cast<double>(corner), static_cast<double>(corner) - low) <= 255.0;
  }

  void put_surface(const Node& node, const std::vector<Member>& members, bool is_plane, const Plane& plane) {
    bool is_connected = false;
    const Plane guess = predict(members, is_connected);
    const int kind = size_class(node.size) * 2 + is_connected;
    if (node.size == kSmallestNode) coder_.put(is_plane, contexts_.is_plane[is_connected]);
    if (!is_plane) {
      put_levels(members);
      return;
    }
    const int shift = slope_shift(node.size);
    put_integer(coder_, static_cast<std::int32_t>((plane.gx >> shift) - round_shift(guess.gx, shift)), contexts_.slope_x[kind]);
    put_integer(coder_, static_cast<std::int32_t>((plane.gy >> shift) - round_shift(guess.gy, shift)), contexts_.slope_y[kind]);
    const std::int64_t corner = plane.at(node.x, node.y) >> kOffsetShift;
    put_integer(coder_, static_cast<std::int32_t>(corner - round_shift(guess.at(node.x, node.y), kOffsetShift)),
                contexts_.offset[kind]);
    adopt(members, plane);
  }

  void put_levels(const std::vector<Member>& members) {
    for (std::size_t k = 0; k < members.size(); ++k) {
      const std::int64_t level = std::llround(wanted(members[k].index) / static_cast<double>(kLevel));
      put_integer(coder_, static_cast<std::int32_t>(level - (last_units_ + kLevel / 2) / kLevel), contexts_.level[k > 0]);
      last_units_ = units_[members[k].index] = level * kLevel;
    }
  }

  double units_per_disparity_;
  BitEncoder coder_;
};

class DisparityDecoder : PlaneTree {
 public:
  DisparityDecoder(ByteView bytes, Tile& tile) : PlaneTree(tile), coder_(bytes), target_(tile) {}

  void run() {
    for (const Node& root : roots()) decode(root);
    const double disparity_per_unit = static_cast<double>(tile_.disparity_tolerance) / 256.0;
    target_.disparity.resize(tile_.samples());
    for (std::size_t i = 0; i < units_.size(); ++i)
      target_.disparity[i] = static_cast<float>(static_cast<double>(units_[i]) * disparity_per_unit);
  }

 private:
  void decode(const Node& node) {
    if (is_empty(node)) return;
    if (node.size > kSmallestNode && coder_.get(contexts_.split[size_class(node.size)])) {
      each_child(node, [&](const Node& child) { decode(child); });
      return;
    }
    std::vector<std::vector<Member>> surfaces;
    find_surfaces(node, surfaces);
    for (const std::vector<Member>& members : surfaces) get_surface(node, members);
  }

  void get_surface(const Node& node, const std::vector<Member>& members) {
    bool is_connected = false;
    const Plane guess = predict(members, is_connected);
    const int kind = size_class(node.size) * 2 + is_connected;
    if (node.size == kSmallestNode && !coder_.get(contexts_.is_plane[is_connected])) {
      for (std::size_t k = 0; k < members.size(); ++k) {
        const std::int64_t level = (last_units_ + kLevel / 2) / kLevel + get_integer(coder_, contexts_.level[k > 0]);
        last_units_ = units_[members[k].index] = std::clamp<std::int64_t>(level * kLevel, 0, kLargestUnits);
      }
      return;
    }
    const int shift = slope_shift(node.size);
    const auto bounded = [](std::int64_t value) { return std::clamp(value, -kLargestUnits, kLargestUnits); };
    Plane plane;
    plane.gx = bounded((round_shift(guess.gx, shift) + get_integer(coder_, contexts_.slope_x[kind])) * (std::int64_t{1} << shift));
    plane.gy = bounded((round_shift(guess.gy, shift) + get_integer(coder_, contexts_.slope_y[kind])) * (std::int64_t{1} << shift));
    const std::int64_t corner =
        bounded((round_shift(guess.at(node.x, node.y), kOffsetShift) + get_integer(coder_, contexts_.offset[kind])) *
                (std::int64_t{1} << kOffsetShift));
    plane.c = bounded(corner - plane.gx * node.x - plane.gy * node.y);
    adopt(members, plane);
  }

  BitDecoder coder_;
  Tile& target_;
};

}  // namespace

Bytes encode_disparity(const Tile& tile) { return DisparityEncoder(tile).run(); }

void decode_disparity(ByteView bytes, Tile& tile) { DisparityDecoder(bytes, tile).run(); }

}  // namespace farfield
