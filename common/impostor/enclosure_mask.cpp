// SPDX-License-Identifier: Apache-2.0
#include "common/impostor/enclosure_mask.h"

#include <algorithm>
#include <cmath>

namespace farfield {
namespace {

class BitReader {
 public:
  explicit BitReader(ByteView bytes) : bytes_(bytes) {}
  bool is_at_end() const { return at_ >= 8 * bytes_.size(); }
  /// Past the end: 0, as in the padding.
  bool get() {
    if (is_at_end()) return is_short_ = true, false;
    const bool bit = bytes_[at_ / 8] >> (at_ % 8) & 1;
    ++at_;
    return bit;
  }
  bool is_short() const { return is_short_; }
  std::size_t left() const { return 8 * bytes_.size() - at_; }

 private:
  ByteView bytes_;
  std::size_t at_ = 0;
  bool is_short_ = false;
};

}  // namespace

Result<EnclosureMask> EnclosureMask::from_bytes(ByteView bytes) {
  if (bytes.empty()) return EnclosureMask();
  if (bytes.size() > kMaxBytes) {
    return fail(ErrorCode::kLimitExceeded, "the mask of an enclosure takes {} bytes; at most {} are accepted",
                bytes.size(), kMaxBytes);
  }
  auto tree = std::make_shared<Tree>();
  tree->bytes.assign(bytes.begin(), bytes.end());
  BitReader bits(bytes);
  tree->nodes.push_back(kOutside);
  // Every node takes at least one bit, so there are never more than the bytes have room for.
  const auto read = [&](const auto& self, std::size_t node, int depth) -> bool {
    if (!bits.get()) {
      tree->nodes[node] = bits.get() ? kInside : kOutside;
      return !bits.is_short();
    }
    if (depth == kMaxDepth || bits.left() < 8) return false;
    const std::size_t first = tree->nodes.size();
    tree->depth = std::max(tree->depth, depth + 1);
    tree->nodes[node] = static_cast<std::uint32_t>(first);
    tree->nodes.resize(first + 8, kOutside);
    for (std::size_t child = 0; child < 8; ++child)
      if (!self(self, first + child, depth + 1)) return false;
    return true;
  };
  // The first children stand at index 1, which is kInside as well: an unused node in between keeps the two apart.
  tree->nodes.push_back(kOutside);
  if (!read(read, 0, 0) || bits.left() >= 8) {
    return fail(ErrorCode::kBadData,
                "the mask of an enclosure ends in the middle, goes on after its end, or is too deep");
  }
  EnclosureMask mask;
  mask.tree_ = std::move(tree);
  return mask;
}

bool EnclosureMask::contains(const Box& cell, const glm::dvec3& point) const {
  if (!tree_) return true;
  constexpr int kEdge = 1 << kMaxDepth;
  const glm::dvec3 place = (point - cell.min) / cell.extent() * static_cast<double>(kEdge);
  int voxel[3];
  for (int axis = 0; axis < 3; ++axis)
    voxel[axis] = static_cast<int>(std::clamp(std::floor(place[axis]), 0.0, kEdge - 1.0));
  std::uint32_t node = 0;
  for (int bit = kMaxDepth - 1; tree_->nodes[node] > kInside; --bit) {
    const auto half = [&](int axis) { return static_cast<std::uint32_t>(voxel[axis] >> bit & 1); };
    node = tree_->nodes[node] + (half(0) | half(1) << 1 | half(2) << 2);
  }
  return tree_->nodes[node] == kInside;
}

bool EnclosureMask::is_near(const Box& cell, const glm::dvec3& point) const {
  if (contains(cell, point)) return true;
  const glm::dvec3 voxel = cell.extent() / static_cast<double>(1 << tree_->depth);
  for (int axis = 0; axis < 3; ++axis)
    for (const double step : {-1.0, 1.0}) {
      glm::dvec3 beside = point;
      beside[axis] += step * voxel[axis];
      if (contains(cell, beside)) return true;
    }
  return false;
}

bool EnclosureMask::operator==(const EnclosureMask& other) const {
  if (tree_ == other.tree_) return true;
  return tree_ && other.tree_ && tree_->bytes == other.tree_->bytes;
}

}  // namespace farfield
