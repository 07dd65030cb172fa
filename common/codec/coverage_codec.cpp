// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream. For each 8×8 block in raster order its state (empty, full, mixed) in the context of
// the blocks to the left and above; for mixed blocks 64 bits in the context of the four causal neighbours. Then, again
// by block: whether it holds a cut between two covered samples, and if so a bit for each such pair (contexts: the same
// edge one row or column before, and the cut that crosses it); each cut's position as three bits in the context of
// the previous position along the same silhouette. Where exactly one end is covered the cut is implied.
#include "common/codec/coverage_codec.h"

#include <array>
#include <bit>
#include <cstring>

#include "common/codec/bit_coder.h"

namespace farfield {
namespace {

struct Contexts {
  std::array<BitContext, 9> is_full{}, is_mixed{};
  std::array<BitContext, 16> covered{};
  std::array<BitContext, 4> has_cuts{};
  std::array<std::array<BitContext, 8>, 2> cut{};
  std::array<std::array<BitContext, 8>, 18> position{};
};

// One byte per sample of a block, row by row.
using BlockValues = std::array<std::uint8_t, kBlockSamples * kBlockSamples>;

// A tile's topology, block by block.
struct Topology {
  std::vector<std::uint64_t> covered;
  std::vector<BlockValues> cut_right, cut_down;

  explicit Topology(const BlockGrid& grid) : covered(grid.size(), 0), cut_right(grid.size()), cut_down(grid.size()) {}
};

// One walk over the blocks serves both directions: `Coder` either writes what they say or reads it into them.
struct Writer {
  BitEncoder coder;
  bool code(bool bit, BitContext& context) {
    coder.put(bit, context);
    return bit;
  }
};
struct Reader {
  BitDecoder coder;
  bool code(bool, BitContext& context) { return coder.get(context); }
};

template <class Coder>
class TopologyWalk {
 public:
  TopologyWalk(Coder& coder, const BlockGrid& grid, Topology& blocks)
      : coder_(coder), grid_(grid), blocks_(blocks), states_(grid.size(), 0), cut_blocks_(grid.size(), 0) {}
  void run() {
    for (int block = 0; block < grid_.size(); ++block) code_coverage(block);
    for (int block = 0; block < grid_.size(); ++block) code_cuts(block);
  }

 private:
  // What a word says of a block in the image, relative to another: 0 beyond the image's left, upper and right borders.
  bool has_left(int block) const { return block % grid_.columns() > 0; }
  bool has_right(int block) const { return block % grid_.columns() + 1 < grid_.columns(); }
  bool has_above(int block) const { return block >= grid_.columns(); }

  void code_coverage(int block) {
    std::uint64_t& covered = blocks_.covered[block];
    const std::uint64_t samples = grid_.samples(block);
    const int above = block - grid_.columns();
    const int context = (has_left(block) ? states_[block - 1] : 0) * 3 + (has_above(block) ? states_[above] : 0);
    const bool is_mixed = coder_.code(covered != 0 && covered != samples, contexts_.is_mixed[context]);
    const bool is_full = !is_mixed && coder_.code(covered == samples, contexts_.is_full[context]);
    states_[block] = is_mixed ? 1 : (is_full ? 2 : 0);
    if (!is_mixed) {
      covered = is_full ? samples : 0;
      return;
    }
    const std::uint64_t left = has_left(block) ? blocks_.covered[block - 1] : 0, wanted = covered;
    covered = 0;
    // Bits x … x + 2 of `row_above` are the samples above x - 1, x and x + 1. The sample above and to the right is known only
    // inside this block or in the row of blocks above.
    unsigned row_above = 0;
    if (has_above(block)) {
      row_above = static_cast<unsigned>(blocks_.covered[above] >> 56) << 1;
      if (has_left(block)) row_above |= static_cast<unsigned>(blocks_.covered[above - 1] >> 63);
      if (has_right(block)) row_above |= static_cast<unsigned>(blocks_.covered[above + 1] >> 56 & 1) << 9;
    }
    for (int y = 0; y < kBlockSamples; ++y) {
      unsigned row = static_cast<unsigned>(left >> (8 * y + 7) & 1);  // bit x + 1: sample x
      for (int x = 0; x < kBlockSamples; ++x) {
        const int k = 8 * y + x;
        if (!(samples >> k & 1)) continue;
        const unsigned near = row_above >> x;
        const unsigned c = (row >> x & 1) | (near & 2) | (near & 1) << 2 | (near & 4) << 1;
        row |= static_cast<unsigned>(coder_.code(wanted >> k & 1, contexts_.covered[c])) << (x + 1);
      }
      covered |= std::uint64_t{row >> 1} << 8 * y;
      row_above = row;
    }
  }

  // Every edge of the block that has two covered ends, if any of these is cut, and every edge that has one.
  void code_cuts(int block) {
    const BlockGrid::Beside& beside = grid_.beside(block);
    const std::uint64_t covered = blocks_.covered[block];
    const std::uint64_t right = bits_to_the_right(covered, beside.right < 0 ? 0 : blocks_.covered[beside.right]);
    const std::uint64_t below = bits_below(covered, beside.below < 0 ? 0 : blocks_.covered[beside.below]);
    BlockValues &cut_right = blocks_.cut_right[block], &cut_down = blocks_.cut_down[block];
    bool any = false;
    if (states_[block] != 0) {
      any = has_cut(cut_right, covered & right) || has_cut(cut_down, covered & below);
      const int context = (has_left(block) ? cut_blocks_[block - 1] : 0) + 2 * (has_above(block) ? cut_blocks_[block - grid_.columns()] : 0);
      any = coder_.code(any, contexts_.has_cuts[context]);
    }
    cut_blocks_[block] = any;

    const BlockValues wanted_right = cut_right, wanted_down = cut_down;
    cut_right.fill(kConnected), cut_down.fill(kConnected);
    const std::uint64_t code_right = (any ? covered | right : covered ^ right) & grid_.with_right(block);
    const std::uint64_t code_down = (any ? covered | below : covered ^ below) & grid_.with_below(block);
    for (std::uint64_t todo = code_right | code_down; todo != 0; todo &= todo - 1) {
      const int k = std::countr_zero(todo);
      const int right_above = value_above(blocks_.cut_right, k, block, beside.above), down_above = value_above(blocks_.cut_down, k, block, beside.above);
      if (code_right >> k & 1) {
        const int before = value_left(blocks_.cut_right, k, block, beside.left);
        const int context = (right_above != 0) | (before != 0) << 1 | (down_above != 0) << 2;
        cut_right[k] = code_edge((covered & right) >> k & 1, wanted_right[k], right_above, contexts_.cut[0][context], 0);
      }
      if (code_down >> k & 1) {
        const int along = value_left(blocks_.cut_down, k, block, beside.left);
        const int context = (along != 0) | (down_above != 0) << 1 | (cut_right[k] != 0) << 2;
        cut_down[k] = code_edge((covered & below) >> k & 1, wanted_down[k], along, contexts_.cut[1][context], 1);
      }
    }
  }

  static bool has_cut(const BlockValues& cuts, std::uint64_t where) {
    if (cuts == BlockValues{}) return false;
    for (; where != 0; where &= where - 1)
      if (cuts[std::countr_zero(where)] != kConnected) return true;
    return false;
  }
  static int value_above(const std::vector<BlockValues>& values, int k, int block, int above) {
    return k >= 8 ? values[block][k - 8] : above >= 0 ? values[above][k + 56] : 0;
  }
  static int value_left(const std::vector<BlockValues>& values, int k, int block, int left) {
    return k % 8 > 0 ? values[block][k - 1] : left >= 0 ? values[left][k + 7] : 0;
  }

  // `along`: the same edge's cut one row or column before, along the silhouette.
  std::uint8_t code_edge(bool has_two_ends, int wanted, int along, BitContext& is_cut, int direction) {
    if (has_two_ends && !coder_.code(wanted != kConnected, is_cut)) return kConnected;
    auto& tree = contexts_.position[along + 9 * direction];
    int node = 1;
    const int position = wanted == kConnected ? 3 : wanted - 1;
    for (int bit = 2; bit >= 0; --bit) node = node * 2 + coder_.code((position >> bit) & 1, tree[node]);
    return static_cast<std::uint8_t>(node - 8 + 1);
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
  Writer writer;
  TopologyWalk<Writer>(writer, grid, blocks).run();
  return writer.coder.finish();
}

void decode_topology(ByteView bytes, Tile& tile) {
  const BlockGrid grid(tile);
  Topology blocks(grid);
  Reader reader{BitDecoder(bytes)};
  TopologyWalk<Reader>(reader, grid, blocks).run();
  tile.coverage.resize(tile.samples()), tile.cut_right.resize(tile.samples()), tile.cut_down.resize(tile.samples());
  for (int block = 0; block < grid.size(); ++block)
    each_row(grid, block, [&](std::size_t in_tile, int in_block, int columns) {
      for (int x = 0; x < columns; ++x) tile.coverage[in_tile + x] = blocks.covered[block] >> (in_block + x) & 1;
      std::memcpy(&tile.cut_right[in_tile], &blocks.cut_right[block][in_block], static_cast<std::size_t>(columns));
      std::memcpy(&tile.cut_down[in_tile], &blocks.cut_down[block][in_block], static_cast<std::size_t>(columns));
    });
}

}  // namespace farfield
