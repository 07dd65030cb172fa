// SPDX-License-Identifier: Apache-2.0
// Format: one range-coded stream. For each 8×8 block in raster order its state (empty, full, mixed) in the context of
// the blocks to the left and above; for mixed blocks 64 bits in the context of the four causal neighbours. Then, again
// by block: whether it holds a cut between two covered samples, and if so a bit for each such pair (contexts: the same
// edge one row or column before, and the cut that crosses it); each cut's position as three bits in the context of
// the previous position along the same silhouette. Where exactly one end is covered the cut is implied.
#include "common/codec/coverage_codec.h"

#include <algorithm>
#include <array>

#include "common/codec/bit_coder.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {
namespace {

struct Contexts {
  std::array<BitContext, 9> is_full{}, is_mixed{};
  std::array<BitContext, 16> covered{};
  std::array<BitContext, 4> has_cuts{};
  std::array<std::array<BitContext, 8>, 2> cut{};
  std::array<std::array<BitContext, 8>, 18> position{};
};

// One walk over the tile serves both directions: `Coder` either writes what the tile says or reads it into the tile.
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
  TopologyWalk(Coder& coder, Tile& tile) : coder_(coder), tile_(tile), neighbours_(tile) {
    columns_ = (tile.width + kBlockSamples - 1) / kBlockSamples;
    rows_ = (tile.height + kBlockSamples - 1) / kBlockSamples;
    states_.assign(static_cast<std::size_t>(columns_) * rows_, 0);
    cut_blocks_.assign(states_.size(), 0);
  }
  void run() {
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) code_coverage(column, row);
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) code_cuts(column, row);
  }

 private:
  template <class Visit>
  void each_sample(int column, int row, Visit visit) {
    const int x_end = std::min(tile_.width, (column + 1) * kBlockSamples);
    const int y_end = std::min(tile_.height, (row + 1) * kBlockSamples);
    for (int y = row * kBlockSamples; y < y_end; ++y)
      for (int x = column * kBlockSamples; x < x_end; ++x) visit(x, y, y * tile_.width + x);
  }
  int covered(int x, int y) const {
    return x >= 0 && y >= 0 && x < tile_.width ? tile_.coverage[static_cast<std::size_t>(y) * tile_.width + x] : 0;
  }

  // The samples of a block in one of the tile's arrays, row by row.
  template <class Visit>
  void each_row(int column, int row, std::vector<std::uint8_t>& values, Visit visit) {
    const int x = column * kBlockSamples, count = std::min(tile_.width, x + kBlockSamples) - x;
    const int y_end = std::min(tile_.height, (row + 1) * kBlockSamples);
    for (int y = row * kBlockSamples; y < y_end; ++y) visit(&values[static_cast<std::size_t>(y) * tile_.width + x], count);
  }
  void fill_block(int column, int row, std::vector<std::uint8_t>& values, std::uint8_t value) {
    each_row(column, row, values, [&](std::uint8_t* first, int count) { std::fill_n(first, count, value); });
  }
  bool is_zero(int column, int row, std::vector<std::uint8_t>& values) {
    std::uint8_t any = 0;
    each_row(column, row, values, [&](const std::uint8_t* first, int count) {
      for (int k = 0; k < count; ++k) any |= first[k];
    });
    return any == 0;
  }

  void code_coverage(int column, int row) {
    const std::size_t block = static_cast<std::size_t>(row) * columns_ + column;
    int count = 0, total = 0;
    each_row(column, row, tile_.coverage, [&](const std::uint8_t* first, int samples) {
      for (int k = 0; k < samples; ++k) count += first[k];
      total += samples;
    });
    const int context = (column > 0 ? states_[block - 1] : 0) * 3 + (row > 0 ? states_[block - columns_] : 0);
    const bool is_mixed = coder_.code(count > 0 && count < total, contexts_.is_mixed[context]);
    const bool is_full = !is_mixed && coder_.code(count == total, contexts_.is_full[context]);
    states_[block] = is_mixed ? 1 : (is_full ? 2 : 0);
    if (!is_mixed) {
      fill_block(column, row, tile_.coverage, is_full);
      return;
    }
    each_sample(column, row, [&](int x, int y, int i) {
      // The sample above and to the right is known only inside this block or in the row of blocks above.
      const bool knows_right = (x + 1) % kBlockSamples != 0 || y % kBlockSamples == 0;
      const int c = covered(x - 1, y) | covered(x, y - 1) << 1 | covered(x - 1, y - 1) << 2 |
                    (knows_right ? covered(x + 1, y - 1) << 3 : 0);
      tile_.coverage[i] = coder_.code(tile_.coverage[i], contexts_.covered[c]);
    });
  }

  // Every edge of the block that has two covered ends, then every edge that has one.
  void code_cuts(int column, int row) {
    const std::size_t block = static_cast<std::size_t>(row) * columns_ + column;
    bool any = false;
    if (states_[block] != 0) {
      if (!is_zero(column, row, tile_.cut_right) || !is_zero(column, row, tile_.cut_down)) {
        each_sample(column, row, [&](int, int, int i) {
          if (!tile_.coverage[i]) return;
          const int right = neighbours_.right(i), down = neighbours_.down(i);
          if (right >= 0 && tile_.coverage[right] && tile_.cut_right[i]) any = true;
          if (down >= 0 && tile_.coverage[down] && tile_.cut_down[i]) any = true;
        });
      }
      const int context = (column > 0 ? cut_blocks_[block - 1] : 0) + 2 * (row > 0 ? cut_blocks_[block - columns_] : 0);
      any = coder_.code(any, contexts_.has_cuts[context]);
    }
    cut_blocks_[block] = any;
    // A block without mixed coverage and without cuts has only the edges across its right and lower border to code.
    const bool is_plain = states_[block] != 1 && !any;
    if (is_plain && !borders_on_another_state(column, row)) {
      fill_block(column, row, tile_.cut_right, kConnected);
      fill_block(column, row, tile_.cut_down, kConnected);
      return;
    }
    const int last_x = std::min(tile_.width, (column + 1) * kBlockSamples) - 1, last_y = std::min(tile_.height, (row + 1) * kBlockSamples) - 1;
    each_sample(column, row, [&](int x, int y, int i) {
      if (is_plain && x < last_x && y < last_y) return;
      code_edge(i, neighbours_.right(i), neighbours_.up(i), neighbours_.left(i), tile_.cut_right, tile_.cut_down, 0, any);
      code_edge(i, neighbours_.down(i), neighbours_.left(i), neighbours_.up(i), tile_.cut_down, tile_.cut_right, 1, any);
    });
  }

  // Whether an edge across a plain block's right or lower border may have one covered end. Neighbours in the image are
  // neighbours on the face only in dense tiles.
  bool borders_on_another_state(int column, int row) const {
    if (tile_.is_packed()) return true;
    const std::size_t block = static_cast<std::size_t>(row) * columns_ + column;
    return (column + 1 < columns_ && states_[block + 1] != states_[block]) || (row + 1 < rows_ && states_[block + columns_] != states_[block]);
  }

  // `along`: the sample whose same edge continues the silhouette; `before`: the sample whose edge leads into this one.
  void code_edge(int i, int other, int along, int before, std::vector<std::uint8_t>& cuts,
                 const std::vector<std::uint8_t>& crossing, int direction, bool block_has_cuts) {
    if (other < 0) {
      cuts[i] = 0;
      return;
    }
    const int ends = tile_.coverage[i] + tile_.coverage[other];
    const int along_cut = along >= 0 ? cuts[along] : 0;
    bool is_cut = ends == 1;
    if (ends == 2 && block_has_cuts) {
      const int context = (along_cut != 0) | (before >= 0 && cuts[before] != 0) << 1 |
                          ((direction == 0 ? (along >= 0 && crossing[along] != 0) : crossing[i] != 0) << 2);
      is_cut = coder_.code(cuts[i] != 0, contexts_.cut[direction][context]);
    }
    if (!is_cut) {
      cuts[i] = 0;
      return;
    }
    auto& tree = contexts_.position[along_cut + 9 * direction];
    int node = 1;
    const int position = cuts[i] == 0 ? 3 : cuts[i] - 1;
    for (int bit = 2; bit >= 0; --bit) node = node * 2 + coder_.code((position >> bit) & 1, tree[node]);
    cuts[i] = static_cast<std::uint8_t>(node - 8 + 1);
  }

  Coder& coder_;
  Tile& tile_;
  TileNeighbours neighbours_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> states_, cut_blocks_;
  Contexts contexts_;
};

}  // namespace

Bytes encode_topology(const Tile& tile) {
  Tile copy;  // the walk normalises what it codes: work on a copy of the topology alone
  copy.id = tile.id;
  copy.width = tile.width, copy.height = tile.height;
  copy.blocks = tile.blocks;
  copy.coverage = tile.coverage;
  copy.cut_right = tile.cut_right, copy.cut_down = tile.cut_down;
  Writer writer;
  TopologyWalk<Writer>(writer, copy).run();
  return writer.coder.finish();
}

void decode_topology(ByteView bytes, Tile& tile) {
  tile.coverage.assign(tile.samples(), 0);
  tile.cut_right.assign(tile.samples(), 0);
  tile.cut_down.assign(tile.samples(), 0);
  Reader reader{BitDecoder(bytes)};
  TopologyWalk<Reader>(reader, tile).run();
}

}  // namespace farfield
