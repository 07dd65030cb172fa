// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream. For each 8×8 block its state (empty, full, mixed) in the context of the blocks to the
// left and above and of the block before; for mixed blocks 64 bits in the context of the causal neighbours. Then, again by
// block: whether it holds a cut between two covered samples, and if so a bit for each such pair, in the context of the
// cuts around it. Where exactly one end is covered the cut is implied. A cut's position is three bits, in the contexts of
// the positions before it along the same silhouette and of where the line through these goes on; with one end covered
// first a bit says whether it stands at the far end, as it does where another view holds the surface beyond.
// Neighbours are those on the face, as far as their blocks come earlier.
#include "common/codec/coverage_codec.h"

#include <array>
#include <bit>
#include <cstring>

#include "common/codec/block_window.h"
#include "common/codec/mixed_bits.h"

namespace farfield {
namespace {

// One byte per sample of a block, row by row.
using BlockValues = std::array<std::uint8_t, kBlockSamples * kBlockSamples>;

// A tile's topology, block by block.
struct Topology {
  std::vector<std::uint64_t> covered;
  std::vector<BlockValues> cut_right, cut_down;

  explicit Topology(const BlockGrid& grid) : covered(grid.size(), 0), cut_right(grid.size()), cut_down(grid.size()) {}
};

constexpr int kEmpty = 0, kMixed = 1, kFull = 2, kNoBlock = 3;
constexpr int kNoGuess = 15;

struct Contexts {
  MixedContexts<16, 64, 4> is_mixed, is_full;
  MixedContexts<16, 1024, 64> covered;
  MixedContexts<9, 18, 3> has_cuts;
  // Of each direction: cuts to the right, cuts below.
  std::array<MixedContexts<8, 512, 256>, 2> is_cut;
  std::array<MixedContexts<9 * 8, 16 * 8, 81 * 8, 3>, 2> position;
  // Of each direction, and by which end is covered.
  std::array<std::array<MixedContexts<3, 9, 3 * 128>, 2>, 2> is_far;
  std::array<std::array<MixedContexts<9 * 8, 16 * 8, 8, 3>, 2>, 2> rim_position;
};

// What a walk knows around an edge before it codes the edge's cut: the cuts along the silhouette that may go on here, and
// what lies across. `before`, `before_that`: the same edge one and two steps back along the silhouette.
struct EdgeContext {
  int before = 0, before_that = 0;
  int near = 0;    // three bits
  int around = 0;  // nine bits, the three included
  int rim = 0;     // eight bits: coverage beside the edge, and cuts
  int guess = kNoGuess;
};

// Where a silhouette goes on: on the line through its last two cuts (0…9: a step outside is still a direction), 10 if
// only one is known, 11…14 from a neighbouring column or row, kNoGuess without any.
int guess_position(int before, int before_that, int from_one_side, int from_other_side) {
  if (before && before_that) return std::clamp(2 * before - before_that, 0, 9);
  if (before) return 10;
  if (from_one_side) return 11 + (from_one_side > 6) + (from_one_side > 3);
  if (from_other_side) return from_other_side < 3 ? 13 : 14;
  return kNoGuess;
}

template <class Coder>
class TopologyWalk {
 public:
  TopologyWalk(Coder& coder, const BlockGrid& grid, Topology& blocks)
      : coder_(coder), grid_(grid), blocks_(blocks), states_(grid.size(), kEmpty), cut_blocks_(grid.size(), 0) {}
  void run() {
    for (int block = 0; block < grid_.size(); ++block) code_coverage(block);
    for (int block = 0; block < grid_.size(); ++block) code_cuts(block);
  }

 private:
  void code_coverage(int block) {
    std::uint64_t& covered = blocks_.covered[block];
    const std::uint64_t samples = grid_.samples(block), wanted = covered;
    const BlockGrid::Beside& beside = grid_.beside(block);
    const auto state_of = [&](int other) { return other < 0 ? kNoBlock : int{states_[other]}; };
    const int around = state_of(beside.left) * 4 + state_of(beside.above), last = state_of(block - 1);
    const auto is = [&](bool bit, auto& contexts) { return coder_.code(bit, contexts(around, last * 16 + around, last)); };
    const bool is_mixed = is(wanted != 0 && wanted != samples, contexts_.is_mixed);
    const bool is_full = !is_mixed && is(wanted == samples, contexts_.is_full);
    states_[block] = static_cast<std::uint8_t>(is_mixed ? kMixed : is_full ? kFull : kEmpty);
    covered = is_full ? samples : 0;
    if (!is_mixed) return;
    BlockWindow near(grid_, block, [&](int other, int k) { return static_cast<std::uint8_t>(blocks_.covered[other] >> k & 1); });
    for (int k = 0; k < kBlockSamples * kBlockSamples; ++k) {
      if (!(samples >> k & 1)) continue;
      const auto at = [&](int dx, int dy) { return int{near.at(k, dx, dy)}; };
      const int four = at(-1, 0) | at(0, -1) << 1 | at(-1, -1) << 2 | at(1, -1) << 3;
      const int ten = four | at(-2, 0) << 4 | at(0, -2) << 5 | at(2, -1) << 6 | at(1, -2) << 7 | at(-1, -2) << 8 | at(-2, -1) << 9;
      const bool bit = coder_.code(wanted >> k & 1, contexts_.covered(four, ten, (ten & 31) << 1 | at(-1, 1)));
      near.set(k, bit);
      covered |= std::uint64_t{bit} << k;
    }
  }

  // Every edge of the block that has two covered ends, if any of these is cut, and every edge that has one.
  void code_cuts(int block) {
    const BlockGrid::Beside& beside = grid_.beside(block);
    const std::uint64_t covered = blocks_.covered[block];
    const std::uint64_t right = covered_right_of(block), below = bits_below(covered, covered_in(beside.below));
    BlockValues &cut_right = blocks_.cut_right[block], &cut_down = blocks_.cut_down[block];
    bool any = false;
    if (states_[block] != kEmpty) {
      const auto cut_in = [&](int other) { return other < 0 ? 2 : int{cut_blocks_[other]}; };
      const int around = cut_in(beside.left) + 3 * cut_in(beside.above);
      any = has_cut(cut_right, covered & right) || has_cut(cut_down, covered & below);
      any = coder_.code(any, contexts_.has_cuts(around, around * 2 + (states_[block] == kFull), cut_in(block - 1)));
    }
    cut_blocks_[block] = any;

    const BlockValues wanted_right = cut_right, wanted_down = cut_down;
    cut_right.fill(kConnected), cut_down.fill(kConnected);
    const std::uint64_t code_right = (any ? covered | right : covered ^ right) & grid_.with_right(block);
    const std::uint64_t code_down = (any ? covered | below : covered ^ below) & grid_.with_below(block);
    if ((code_right | code_down) == 0) return;
    const std::uint64_t left = (covered & ~kLastColumn) << 1 | (covered_in(beside.left) & kLastColumn) >> 7;
    const std::uint64_t above = covered << 8 | covered_in(beside.above) >> 56;
    const std::uint64_t above_right = right << 8 | (beside.above < 0 ? 0 : covered_right_of(beside.above) >> 56);
    BlockWindow across(grid_, block, [&](int other, int k) { return blocks_.cut_right[other][k]; });
    BlockWindow along(grid_, block, [&](int other, int k) { return blocks_.cut_down[other][k]; });
    for (std::uint64_t todo = code_right | code_down; todo != 0; todo &= todo - 1) {
      const int k = std::countr_zero(todo);
      const auto bit = [&](std::uint64_t word) { return static_cast<int>(word >> k & 1); };
      if (bit(code_right)) {
        const EdgeContext edge = edge_to_the_right(across, along, k, bit(above) | bit(above_right) << 1);
        cut_right[k] = code_edge(bit(covered), bit(right), wanted_right[k], edge, 0);
        across.set(k, cut_right[k]);
      }
      if (bit(code_down)) {
        const EdgeContext edge = edge_below(across, along, k, bit(left) | bit(right) << 1);
        cut_down[k] = code_edge(bit(covered), bit(below), wanted_down[k], edge, 1);
        along.set(k, cut_down[k]);
      }
    }
  }

  static EdgeContext edge_to_the_right(const BlockWindow& right, const BlockWindow& down, int k, int coverage) {
    const auto r = [&](int dx, int dy) { return int{right.at(k, dx, dy)}; };
    const auto d = [&](int dx, int dy) { return int{down.at(k, dx, dy)}; };
    EdgeContext edge{.before = r(0, -1), .before_that = r(0, -2)};
    edge.near = (r(0, -1) != 0) | (r(-1, 0) != 0) << 1 | (d(0, -1) != 0) << 2;
    edge.around = edge.near | (r(0, -2) != 0) << 3 | (r(-1, -1) != 0) << 4 | (r(1, -1) != 0) << 5 | (d(1, -1) != 0) << 6 |
                  (d(-1, 0) != 0) << 7 | (d(-1, -1) != 0) << 8;
    edge.rim = coverage | edge.near << 2 | (r(-2, 0) != 0) << 5;
    edge.guess = guess_position(edge.before, edge.before_that, d(-1, -1), d(1, -1));
    return edge;
  }
  static EdgeContext edge_below(const BlockWindow& right, const BlockWindow& down, int k, int coverage) {
    const auto r = [&](int dx, int dy) { return int{right.at(k, dx, dy)}; };
    const auto d = [&](int dx, int dy) { return int{down.at(k, dx, dy)}; };
    EdgeContext edge{.before = d(-1, 0), .before_that = d(-2, 0)};
    edge.near = (d(-1, 0) != 0) | (d(0, -1) != 0) << 1 | (r(0, 0) != 0) << 2;
    edge.around = edge.near | (d(-2, 0) != 0) << 3 | (d(-1, -1) != 0) << 4 | (r(-1, 0) != 0) << 5 | (r(0, -1) != 0) << 6 |
                  (d(1, -1) != 0) << 7 | (d(0, -2) != 0) << 8;
    edge.rim = coverage | edge.near << 2 | (r(-1, -1) != 0) << 5;
    edge.guess = guess_position(edge.before, edge.before_that, r(-1, -1), r(-1, 1));
    return edge;
  }

  std::uint8_t code_edge(bool is_first, bool is_second, int wanted, const EdgeContext& edge, int direction) {
    if (is_first && is_second) {
      if (!coder_.code(wanted != kConnected, contexts_.is_cut[direction](edge.near, edge.around, edge.rim))) return kConnected;
      auto& tree = contexts_.position[direction];
      return code_position(wanted, [&](int node, int bit) {
        return tree(edge.before * 8 + node, edge.guess * 8 + node, (edge.before * 9 + edge.before_that) * 8 + node, bit);
      });
    }
    const int far = is_first ? 8 : 1;
    const auto like = [&](int cut) { return cut == kConnected ? 2 : int{cut == far}; };
    auto& is_far = contexts_.is_far[direction][is_first];
    const int before = like(edge.before);
    if (coder_.code(wanted == far, is_far(before, before * 3 + like(edge.before_that), before * 128 + (edge.around & 127))))
      return static_cast<std::uint8_t>(far);
    auto& tree = contexts_.rim_position[direction][is_first];
    return code_position(wanted, [&](int node, int bit) { return tree(edge.before * 8 + node, edge.guess * 8 + node, node, bit); });
  }
  template <class Predict>
  std::uint8_t code_position(int wanted, Predict predict) {
    const int position = wanted == kConnected ? 3 : wanted - 1;
    int node = 1;
    for (int bit = 2; bit >= 0; --bit) node = node * 2 + coder_.code((position >> bit) & 1, predict(node, bit));
    return static_cast<std::uint8_t>(node - 8 + 1);
  }

  static bool has_cut(const BlockValues& cuts, std::uint64_t where) {
    if (cuts == BlockValues{}) return false;
    for (; where != 0; where &= where - 1)
      if (cuts[std::countr_zero(where)] != kConnected) return true;
    return false;
  }
  std::uint64_t covered_in(int block) const { return block < 0 ? 0 : blocks_.covered[block]; }
  std::uint64_t covered_right_of(int block) const {
    return bits_to_the_right(blocks_.covered[block], covered_in(grid_.beside(block).right));
  }

  Coder& coder_;
  const BlockGrid& grid_;
  Topology& blocks_;
  std::vector<std::uint8_t> states_, cut_blocks_;
  Contexts contexts_;
};

// Calls visit(samples in the tile's arrays, samples in the block, how many) for each row of a block.
template <class Visit>
void each_row(const BlockGrid& grid, int block, Visit visit) {
  const std::uint64_t samples = grid.samples(block);
  const int columns = std::popcount(samples & kFirstRow);
  for (int y = 0; y < kBlockSamples && (samples >> 8 * y & 1); ++y)
    visit(static_cast<std::size_t>(grid.first_sample(block)) + static_cast<std::size_t>(y) * grid.width(), 8 * y, columns);
}

}  // namespace

Bytes encode_topology(const Tile& tile, const TileBits& bits) {
  const BlockGrid& grid = bits.grid();
  Topology blocks(grid);
  for (int block = 0; block < grid.size(); ++block) {
    blocks.covered[block] = bits[block].covered;
    each_row(grid, block, [&](std::size_t in_tile, int in_block, int columns) {
      std::memcpy(&blocks.cut_right[block][in_block], &tile.cut_right[in_tile], static_cast<std::size_t>(columns));
      std::memcpy(&blocks.cut_down[block][in_block], &tile.cut_down[in_tile], static_cast<std::size_t>(columns));
    });
  }
  BitWriter writer;
  TopologyWalk<BitWriter>(writer, grid, blocks).run();
  return writer.finish();
}

void decode_topology(ByteView bytes, Tile& tile) {
  const BlockGrid grid(tile);
  Topology blocks(grid);
  BitReader reader(bytes);
  TopologyWalk<BitReader>(reader, grid, blocks).run();
  tile.coverage.resize(tile.samples()), tile.cut_right.resize(tile.samples()), tile.cut_down.resize(tile.samples());
  for (int block = 0; block < grid.size(); ++block)
    each_row(grid, block, [&](std::size_t in_tile, int in_block, int columns) {
      for (int x = 0; x < columns; ++x) tile.coverage[in_tile + x] = blocks.covered[block] >> (in_block + x) & 1;
      std::memcpy(&tile.cut_right[in_tile], &blocks.cut_right[block][in_block], static_cast<std::size_t>(columns));
      std::memcpy(&tile.cut_down[in_tile], &blocks.cut_down[block][in_block], static_cast<std::size_t>(columns));
    });
}

}  // namespace farfield
