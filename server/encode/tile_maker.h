// SPDX-License-Identifier: Apache-2.0
// Makes and encodes tiles: the TileSource of a scene.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "common/codec/tile_codec.h"
#include "server/encode/rate_control.h"
#include "server/encode/tile_source.h"
#include "server/impostor/delta_tile.h"
#include "server/impostor/leaf_planner.h"

namespace farfield {

class TileMaker : public TileSource {
 public:
  TileMaker(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree, std::shared_ptr<ViewSource> views, const NestedShells& shells,
            const ImpostorSettings& settings, std::shared_ptr<RateControl> rates = nullptr);

  Result<std::shared_ptr<const EncodedTile>> make(const TileId& id, const CancelFlag& cancel) override;

  /// The tile before encoding: for tests and for comparing with truth.
  Result<Tile> cast(const TileId& id, const CancelFlag& cancel, TileWork& work);
  TileSkips skips() const override {
    const std::lock_guard lock(mutex_);
    return skipped_;
  }
  CertificateCounts certificates() const override { return {certified_, refined_, missed_}; }

 private:
  /// The tile's bytes, its certificate among them; coded finer where its target asks for it. Fallback views have neither.
  Result<Bytes> encode_certified(const Tile& tile, int quality, TileBytes& accounting, StageSeconds& stages);

  const std::shared_ptr<const Scene> scene_;
  const std::shared_ptr<ViewSource> views_;
  const NestedShells shells_;
  const ImpostorSettings settings_;
  const std::shared_ptr<RateControl> rates_;  // null: fixed quality
  int quality_of(const TileId& id) const;
  /// The colour quality of a tile that covers something; its tolerance of disparity is set to the cell's.
  Result<int> steer(Tile& tile, const CancelFlag& cancel) const;
  Result<Tile> cast_counted(const TileId& id, const CancelFlag& cancel, TileWork& work, TileSkips& skips);
  Result<std::shared_ptr<const VisibleBlocks>> visible_blocks(const CellSpace& space, const glm::dvec3& position, int view,
                                                              const CancelFlag& cancel);
  /// Points in a leaf's own shell that were seen from it: for all of its views.
  Result<std::shared_ptr<const std::vector<glm::vec3>>> seen_in_shell(const CellSpace& space, const CancelFlag& cancel);

  const std::shared_ptr<CellTree> tree_;
  const double fallback_gain_;
  /// Notes what a tile shows. Returns: whether that of another cell showed the same.
  bool is_known(ContentHash content, const CellId& cell);

  std::atomic<std::uint64_t> certified_{0}, refined_{0}, missed_{0};
  mutable std::mutex mutex_;  // guards what follows
  TileSkips skipped_;
  std::unordered_map<ContentHash, CellId> shown_;  // by content, the cell whose tile showed it first
  std::list<std::pair<std::pair<CellId, int>, std::shared_ptr<const VisibleBlocks>>> recent_;  // of leaves' views, newest first
  std::list<std::pair<CellId, std::shared_ptr<const std::vector<glm::vec3>>>> recent_points_;
};

/// A leaf source and a tile source that share the tree and the views of one scene.
struct ImpostorSources {
  std::shared_ptr<CellTree> tree;
  std::shared_ptr<ViewSource> views;
  std::shared_ptr<LeafPlanner> leaves;
  std::shared_ptr<TileMaker> tiles;
};
ImpostorSources make_impostor_sources(std::shared_ptr<const Scene> scene, const ImpostorSettings& settings);

/// The settings' finest side for a scene: `wanted_m`, or less for scenes so small that cells of that size would hold them
/// whole; always a power of two.
double finest_side_for(const Scene& scene, double wanted_m);

}  // namespace farfield
