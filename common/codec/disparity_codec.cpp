// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream. Nodes of 32×32 samples in raster order (packed tiles: their 8×8 blocks), each split
// in four while a bit says so, down to 4×4. A leaf codes, for each connected surface in it (found from the coverage
// and the cuts, in raster order of first samples), its plane: the plane of the surface it is connected to or of others near it
// as it is, or shifted, or with other slopes (plane_coder.h). In 4×4 nodes a bit may say instead that levels follow, one per
// sample as the difference from what is known beside it.
//
// Units: U = tolerance/256, on the face. A plane is value(i, j) = (c + gx·i + gy·j)·U; what is coded of it is its value at the
// middle of the surface, in steps of 64 (single samples: 256), and its slopes in steps that add up to less than half of the
// tolerance over the surface (plane_fit.h); the encoder checks the sum of all roundings exactly.
#include "common/codec/disparity_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "common/codec/plane_coder.h"
#include "common/impostor/tile_neighbours.h"
namespace farfield {
namespace {

constexpr std::int64_t kLevel = 510;  // a sample's level: twice the tolerance, less a unit each way for float rounding
constexpr std::int64_t kLargestUnits = PlaneCoder<BitReader>::kLargestUnits;
// How far a plane that costs little may be off: less than the tolerance, which would be worth the last bits only if errors of a
// pixel could not be seen.
constexpr double kSameOff = 160, kShiftedOff = 200;

static_assert(kTileSamples % kLargestNode == 0, "nodes do not reach beyond a dense tile; packed ones consist of blocks");

// The structure both sides share: nodes, and what is known when a surface is coded.
template <class Coder>
class PlaneTree {
 protected:
  PlaneTree(Coder& coder, const Tile& tile, const TileBits& bits)
      : tile_(tile), bits_(bits), coder_(coder), planes_coder_(coder), neighbours_(tile), plane_of_(tile.samples(), kNoPlane), units_(tile.samples(), 0) {}

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

  // A node where it stands on the face. Planes go on there, and blocks that are packed side by side may be far apart.
  Node on_face(const Node& node) const {
    if (!tile_.is_packed()) return node;
    const std::size_t block = static_cast<std::size_t>(node.y / kBlockSamples) * kPackedColumns + static_cast<std::size_t>(node.x / kBlockSamples);
    if (block >= tile_.blocks.size()) return node;  // holds nothing in a tile that is whole
    const BlockPlace& place = tile_.blocks[block];
    return {place.x % kRegionBlocks * kBlockSamples + node.x % kBlockSamples, place.y % kRegionBlocks * kBlockSamples + node.y % kBlockSamples, node.size};
  }

  bool code_split(bool is_split, const Node& node) {
    const int size = node.size == 32 ? 2 : node.size == 16 ? 1 : 0;
    is_split = coder_.code(is_split, is_split_(size, size * 8 + splits_, splits_));
    splits_ = (splits_ << 1 | int{is_split}) & 7;
    return is_split;
  }

  // Samples of the node that are connected to the surface are the surface: only across the left and upper border there may be
  // others.
  PlaneGuesses guesses_for(const Node& node, const NodeSamples& surface) const {
    PlaneGuesses guesses;
    std::array<int, 2> across{kNoPlane, kNoPlane};  // planes beyond a cut
    const auto look = [&](int other, const std::vector<std::uint8_t>& cuts) {
      if (other < 0 || plane_of_[other] == kNoPlane) return false;
      guesses.is_connected = cuts[other] == kConnected;
      if (guesses.is_connected) {
        guesses.planes[0] = planes_[plane_of_[other]], guesses.count = 1;
      } else {
        across[across[0] == kNoPlane || across[0] == plane_of_[other] ? 0 : 1] = plane_of_[other];
      }
      return guesses.is_connected;
    };
    for (int y = surface.first_row; y < surface.end_row; ++y) {
      const std::uint32_t above = y == surface.first_row ? 0 : surface.rows[y - 1];
      for (std::uint32_t row = surface.rows[y]; row != 0; row &= row - 1) {
        const int x = std::countr_zero(row), at = index(node.x + x, node.y + y);
        const bool is_left_inside = x > 0 && surface.rows[y] >> (x - 1) & 1;
        if (!is_left_inside && look(neighbours_.left(at), tile_.cut_right)) return guesses;
        if (!(above >> x & 1) && look(neighbours_.up(at), tile_.cut_down)) return guesses;
      }
    }
    for (const int plane : across)
      if (plane != kNoPlane) guesses.add(planes_[plane]);
    for (const Plane& plane : planes_coder_.recent()) guesses.add(plane);
    if (guesses.count == 0) guesses.add({last_units_, 0, 0});
    return guesses;
  }

  void adopt(const Node& node, const Node& face, const NodeSamples& surface, const Plane& plane) {
    planes_.push_back(plane);
    const int id = static_cast<int>(planes_.size()) - 1;
    surface.each_run([&](int y, int first, int end) {
      const int at = index(node.x, node.y + y);
      std::fill(&plane_of_[at + first], &plane_of_[at] + end, id);
      for (int x = first; x < end; ++x) units_[at + x] = units_at(plane, face.x + x, face.y + y);
    });
    last_units_ = units_at(plane, face.x + std::countr_zero(surface.rows[surface.first_row]), face.y + surface.first_row);
  }
  static std::int64_t units_at(const Plane& plane, int x, int y) { return std::clamp<std::int64_t>(plane.at(x, y), 0, kLargestUnits); }

  // Calls level(x, y, expected level, kind of expectation) for each sample of a surface; it returns the sample's level.
  template <class Level>
  void code_levels(const Node& node, const NodeSamples& surface, Level level) {
    bool is_first = true;
    surface.each_run([&](int y, int first, int end) {
      for (int x = first; x < end; ++x) {
        const int at = index(node.x + x, node.y + y);
        std::int64_t sum = 0;
        int known = 0;
        const auto add = [&](int other, const std::vector<std::uint8_t>& cuts) {
          if (other < 0 || !tile_.coverage[other] || cuts[other] != kConnected) return;
          sum += units_[other], ++known;
        };
        add(neighbours_.left(at), tile_.cut_right), add(neighbours_.up(at), tile_.cut_down);
        const std::int64_t expected = known == 0 ? last_units_ : sum / known;
        const int kind = known + (is_first ? 0 : 3);
        is_first = false;
        const std::int64_t value = level(x, y, (expected + kLevel / 2) / kLevel, kind);
        last_units_ = std::clamp<std::int64_t>(value * kLevel, 0, kLargestUnits);
        units_[at] = last_units_;
      }
    });
  }
  std::vector<float> disparities() const {
    const double disparity_per_unit = static_cast<double>(tile_.disparity_tolerance) / 256.0;
    std::vector<float> result(units_.size());
    for (std::size_t i = 0; i < units_.size(); ++i) result[i] = static_cast<float>(static_cast<double>(units_[i]) * disparity_per_unit);
    return result;
  }

  static constexpr int kNoPlane = -1;
  const Tile& tile_;
  const TileBits& bits_;
  Coder& coder_;
  PlaneCoder<Coder> planes_coder_;
  TileNeighbours neighbours_;
  std::vector<int> plane_of_;       // of each sample, kNoPlane: not coded yet, or in levels
  std::vector<std::int64_t> units_; // of each sample that is coded
  std::vector<Plane> planes_;
  std::int64_t last_units_ = 0;
  int splits_ = 0, last_planes_ = 3;
  MixedContexts<3, 24, 8> is_split_;
  MixedContexts<2, 4, 8> is_plane_;
  MixedInteger<6, 8, 1> level_;
};

class DisparityEncoder : PlaneTree<BitWriter> {
 public:
  DisparityEncoder(BitWriter& coder, const Tile& tile, const TileBits& bits)
      : PlaneTree(coder, tile, bits), units_per_disparity_(256.0 / tile.disparity_tolerance) {}

  void run() {
    each_root([&](const Node& root) { encode(root); });
  }
  using PlaneTree::disparities;

 private:
  double wanted(int i) const { return static_cast<double>(tile_.disparity[i]) * units_per_disparity_; }

  void encode(const Node& node) {
    if (is_empty(bits_, node)) return;
    const bool may_split = node.size > kSmallestNode;
    if (may_split && is_hopeless(node)) return split(node);
    if (is_whole(bits_, node)) {
      Found whole{.samples = NodeSamples::whole(node.size)};
      whole.fits = fit(node, whole);
      if (may_split && !whole.fits) return split(node);
      if (may_split) code_split(false, node);
      put_surface(node, whole);
      return;
    }
    std::size_t count = 0;
    NodeSurfaces surfaces(bits_, node);
    for (NodeSamples surface; surfaces.next(surface); ++count) {
      if (found_.size() == count) found_.emplace_back();
      Found& found = found_[count];
      found.samples = surface;
      found.fits = fit(node, found);
      if (may_split && !found.fits) return split(node);
    }
    if (may_split) code_split(false, node);
    for (std::size_t k = 0; k < count; ++k) put_surface(node, found_[k]);
  }
  void split(const Node& node) {
    code_split(true, node);
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

  struct Found {
    NodeSamples samples;
    Plane plane;  // the nearest
    bool fits = false;
    bool has_depth = true;
  };

  static bool is_all_of(const Node& node, const NodeSamples& surface) { return surface == NodeSamples::whole(node.size); }
  // What is left of a surface's disparities less slopes, from the node's first sample.
  Range rest(const Node& node, const NodeSamples& surface, double gx, double gy) const {
    if (is_all_of(node, surface))
      return of_size(node.size, [&](auto whole) { return whole.rest(&tile_.disparity[index(node.x, node.y)], tile_.width, units_per_disparity_, gx, gy); });
    Range range;
    surface.each_run([&](int y, int first, int end) {
      for (int x = first; x < end; ++x) {
        const double left = wanted(index(node.x + x, node.y + y)) - (gx * x + gy * y);
        range.low = std::min(range.low, left), range.high = std::max(range.high, left);
      }
    });
    return range;
  }
  Moments moments(const Node& node, const NodeSamples& surface) const {
    if (is_all_of(node, surface))
      return of_size(node.size, [&](auto whole) { return whole.moments(&tile_.disparity[index(node.x, node.y)], tile_.width, units_per_disparity_); });
    Moments m;
    surface.each_run([&](int row, int first, int end) {
      for (int column = first; column < end; ++column) {
        const double x = column, y = row, d = wanted(index(node.x + column, node.y + row));
        m.n += 1, m.sx += x, m.sy += y, m.sxx += x * x, m.sxy += x * y, m.syy += y * y, m.sd += d, m.sxd += x * d, m.syd += y * d;
      }
    });
    return m;
  }

  // The plane of the given slopes that is nearest to the surface, its value rounded as it will be coded. Returns: by how much it
  // misses at most.
  double nearest(const Node& face, const SurfaceFrame& frame, const Range& rest, std::int64_t gx, std::int64_t gy, Plane& plane) const {
    const double corner = 0.5 * (rest.low + rest.high);
    const std::int64_t slanted = gx * (frame.x - face.x) + gy * (frame.y - face.y);
    const int shift = PlaneCoder<BitWriter>::offset_shift(frame);
    const std::int64_t value = round_shift(std::llround(corner) + slanted, shift) * (std::int64_t{1} << shift);
    plane = Plane::through(value, frame.x, frame.y, gx, gy);
    const auto rounded = static_cast<double>(value - slanted);
    return std::max(rest.high - rounded, rounded - rest.low);
  }
  static std::int64_t rounded_slope(double slope, int extent) {
    const int shift = SurfaceFrame::slope_shift(extent);
    return extent < 2 ? 0 : static_cast<std::int64_t>(std::llround(std::ldexp(slope, -shift))) * (std::int64_t{1} << shift);
  }

  // No larger than the tolerance: an eye anywhere in the cell sees it within tau of where it would be at infinity. Nothing of
  // the surface farther than that carries depth. One unit less, as in fit().
  bool is_beyond_parallax(const Node& node, const NodeSamples& surface) const {
    constexpr double kNoDepth = 255.0;
    const int first = surface.first_row, column = std::countr_zero(surface.rows[first]);
    return wanted(index(node.x + column, node.y + first)) <= kNoDepth && rest(node, surface, 0, 0).high <= kNoDepth;
  }

  bool fit(const Node& node, Found& found) const {
    found.has_depth = !is_beyond_parallax(node, found.samples);
    found.plane = {};
    if (!found.has_depth) return true;
    const Node face = on_face(node);
    const SurfaceFrame frame(face, found.samples);
    const Slopes slopes = fit_slopes(moments(node, found.samples));
    if (!(std::abs(slopes.x) < kSteepest && std::abs(slopes.y) < kSteepest)) return false;
    const std::int64_t gx = rounded_slope(slopes.x, frame.columns), gy = rounded_slope(slopes.y, frame.rows);
    // One unit below the tolerance absorbs the float the decoder rounds to.
    return nearest(face, frame, rest(node, found.samples, static_cast<double>(gx), static_cast<double>(gy)), gx, gy, found.plane) <= 255.0;
  }

  // The cheapest way to a plane that is near enough. Bits are guessed: what matters is which way is much shorter.
  PlaneChoice choose(const Node& node, const Node& face, const SurfaceFrame& frame, const Found& found, const PlaneGuesses& guesses) const {
    PlaneChoice best;
    double least = 1e9;
    const auto consider = [&](double bits, int guess, PlaneChoice::Way way, const Plane& plane) {
      if (bits < least) least = bits, best = {guess, way, plane};
    };
    const auto bits_of = [](std::int64_t value) { return 2.0 * std::bit_width(static_cast<std::uint64_t>(std::abs(value))); };
    const int shift = PlaneCoder<BitWriter>::offset_shift(frame);
    for (int g = 0; g < guesses.count; ++g) {
      const Plane& guess = guesses.planes[g];
      if (least <= g + 1) break;  // no later guess is cheaper
      if (!found.has_depth && guess == Plane{}) consider(g, g, PlaneChoice::Way::kSame, guess);
      const Range left = rest(node, found.samples, static_cast<double>(guess.gx), static_cast<double>(guess.gy));
      const auto corner = static_cast<double>(guess.at(face.x, face.y));
      if (found.has_depth && left.high - corner <= kSameOff && corner - left.low <= kSameOff) consider(g, g, PlaneChoice::Way::kSame, guess);
      const auto offset_bits = [&](const Plane& plane) {
        return bits_of((plane.at(frame.x, frame.y) >> shift) - round_shift(guess.at(frame.x, frame.y), shift));
      };
      Plane shifted;
      if (found.has_depth && nearest(face, frame, left, guess.gx, guess.gy, shifted) <= kShiftedOff) consider(g + 2 + offset_bits(shifted), g, PlaneChoice::Way::kShifted, shifted);
      Plane fresh = found.plane;
      if (frame.columns < 2) fresh.gx = guess.gx;
      if (frame.rows < 2) fresh.gy = guess.gy;
      fresh = Plane::through(found.plane.at(frame.x, frame.y), frame.x, frame.y, fresh.gx, fresh.gy);
      const auto slope_bits = [&](std::int64_t slope, std::int64_t expected, int extent) {
        const int step = SurfaceFrame::slope_shift(extent);
        return extent < 2 ? 0 : bits_of((slope >> step) - round_shift(expected, step));
      };
      const PlaneChoice::Way way = frame.size_class() == 0 ? PlaneChoice::Way::kShifted : PlaneChoice::Way::kNew;
      consider(g + 4 + offset_bits(fresh) + slope_bits(fresh.gx, guess.gx, frame.columns) + slope_bits(fresh.gy, guess.gy, frame.rows), g, way, fresh);
    }
    return best;
  }

  void put_surface(const Node& node, const Found& found) {
    const Node face = on_face(node);
    const PlaneGuesses guesses = guesses_for(node, found.samples);
    if (node.size == kSmallestNode) {
      coder_.code(found.fits, is_plane_(guesses.is_connected, last_planes_, last_planes_ * 2 + guesses.is_connected));
      last_planes_ = (last_planes_ << 1 | int{found.fits}) & 3;
    }
    if (!found.fits) {
      code_levels(node, found.samples, [&](int x, int y, std::int64_t expected, int kind) {
        const std::int64_t level = std::llround(wanted(index(node.x + x, node.y + y)) / static_cast<double>(kLevel));
        return expected + level_.code(coder_, static_cast<std::int32_t>(level - expected), kind, last_planes_, 0);
      });
      return;
    }
    const SurfaceFrame frame(face, found.samples);
    const Plane plane = planes_coder_.code(frame, guesses, choose(node, face, frame, found, guesses));
    adopt(node, face, found.samples, plane);
  }

  double units_per_disparity_;
  std::vector<Found> found_;  // of the node being coded
};

class DisparityDecoder : PlaneTree<BitReader> {
 public:
  DisparityDecoder(BitReader& coder, const TileBits& bits, const Tile& tile) : PlaneTree(coder, tile, bits) {}

  void run() {
    each_root([&](const Node& root) { decode(root); });
  }
  using PlaneTree::disparities;

 private:
  void decode(const Node& node) {
    if (is_empty(bits_, node)) return;
    if (node.size > kSmallestNode && code_split(false, node)) {
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
    const Node face = on_face(node);
    const PlaneGuesses guesses = guesses_for(node, surface);
    if (node.size == kSmallestNode) {
      const bool is_plane = coder_.code(false, is_plane_(guesses.is_connected, last_planes_, last_planes_ * 2 + guesses.is_connected));
      last_planes_ = (last_planes_ << 1 | int{is_plane}) & 3;
      if (!is_plane) {
        code_levels(node, surface, [&](int, int, std::int64_t expected, int kind) { return expected + level_.code(coder_, 0, kind, last_planes_, 0); });
        return;
      }
    }
    const Plane plane = planes_coder_.code(SurfaceFrame(face, surface), guesses, {});
    adopt(node, face, surface, plane);
  }
};

}  // namespace

Bytes encode_disparity(const Tile& tile, const TileBits& bits, std::vector<float>* decoded) {
  BitWriter coder;
  DisparityEncoder encoder(coder, tile, bits);
  encoder.run();
  if (decoded) *decoded = encoder.disparities();
  return coder.finish();
}

void decode_disparity(ByteView bytes, const TileBits& bits, Tile& tile) {
  BitReader coder(bytes);
  DisparityDecoder decoder(coder, bits, tile);
  decoder.run();
  tile.disparity = decoder.disparities();
}

}  // namespace farfield
