// SPDX-License-Identifier: Apache-2.0
// Where in a cell a viewer may stand for a leaf set to speak for them. Walls cut the free space of a leaf into
// enclosures that cannot see each other; each gets a leaf set of its own, and a mask tells which set holds at an eye.
//
// An octree over the cell: its voxels are inside or outside. Where a voxel of the last depth holds a wall, no mask
// claims it: there the leaf set that speaks for the whole leaf is used.
//
// Bytes: the octree in preorder, bits from the lowest of each byte up. Bit 1: divided, eight children follow, x
// fastest, then y, then z. Bit 0: not divided, and one more bit says whether it is inside. Unused bits of the last byte
// are 0. No bytes at all: the whole cell.
#pragma once

#include <memory>
#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/math/box.h"

namespace farfield {

class EnclosureMask {
 public:
  static constexpr int kMaxDepth = 7;
  static constexpr std::size_t kMaxBytes = std::size_t{1} << 16;

  EnclosureMask() = default;  // the whole cell
  /// Returns: the mask, or kBadData for bytes that are no octree within the limits above. Allocates O(bytes).
  static Result<EnclosureMask> from_bytes(ByteView bytes);

  bool is_whole() const { return !tree_; }
  /// `point` in the frame of `cell`; beyond it the nearest voxel answers. O(depth).
  bool contains(const Box& cell, const glm::dvec3& point) const;
  /// Whether the mask holds the point or one of those a smallest voxel of this mask away along the axes.
  bool is_near(const Box& cell, const glm::dvec3& point) const;
  ByteView bytes() const { return tree_ ? ByteView(tree_->bytes) : ByteView(); }

  std::size_t memory_bytes() const {
    return tree_ ? tree_->bytes.size() + sizeof(std::uint32_t) * tree_->nodes.size() : 0;
  }

  bool operator==(const EnclosureMask& other) const;

 private:
  struct Tree {
    Bytes bytes;
    std::vector<std::uint32_t> nodes;  // kOutside, kInside, or the index of the first of eight children
    int depth = 0;                     // of the smallest voxel
  };
  static constexpr std::uint32_t kOutside = 0, kInside = 1;

  std::shared_ptr<const Tree> tree_;  // null: whole
};

/// Writes a mask's bytes in preorder.
class EnclosureMaskWriter {
 public:
  void divide() { put(true); }
  void fill(bool is_inside) {
    put(false);
    put(is_inside);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  void put(bool bit) {
    if (count_ % 8 == 0) bytes_.push_back(0);
    bytes_.back() |= static_cast<std::uint8_t>(bit ? 1u << (count_ % 8) : 0u);
    ++count_;
  }
  Bytes bytes_;
  std::size_t count_ = 0;
};

}  // namespace farfield
