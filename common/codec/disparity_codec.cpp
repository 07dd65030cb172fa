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
#include "common/codec/plane_fit.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

constexpr std::int64_t kLevel = 510;  // a sample's level: twice the tolerance, less a unit each way for float rounding
constexpr std::int64_t kLargestUnits = std::int64_t{1} << 40;

int size_class(int node) { return slope_shift(node); }

struct Contexts {
  std::array<BitContext, 16> split{};
  std::array<BitContext, 8> is_plane{};
  std::array<IntegerContext, 8> offset{}, slope_x{}, slope_y{};
  std::array<IntegerContext, 2> level{};
};

std::int64_t round_shift(std::int64_t value, int shift) {
  return shift == 0 ? value : (value + (std::int64_t{1} << (shift - 1))) >> shift;
}

static_assert(kTileSamples % kLargestNode == 0, "nodes do not reach beyond a dense tile; packed ones consist of blocks");

// The structure both sides share: nodes and predictions.
class PlaneTree {
 protected:
  PlaneTree(const Tile& tile, const TileBits& bits) : tile_(tile), bits_(bits), neighbours_(tile), plane_of_(tile.samples(), -1) {}

  template <class Visit>
  void each_root(Visit visit) const {
    const int size = tile_.is_packed() ? kBlockSamples : kLargestNode;
    for (int y = 0; y < tile_.height; y += size)
      for (int x = 0; x < tile_.width; x += size) visit(Node{x, y, size});
  }
  template <class Visit>
  static void each_child(const Node& node, Visit visit) {
    const int half = node.size / 2;
    for (int k = 0; k < 4; ++k) visit(Node{node.x + (k & 1) * half, node.y + (k >> 1) * half, half});
  }
  int index(int x, int y) const { return y * tile_.width + x; }

  // The plane of an already coded sample connected to the surface, else a flat one at the last coded value. Samples of the
  // node that are connected to the surface are the surface: only across the left and upper border there may be others.
  Plane predict(const Node& node, const NodeSamples& surface, bool& is_connected) const {
    is_connected = true;
    const Plane* found = nullptr;
    const auto is_found = [&](int other, const std::vector<std::uint8_t>& cuts) {
      if (other < 0 || plane_of_[other] < 0 || cuts[other] != kConnected) return false;
      found = &planes_[plane_of_[other]];
      return true;
    };
    for (int y = surface.first_row; y < surface.end_row; ++y) {
      if (surface.rows[y] & 1 && is_found(neighbours_.left(index(node.x, node.y + y)), tile_.cut_right)) return *found;
      if (y > 0) continue;
      for (std::uint32_t row = surface.rows[0]; row != 0; row &= row - 1)
        if (is_found(neighbours_.up(index(node.x + std::countr_zero(row), node.y)), tile_.cut_down)) return *found;
    }
    is_connected = false;
    return Plane{last_units_, 0, 0};
  }

  // Only from across the right and lower border a plane will be asked for.
  void adopt(const Node& node, const NodeSamples& surface, const Plane& plane) {
    planes_.push_back(plane);
    const int id = static_cast<int>(planes_.size()) - 1, last = node.size - 1;
    for (int y = surface.first_row; y < surface.end_row; ++y)
      if (surface.rows[y] >> last & 1) plane_of_[index(node.x + last, node.y + y)] = id;
    for (std::uint32_t row = surface.rows[last]; row != 0; row &= row - 1)
      plane_of_[index(node.x + std::countr_zero(row), node.y + last)] = id;
    last_units_ = units_at(plane, node.x + std::countr_zero(surface.rows[surface.first_row]), node.y + surface.first_row);
  }
  static std::int64_t units_at(const Plane& plane, int x, int y) { return std::clamp<std::int64_t>(plane.at(x, y), 0, kLargestUnits); }

  const Tile& tile_;
  const TileBits& bits_;
  TileNeighbours neighbours_;
  std::vector<int> plane_of_;
  std::vector<Plane> planes_;
  std::int64_t last_units_ = 0;
  Contexts contexts_;
};

class DisparityEncoder : PlaneTree {
 public:
  DisparityEncoder(const Tile& tile, const TileBits& bits) : PlaneTree(tile, bits), units_per_disparity_(256.0 / tile.disparity_tolerance) {}

  Bytes run() {
    each_root([&](const Node& root) { encode(root); });
    return coder_.finish();
  }

 private:
  double wanted(int i) const { return static_cast<double>(tile_.disparity[i]) * units_per_disparity_; }

  void encode(const Node& node) {
    if (is_empty(bits_, node)) return;
    const bool may_split = node.size > kSmallestNode;
    if (may_split && is_hopeless(node)) return split(node);
    if (is_whole(bits_, node)) {
      Plane plane;
      const bool fits = fit_whole(node, plane);
      if (may_split && !fits) return split(node);
      if (may_split) coder_.put(false, contexts_.split[size_class(node.size)]);
      put_surface(node, NodeSamples::whole(node.size), fits, plane);
      return;
    }
    std::size_t count = 0;
    NodeSurfaces surfaces(bits_, node);
    for (NodeSamples surface; surfaces.next(surface); ++count) {
      if (found_.size() == count) found_.emplace_back();
      Found& found = found_[count];
      found.fits = fit(node, surface, found.plane);
      if (may_split && !found.fits) return split(node);
      found.samples = surface;
    }
    if (may_split) coder_.put(false, contexts_.split[size_class(node.size)]);
    for (std::size_t k = 0; k < count; ++k) put_surface(node, found_[k].samples, found_[k].fits, found_[k].plane);
  }
  void split(const Node& node) {
    coder_.put(true, contexts_.split[size_class(node.size)]);
    each_child(node, [&](const Node& child) { encode(child); });
  }

  // A node with a whole part whose corners, edge middles and centre leave one plane by far cannot be planes: no need to fit
  // any. Over a plane the second differences vanish; rounding and tolerance allow four tolerances (256 units each).
  bool is_hopeless(const Node& n) const {
    if (is_whole(bits_, n)) {
      const int middle = (n.size - 1) / 2;
      return is_bent(n.x, n.y, n.x + middle, n.y + middle, n.x + 2 * middle, n.y + 2 * middle);
    }
    if (n.size == kSmallestNode) return false;
    bool is_any = false;
    each_child(n, [&](const Node& child) { is_any = is_any || is_hopeless(child); });
    return is_any;
  }
  bool is_bent(int x0, int y0, int xm, int ym, int x2, int y2) const {
    const auto d = [&](int x, int y) { return wanted(index(x, y)); };
    const auto bent = [](double a, double middle, double b) { return std::abs(a + b - 2 * middle) > 4 * 256.0 + 8; };
    return bent(d(x0, y0), d(xm, y0), d(x2, y0)) || bent(d(x0, y0), d(x0, ym), d(x0, y2)) ||
           bent(d(x0, y0), d(xm, ym), d(x2, y2)) || bent(d(x2, y0), d(xm, ym), d(x0, y2));
  }

  // No larger than the tolerance: an eye anywhere in the cell sees it within tau of where it would be at infinity. Nothing of
  // the surface farther than that carries depth. One unit less, as in fit_plane().
  static constexpr double kNoDepth = 255.0;

  bool fit_whole(const Node& node, Plane& plane) const {
    const float* first = &tile_.disparity[index(node.x, node.y)];
    if (wanted(index(node.x, node.y)) <= kNoDepth &&
        of_size(node.size, [&](auto whole) { return whole.rest(first, tile_.width, units_per_disparity_, 0, 0); }).high <= kNoDepth) {
      plane = {};
      return true;
    }
    return of_size(node.size, [&](auto whole) {
      return fit_plane(
          node, whole.moments(first, tile_.width, units_per_disparity_),
          [&](double gx, double gy) { return whole.rest(first, tile_.width, units_per_disparity_, gx, gy); }, plane);
    });
  }

  bool fit(const Node& node, const NodeSamples& surface, Plane& plane) const {
    Moments m;
    const auto each_member = [&](auto visit) {
      surface.each_run([&](int y, int first, int end) {
        for (int x = first; x < end; ++x) visit(x, y, wanted(index(node.x + x, node.y + y)));
      });
    };
    bool has_depth = false;
    each_member([&](double x, double y, double d) {
      has_depth = has_depth || d > kNoDepth;
      m.n += 1, m.sx += x, m.sy += y, m.sxx += x * x, m.sxy += x * y, m.syy += y * y, m.sd += d, m.sxd += x * d, m.syd += y * d;
    });
    if (!has_depth) {
      plane = {};
      return true;
    }
    const auto rest = [&](double gx, double gy) {
      Range range;
      each_member([&](double x, double y, double d) {
        const double left = d - (gx * x + gy * y);
        range.low = std::min(range.low, left), range.high = std::max(range.high, left);
      });
      return range;
    };
    return fit_plane(node, m, rest, plane);
  }

  void put_surface(const Node& node, const NodeSamples& surface, bool is_plane, const Plane& plane) {
    bool is_connected = false;
    const Plane guess = predict(node, surface, is_connected);
    const int kind = size_class(node.size) * 2 + is_connected;
    if (node.size == kSmallestNode) coder_.put(is_plane, contexts_.is_plane[is_connected]);
    if (!is_plane) {
      put_levels(node, surface);
      return;
    }
    const int shift = slope_shift(node.size);
    put_integer(coder_, static_cast<std::int32_t>((plane.gx >> shift) - round_shift(guess.gx, shift)), contexts_.slope_x[kind]);
    put_integer(coder_, static_cast<std::int32_t>((plane.gy >> shift) - round_shift(guess.gy, shift)), contexts_.slope_y[kind]);
    const std::int64_t corner = plane.at(node.x, node.y) >> kOffsetShift;
    put_integer(coder_, static_cast<std::int32_t>(corner - round_shift(guess.at(node.x, node.y), kOffsetShift)),
                contexts_.offset[kind]);
    adopt(node, surface, plane);
  }

  void put_levels(const Node& node, const NodeSamples& surface) {
    int kind = 0;  // of the first sample, and of all others
    surface.each_run([&](int y, int first, int end) {
      for (int x = first; x < end; ++x) {
        const std::int64_t level = std::llround(wanted(index(node.x + x, node.y + y)) / static_cast<double>(kLevel));
        put_integer(coder_, static_cast<std::int32_t>(level - (last_units_ + kLevel / 2) / kLevel), contexts_.level[kind]);
        kind = 1;
        last_units_ = level * kLevel;
      }
    });
  }

  struct Found {
    NodeSamples samples;
    Plane plane;
    bool fits = false;
  };

  double units_per_disparity_;
  BitEncoder coder_;
  std::vector<Found> found_;  // of the node being coded
};

class DisparityDecoder : PlaneTree {
 public:
  DisparityDecoder(ByteView bytes, const TileBits& bits, Tile& tile)
      : PlaneTree(tile, bits), coder_(bytes), target_(tile), disparity_per_unit_(static_cast<double>(tile.disparity_tolerance) / 256.0) {}

  void run() {
    target_.disparity.assign(tile_.samples(), 0.0f);
    each_root([&](const Node& root) { decode(root); });
  }

 private:
  void decode(const Node& node) {
    if (is_empty(bits_, node)) return;
    if (node.size > kSmallestNode && coder_.get(contexts_.split[size_class(node.size)])) {
      each_child(node, [&](const Node& child) { decode(child); });
      return;
    }
    if (is_whole(bits_, node)) {
      get_surface(node, NodeSamples::whole(node.size));
      return;
    }
    NodeSurfaces surfaces(bits_, node);
    for (NodeSamples surface; surfaces.next(surface);) get_surface(node, surface);
  }

  void get_surface(const Node& node, const NodeSamples& surface) {
    bool is_connected = false;
    const Plane guess = predict(node, surface, is_connected);
    const int kind = size_class(node.size) * 2 + is_connected;
    if (node.size == kSmallestNode && !coder_.get(contexts_.is_plane[is_connected])) {
      get_levels(node, surface);
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
    adopt(node, surface, plane);
    surface.each_run([&](int y, int first, int end) {
      for (int x = first; x < end; ++x) set(node, x, y, units_at(plane, node.x + x, node.y + y));
    });
  }

  void get_levels(const Node& node, const NodeSamples& surface) {
    int kind = 0;  // of the first sample, and of all others
    surface.each_run([&](int y, int first, int end) {
      for (int x = first; x < end; ++x) {
        const std::int64_t level = (last_units_ + kLevel / 2) / kLevel + get_integer(coder_, contexts_.level[kind]);
        kind = 1;
        last_units_ = std::clamp<std::int64_t>(level * kLevel, 0, kLargestUnits);
        set(node, x, y, last_units_);
      }
    });
  }
  void set(const Node& node, int x, int y, std::int64_t units) {
    target_.disparity[index(node.x + x, node.y + y)] = static_cast<float>(static_cast<double>(units) * disparity_per_unit_);
  }

  BitDecoder coder_;
  Tile& target_;
  double disparity_per_unit_;
};

}  // namespace

Bytes encode_disparity(const Tile& tile, const TileBits& bits) { return DisparityEncoder(tile, bits).run(); }

void decode_disparity(ByteView bytes, const TileBits& bits, Tile& tile) { DisparityDecoder(bytes, bits, tile).run(); }

}  // namespace farfield
