// SPDX-License-Identifier: Apache-2.0
// Where a delta view sees what no earlier view of its shell holds.
//
// Based on: Wilson & Manocha 2003, section 3 (void surface). Differs: asked of the scene by rays, sparsely first.
#pragma once

#include "server/impostor/view_frame.h"
#include "server/impostor/visible_blocks.h"

namespace farfield {

/// A block is cast in patches of a packet each, where a probe finds a void or one reaches on from the next patch: what is
/// missing runs along the rims of nearer things, through a third of a block's samples.
inline constexpr int kPatchSamples = 4;
inline constexpr int kBlockPatches = kBlockSamples / kPatchSamples;
static_assert(kPatchSamples * kPatchSamples == kPacketSize);

/// What a ray of this view hit, until an earlier view is found to hold it.
struct OpenSample {
  glm::dvec3 point, normal;  // scene frame; the normal of any length
  int index;                 // the asker's
};

/// One region of blocks of one delta view. Blocks and patches are counted from the region's first. Keeps references to all it is given.
class VoidFinder {
 public:
  /// `slack`: relative, as of set_segment(); `visible`: blocks outside it hold nothing anybody sees; null: all may.
  VoidFinder(const Scene& scene, const CellSpace& space, const std::vector<glm::dvec3>& views, const TileId& id, const ViewFrame& frame,
             const ImpostorSettings& settings, const VisibleBlocks* visible, double warp_gain, double slack);

  int columns() const { return columns_; }  // of blocks; regions at a face's end have fewer
  int rows() const { return rows_; }
  int face_block_x(int x) const { return id_.x * kRegionBlocks + x; }
  int face_block_y(int y) const { return id_.y * kRegionBlocks + y; }
  /// Whether block (x, y) of the region, or of the ring of blocks around it, is on the face and visible to somebody.
  bool is_visible(int x, int y) const;

  /// Patches where a ray meets a void: one ray a patch, four blocks a packet, and two more where the rim of something nearer
  /// passes, beside which voids are often narrower than a patch. The ring of blocks around the region is probed with it: a
  /// void that reaches across the border counts for the patch inside.
  std::vector<glm::ivec2> find_voids() const;

  /// What is left no earlier view holds.
  void drop_held_by_earlier(std::vector<OpenSample>& open) const;

 private:
  // What the first ray of a patch found.
  struct Probe {
    glm::dvec2 place{0};          // samples, from the region's first
    bool is_cast = false;
    SurfacePlane plane{0, 0, 0};  // disparity 0: nothing
  };
  // Of the region and of the ring of blocks around it, row by row.
  int probe_columns() const { return (columns_ + 2) * kBlockPatches; }
  int probe_index(const glm::ivec2& patch) const { return (patch.y + kBlockPatches) * probe_columns() + patch.x + kBlockPatches; }
  glm::ivec2 probe_patch(int index) const { return glm::ivec2(index % probe_columns(), index / probe_columns()) - kBlockPatches; }
  void set_probe(RayPacket& rays, int lane, const glm::ivec2& patch, const glm::dvec2& place) const;  // samples from the patch's first

  std::vector<OpenSample> probe_once(std::vector<Probe>& probes) const;
  std::vector<OpenSample> probe_again(const std::vector<glm::ivec2>& patches) const;
  std::vector<glm::ivec2> beside_rims(const std::vector<Probe>& probes, const std::vector<std::uint8_t>& is_wanted) const;
  bool are_one_surface(const Probe& a, const Probe& b) const;
  bool stretches(const glm::dvec3& point, const glm::dvec3& normal, int earlier) const;

  const Scene& scene_;
  const CellSpace& space_;
  const std::vector<glm::dvec3>& views_;
  const TileId& id_;
  const ViewFrame& frame_;
  const VisibleBlocks* visible_;
  const ImpostorSettings& settings_;
  const double one_sample_;     // disparity that moves a point by a sample
  const double slack_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace farfield
