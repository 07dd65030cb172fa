// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/cell_needs.h"

#include <map>

#include "server/impostor/shell_needs.h"

namespace farfield {
namespace {

constexpr int kEighths = 8;
constexpr int kEighthEdge = 24;  // rays per face edge from each of 27 viewpoints: some hundred into each tile

Box eighth_of(const Box& box, int index) {
  const glm::dvec3 half = 0.5 * box.extent();
  const glm::dvec3 first = box.min + half * glm::dvec3(index & 1, index >> 1 & 1, index >> 2 & 1);
  return {first, first + half};
}

std::vector<NeededTile> tiles_seen(const Scene& scene, const CellSpace& space, const std::shared_ptr<const ShellViews>& views,
                                   const ImpostorSettings& settings, const BoxVisibility& sight) {
  ShellNeeds needs(scene, space, views, settings, sight);
  for (const FarHit& hit : sight.far_hits)
    if (space.contains(glm::dvec3(hit.point))) needs.add(hit);
  needs.ask_delta_views();
  std::vector<NeededTile> tiles;
  needs.list(ShellNeeds::kWhole, tiles);
  return tiles;
}

}  // namespace

Result<std::vector<CellNeed>> cell_needs(const Scene& scene, CellTree& tree, const CellSpace& space, const std::shared_ptr<const ShellViews>& views,
                                         const ImpostorSettings& settings, const CancelFlag& cancel) {
  const Result<bool> is_leaf = tree.is_leaf(space.cell, cancel);
  if (!is_leaf) return tl::unexpected(is_leaf.error());
  std::vector<std::vector<NeededTile>> of_leaves, of_blocked;
  if (*is_leaf) {
    const auto sight = tree.visibility(space.cell, cancel);
    if (!sight) return tl::unexpected(sight.error());
    of_leaves.push_back(tiles_seen(scene, space, views, settings, **sight));
  } else {
    for (int k = 0; k < kEighths; ++k) {
      VisibilityProbe probe;
      probe.edge = kEighthEdge, probe.is_thorough = false, probe.cancel = cancel.get();
      const BoxVisibility sight = probe_visibility(scene, eighth_of(space.box, k), space.shell.inside, probe);
      if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
      (sight.is_blocked ? of_blocked : of_leaves).push_back(tiles_seen(scene, space, views, settings, sight));
    }
    if (of_leaves.empty()) of_leaves = std::move(of_blocked);  // for whoever flies through
  }
  std::map<TileId, CellNeed> needs;
  for (const std::vector<NeededTile>& tiles : of_leaves)
    for (const NeededTile& tile : tiles) {
      CellNeed& need = needs.try_emplace(tile.id, CellNeed{tile.id, 0, 0}).first->second;
      need.view_share += tile.view_share, need.leaf_share += 1;
    }
  std::vector<CellNeed> listed;
  for (auto& [id, need] : needs) {
    need.view_share /= need.leaf_share, need.leaf_share /= static_cast<float>(of_leaves.size());
    listed.push_back(need);
  }
  return listed;
}

}  // namespace farfield
