// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/surface_pieces.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/impostor/drawn_samples.h"
#include "common/impostor/splat_reach.h"

namespace farfield {
namespace {

/// How far a sample may lie off its piece's plane, in parts of the tile's tolerance.
constexpr float kPlaneShare = 1.0f / 8.0f;
/// Smaller pieces cost more than their samples drawn one by one.
constexpr int kLeastSamples = 6;

/// One bit per sample of a square: bit 8·j + i.
using Mask = std::uint64_t;
constexpr Mask kAll = ~Mask{0};
constexpr Mask kFirstColumn = 0x0101010101010101u;
constexpr Mask bit(int i, int j) { return Mask{1} << (kSquareEdge * j + i); }

/// Indices into the tile's arrays of a square's samples and those around it; -1: the tile holds nothing there.
class Window {
 public:
  int at(int i, int j) const { return index_[(j + 1) * kRingEdge + i + 1]; }
  int& at(int i, int j) { return index_[(j + 1) * kRingEdge + i + 1]; }

  /// Columns × rows from (column, row) of a dense tile.
  static Window of_dense(const Tile& tile, int column, int row) {
    Window window;
    for (int j = -1; j <= kSquareEdge; ++j) {
      for (int i = -1; i <= kSquareEdge; ++i) {
        const int x = column + i, y = row + j;
        const bool is_held = x >= 0 && y >= 0 && x < tile.width && y < tile.height;
        window.at(i, j) = is_held ? y * tile.width + x : -1;
      }
    }
    return window;
  }
  static Window of_block(const Tile& tile, const TileNeighbours& neighbours, std::size_t block) {
    Window window;
    const int first = static_cast<int>(block / kPackedColumns) * kBlockSamples * tile.width +
                      static_cast<int>(block % kPackedColumns) * kBlockSamples;
    const auto left = [&](int index) { return index < 0 ? -1 : neighbours.left(index); };
    const auto right = [&](int index) { return index < 0 ? -1 : neighbours.right(index); };
    const int last_row = first + (kBlockSamples - 1) * tile.width;
    for (int i = 0; i < kBlockSamples; ++i) {
      for (int j = 0; j < kBlockSamples; ++j) window.at(i, j) = first + j * tile.width + i;
      window.at(i, -1) = neighbours.up(first + i);
      window.at(i, kBlockSamples) = neighbours.down(last_row + i);
      const int row = first + i * tile.width;
      window.at(-1, i) = neighbours.left(row);
      window.at(kBlockSamples, i) = neighbours.right(row + kBlockSamples - 1);
    }
    const int last = kBlockSamples - 1;
    window.at(-1, -1) = left(neighbours.up(first));
    window.at(kBlockSamples, -1) = right(neighbours.up(first + last));
    window.at(-1, kBlockSamples) = left(neighbours.down(last_row));
    window.at(kBlockSamples, kBlockSamples) = right(neighbours.down(last_row + last));
    return window;
  }

 private:
  std::array<int, kRingEdge * kRingEdge> index_;
};

/// Sums for a least-squares plane. Positions are small integers: their sums are exact.
struct PlaneSums {
  std::int64_t count = 0, i = 0, j = 0, ii = 0, ij = 0, jj = 0;
  double d = 0, id = 0, jd = 0;
  void add(int at_i, int at_j, float disparity) {
    const double value = disparity;
    ++count, i += at_i, j += at_j, ii += at_i * at_i, ij += at_i * at_j, jj += at_j * at_j;
    d += value, id += at_i * value, jd += at_j * value;
  }
  /// Whether all stand in one row or column (connected samples in one line do).
  bool is_line() const { return variance_i() * variance_j() == covariance() * covariance(); }
  void solve(SurfacePiece& piece) const {
    const double n = static_cast<double>(count), i_d = n * id - static_cast<double>(i) * d, j_d = n * jd - static_cast<double>(j) * d;
    const double a = static_cast<double>(variance_i()), b = static_cast<double>(covariance()), c = static_cast<double>(variance_j());
    double slope_u = 0, slope_v = 0;
    if (!is_line()) {
      slope_u = (i_d * c - j_d * b) / (a * c - b * b), slope_v = (j_d * a - i_d * b) / (a * c - b * b);
    } else if (variance_i() > 0) {
      slope_u = i_d / a;
    } else if (variance_j() > 0) {
      slope_v = j_d / c;
    }
    piece.disparity = static_cast<float>((d - slope_u * static_cast<double>(i) - slope_v * static_cast<double>(j)) / n);
    piece.slope_u = static_cast<float>(slope_u), piece.slope_v = static_cast<float>(slope_v);
  }

 private:
  std::int64_t variance_i() const { return count * ii - i * i; }
  std::int64_t variance_j() const { return count * jj - j * j; }
  std::int64_t covariance() const { return count * ij - i * j; }
};

class PieceFinder {
 public:
  PieceFinder(const Tile& tile, SurfacePieces& found, InPieces& in_pieces)
      : tile_(tile), found_(found), in_pieces_(in_pieces), worst_(kPlaneShare * tile.disparity_tolerance) {}

  /// `drawn`: which of the square's samples the tile draws.
  void add_square(const Window& window, int face_column, int face_row, Mask drawn) {
    window_ = &window;
    find_links();
    if ((covered_ & drawn) == 0) return;
    PieceSquare square;
    square.column = static_cast<std::uint16_t>(face_column), square.row = static_cast<std::uint16_t>(face_row);
    square.first_piece = static_cast<std::uint32_t>(found_.pieces.size());
    square.lowest = std::numeric_limits<float>::infinity(), square.highest = -square.lowest;
    Mask held = 0;
    for (Mask left = covered_; left != 0;) {
      const Mask surface = surface_at(left & (~left + 1));
      left &= ~surface;
      if ((surface & drawn) == 0) continue;
      SurfacePiece piece;
      set_held(surface, piece);
      held |= add_pieces(surface & drawn, piece, square);
    }
    if (held == 0) return;
    found_.samples += static_cast<std::uint32_t>(std::popcount(held));
    add_reaches(held, square);
    add_texels();
    found_.squares.push_back(square);
  }

 private:
  bool is_covered(int index) const { return index >= 0 && tile_.coverage[index]; }
  bool is_linked(const std::vector<std::uint8_t>& cuts, int before, int after) const {
    return is_covered(before) && is_covered(after) && cuts[before] == kConnected;
  }

  void find_links() {
    covered_ = links_right_ = links_down_ = 0;
    for (int j = 0; j < kSquareEdge; ++j) {
      for (int i = 0; i < kSquareEdge; ++i) {
        const int here = window_->at(i, j);
        if (!is_covered(here)) continue;
        covered_ |= bit(i, j);
        if (i + 1 < kSquareEdge && is_linked(tile_.cut_right, here, window_->at(i + 1, j))) links_right_ |= bit(i, j);
        if (j + 1 < kSquareEdge && is_linked(tile_.cut_down, here, window_->at(i, j + 1))) links_down_ |= bit(i, j);
      }
    }
    links_right_ &= covered_ >> 1, links_down_ &= covered_ >> kSquareEdge;
  }

  /// Everything within the square that links join with `seed`.
  Mask surface_at(Mask seed) const {
    for (Mask part = seed;;) {
      const Mask grown = part | (part & links_right_) << 1 | (part >> 1 & links_right_) |
                         (part & links_down_) << kSquareEdge | (part >> kSquareEdge & links_down_);
      if (grown == part) return part;
      part = grown;
    }
  }

  float disparity(int i, int j) const { return tile_.disparity[window_->at(i, j)]; }

  /// Divides `part` of a surface until all is plane. Returns: the samples that came to be in pieces.
  Mask add_pieces(Mask part, SurfacePiece& piece, PieceSquare& square) {
    if (std::popcount(part) < kLeastSamples) return 0;
    if (fit(part, piece, square)) {
      piece.own = part;
      found_.pieces.push_back(piece);
      for (Mask left = part; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        in_pieces_[window_->at(k % kSquareEdge, k / kSquareEdge)] = 1;
      }
      return part;
    }
    const Mask half = first_half(part);
    return add_pieces(half, piece, square) | add_pieces(part & ~half, piece, square);
  }

  /// Cuts across the longer side of what holds it.
  static Mask first_half(Mask part) {
    unsigned columns = 0, rows = 0;
    for (int j = 0; j < kSquareEdge; ++j) {
      const unsigned row = part >> (kSquareEdge * j) & 0xff;
      columns |= row, rows |= (row != 0 ? 1u : 0u) << j;
    }
    const auto middle = [](unsigned bits) { return (std::countr_zero(bits) + std::bit_width(bits)) / 2; };
    const auto length = [](unsigned bits) { return std::bit_width(bits) - std::countr_zero(bits); };
    if (length(rows) >= length(columns)) return part & ((Mask{1} << (kSquareEdge * middle(rows))) - 1);
    return part & kFirstColumn * ((1u << middle(columns)) - 1);
  }

  /// Sets the piece's plane. Returns: false if some sample lies off it.
  bool fit(Mask part, SurfacePiece& piece, PieceSquare& square) const {
    PlaneSums sums;
    for (Mask left = part; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left);
      sums.add(k % kSquareEdge, k / kSquareEdge, disparity(k % kSquareEdge, k / kSquareEdge));
    }
    if (sums.is_line()) add_ring(piece, sums);  // how it slopes across the line, only those around it can tell
    sums.solve(piece);
    float lowest = square.lowest, highest = square.highest;
    const float change = std::fabs(piece.slope_u) + std::fabs(piece.slope_v);
    for (Mask left = part; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left), i = k % kSquareEdge, j = k / kSquareEdge;
      const float plane = piece.disparity + static_cast<float>(i) * piece.slope_u + static_cast<float>(j) * piece.slope_v;
      if (!(std::fabs(plane - disparity(i, j)) <= worst_)) return false;
      lowest = std::min(lowest, plane - change), highest = std::max(highest, plane + change);
    }
    square.lowest = lowest, square.highest = highest;
    return true;
  }

  void add_ring(const SurfacePiece& piece, PlaneSums& sums) const {
    for (int j = -1; j <= kSquareEdge; ++j) {
      for (int i = -1; i <= kSquareEdge; ++i) {
        const bool is_inside = i >= 0 && j >= 0 && i < kSquareEdge && j < kSquareEdge;
        if (!is_inside && piece.held[j + 1] >> (i + 1) & 1) sums.add(i, j, disparity(i, j));
      }
    }
  }

  /// A surface's samples in the square and, around it, those linked to them.
  void set_held(Mask part, SurfacePiece& piece) const {
    const auto has = [&](int i, int j) { return (part & bit(i, j)) != 0; };
    const auto set = [&](int i, int j) { piece.held[j + 1] = static_cast<std::uint16_t>(piece.held[j + 1] | 1u << (i + 1)); };
    const auto is_set = [&](int i, int j) { return (piece.held[j + 1] >> (i + 1) & 1) != 0; };
    const Window& w = *window_;
    const int end = kSquareEdge, last = end - 1;
    for (int k = 0; k < end; ++k) {
      piece.held[k + 1] = static_cast<std::uint16_t>((part >> (kSquareEdge * k) & 0xff) << 1);
      if (has(k, 0) && is_linked(tile_.cut_down, w.at(k, -1), w.at(k, 0))) set(k, -1);
      if (has(k, last) && is_linked(tile_.cut_down, w.at(k, last), w.at(k, end))) set(k, end);
    }
    for (int k = 0; k < end; ++k) {
      if (has(0, k) && is_linked(tile_.cut_right, w.at(-1, k), w.at(0, k))) set(-1, k);
      if (has(last, k) && is_linked(tile_.cut_right, w.at(last, k), w.at(end, k))) set(end, k);
    }
    for (const int j : {-1, end}) {
      const int inner_j = j < 0 ? 0 : last;
      const auto is_linked_along_v = [&](int i) {
        return is_linked(tile_.cut_down, w.at(i, std::min(j, inner_j)), w.at(i, std::max(j, inner_j)));
      };
      if ((is_set(0, j) && is_linked(tile_.cut_right, w.at(-1, j), w.at(0, j))) || (is_set(-1, inner_j) && is_linked_along_v(-1)))
        set(-1, j);
      if ((is_set(last, j) && is_linked(tile_.cut_right, w.at(last, j), w.at(end, j))) || (is_set(end, inner_j) && is_linked_along_v(end)))
        set(end, j);
    }
  }

  void add_reaches(Mask held, PieceSquare& square) {
    const std::size_t first = found_.reach.size();
    found_.reach.resize(first + kSquareSamples, 0);
    const SurfacePiece& last = found_.pieces.back();
    bool is_whole = last.own == kAll && std::all_of(last.held.begin(), last.held.end(),
                                                    [](std::uint16_t row) { return row == (1u << kRingEdge) - 1; });
    for (Mask left = held; left != 0; left &= left - 1) {
      const int k = std::countr_zero(left), i = k % kSquareEdge, j = k / kSquareEdge;
      const Window& w = *window_;
      const std::uint16_t reach = reach_of_sample(tile_, w.at(i, j), w.at(i - 1, j), w.at(i + 1, j), w.at(i, j - 1), w.at(i, j + 1));
      found_.reach[first + static_cast<std::size_t>(k)] = reach;
      is_whole = is_whole && reach == kReachAllConnected;
    }
    square.first_reach = is_whole ? SurfacePieces::kAllConnected : static_cast<std::uint32_t>(first);
    if (is_whole) found_.reach.resize(first);
  }

  void add_texels() {
    const std::size_t first = found_.texels.size();
    found_.texels.resize(first + kSquareTexelBytes, 0);
    std::uint8_t* to = found_.texels.data() + first;
    for (int j = -1; j <= kSquareEdge; ++j) {
      for (int i = -1; i <= kSquareEdge; ++i, ++to) {
        const int index = window_->at(i, j);
        if (!is_covered(index)) continue;
        for (int c = 0; c < 3; ++c) to[c * kSquareTexels] = tile_.rgb[3 * static_cast<std::size_t>(index) + static_cast<std::size_t>(c)];
      }
    }
  }

  const Tile& tile_;
  SurfacePieces& found_;
  InPieces& in_pieces_;
  const float worst_;
  const Window* window_ = nullptr;
  // Of the square at hand: its samples, and those joined with the next one along the row, the column.
  Mask covered_ = 0, links_right_ = 0, links_down_ = 0;
};

void add_dense(const Tile& tile, PieceFinder& finder) {
  const DrawnSamples drawn(tile);
  const int face_column = tile.id.x * kTileStride, face_row = tile.id.y * kTileStride;
  for (int row = drawn.first_row; row < drawn.end_row; row += kSquareEdge) {
    for (int column = drawn.first_column; column < drawn.end_column; column += kSquareEdge) {
      Mask mask = kAll;
      for (int k = drawn.end_column - column; k < kSquareEdge; ++k) mask &= ~(kFirstColumn << k);
      if (drawn.end_row - row < kSquareEdge) mask &= (Mask{1} << (kSquareEdge * (drawn.end_row - row))) - 1;
      finder.add_square(Window::of_dense(tile, column, row), face_column + column, face_row + row, mask);
    }
  }
}

void add_packed(const Tile& tile, PieceFinder& finder) {
  const TileNeighbours neighbours(tile);
  for (std::size_t b = 0; b < tile.blocks.size(); ++b) {
    finder.add_square(Window::of_block(tile, neighbours, b), tile.blocks[b].x * kBlockSamples, tile.blocks[b].y * kBlockSamples, kAll);
  }
}

void find_groups(SurfacePieces& found) {
  for (std::size_t k = 0; k < found.squares.size(); ++k) {
    const PieceSquare& square = found.squares[k];
    if (k % kGroupSquares == 0) found.groups.push_back({square.column, square.column, square.row, square.row, square.lowest, square.highest});
    SquareGroup& group = found.groups.back();
    group.first_column = std::min(group.first_column, square.column), group.last_column = std::max(group.last_column, square.column);
    group.first_row = std::min(group.first_row, square.row), group.last_row = std::max(group.last_row, square.row);
    group.lowest = std::min(group.lowest, square.lowest), group.highest = std::max(group.highest, square.highest);
  }
  found.groups.shrink_to_fit();
}

}  // namespace

std::size_t SurfacePieces::memory_bytes() const {
  return squares.capacity() * sizeof(PieceSquare) + groups.capacity() * sizeof(SquareGroup) + pieces.capacity() * sizeof(SurfacePiece) +
         reach.capacity() * sizeof(std::uint16_t) + texels.capacity();
}

SurfacePieces find_surface_pieces(const Tile& tile, InPieces& in_pieces) {
  SurfacePieces found;
  in_pieces.assign(tile.samples(), 0);
  if (!(tile.disparity_tolerance > 0)) return found;
  PieceFinder finder(tile, found, in_pieces);
  if (tile.is_packed()) {
    add_packed(tile, finder);
  } else {
    add_dense(tile, finder);
  }
  find_groups(found);
  if (!found.squares.empty()) found.texels.resize(found.texels.size() + kTexelPadding, 0);
  found.squares.shrink_to_fit(), found.pieces.shrink_to_fit(), found.reach.shrink_to_fit(), found.texels.shrink_to_fit();
  return found;
}

}  // namespace farfield
