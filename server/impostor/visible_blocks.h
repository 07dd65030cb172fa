// SPDX-License-Identifier: Apache-2.0
// Which 8×8 blocks of a view of a leaf's shell hold what some viewpoint of the leaf can see: what near geometry always hides is
// neither cast nor sent. Only for leaves: an inner cell's shell is shared by leaves that see different parts of it.
#pragma once

#include <span>
#include <vector>

#include "server/impostor/cell_space.h"
#include "server/visibility/box_visibility.h"

namespace farfield {

class VisibleBlocks {
 public:
  /// From the points that a dense probe of the leaf hit in its shell (some dozen per block), grown by two blocks on every
  /// side against what the probe missed. O(points + blocks).
  VisibleBlocks(std::span<const glm::vec3> in_shell, const glm::dvec3& view, int edge_samples);

  /// (i, j): a sample of the face, whole samples.
  bool contains(int face, int i, int j) const {
    return blocks_[(static_cast<std::size_t>(face) * edge_ + j / kBlockSamples) * edge_ + i / kBlockSamples];
  }
  std::size_t visible() const;
  std::size_t size() const { return blocks_.size(); }

 private:
  int edge_;  // blocks along a face
  std::vector<std::uint8_t> blocks_;
};

/// Of what was hit from a leaf, the points in its own shell.
std::vector<glm::vec3> points_in_shell(const BoxVisibility& seen, const CellSpace& space);

}  // namespace farfield
