// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/leaf_planner.h"

#include <algorithm>

#include "common/base/thread_clock.h"
#include "server/impostor/shell_needs.h"

namespace farfield {
namespace {

std::vector<NeededTile> fallback_tiles(const CellId& cell, const ImpostorSettings& settings) {
  std::vector<NeededTile> tiles;
  const int count = std::max(1, settings.face_tiles / 4);
  const float share = 1.0f / static_cast<float>(kCubeFaces * count * count);
  for (int face = 0; face < kCubeFaces; ++face)
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x)
        tiles.push_back({{cell, kFallbackView, static_cast<std::uint8_t>(face), static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)}, share});
  return tiles;
}

}  // namespace

LeafPlanner::LeafPlanner(std::shared_ptr<const Scene> scene, std::shared_ptr<CellTree> tree,
                         std::shared_ptr<ViewSource> views, const NestedShells& shells, const ImpostorSettings& settings)
    : scene_(std::move(scene)), tree_(std::move(tree)), views_(std::move(views)), shells_(shells), settings_(settings) {}

Result<CellId> LeafPlanner::leaf_at(const glm::dvec3& viewpoint, const CancelFlag& cancel) {
  return tree_->leaf_at(viewpoint, cancel);
}

Result<bool> LeafPlanner::can_stand_in(const CellId& leaf, const CancelFlag& cancel) { return tree_->can_stand_in(leaf, cancel); }

void LeafPlanner::sort_chunks(LeafPlan& plan) const {
  const glm::dvec3 center = shells_.grid.box(plan.leaf).center();
  const auto distance = [&](std::uint32_t chunk) {
    const Box& b = scene_->chunks()[chunk].bounds;
    return glm::distance(center, glm::clamp(center, b.min, b.max));
  };
  std::sort(plan.chunks.begin(), plan.chunks.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double da = distance(a), db = distance(b);
    return da < db || (!(db < da) && a < b);
  });
}

void LeafPlanner::list_near(LeafPlan& plan, const Sight& sight) const {
  plan.chunks = sight.near_chunks;
  sort_chunks(plan);
  plan.near_triangles = static_cast<std::uint32_t>(sight.near_triangles);
  plan.exceeds_budget = sight.near_triangles > settings_.near_triangles;
  plan.background_visible = sight.escapes;
  plan.sky = sight.sky;
}

void LeafPlanner::count_unseen_chunks(LeafPlan& plan) const {
  std::vector<std::uint32_t> listed = plan.chunks;
  std::sort(listed.begin(), listed.end());
  const Box cell = shells_.grid.box(plan.leaf);
  for (const std::uint32_t chunk : scene_->chunks_in(shells_.near_region(plan.leaf))) {
    if (std::binary_search(listed.begin(), listed.end(), chunk)) continue;
    const SceneChunk& skipped = scene_->chunks()[chunk];
    ++(faces_away(skipped, cell) ? plan.skips.chunks_facing_away : plan.skips.chunks_unseen);
    plan.skips.triangles_unseen += skipped.triangles;
  }
}

PlanSkips LeafPlanner::skips() const {
  const std::lock_guard lock(mutex_);
  return {skipped_, views_->delta_views_unneeded()};
}

std::shared_ptr<const LeafPlan> LeafPlanner::fallback(const glm::dvec3& viewpoint) {
  const double start = thread_seconds();
  auto plan = std::make_shared<LeafPlan>();
  plan->leaf = plan->root = tree_->fallback_cell(viewpoint);
  plan->is_fallback = true;
  plan->tiles = fallback_tiles(plan->leaf, settings_);
  const Box box = shells_.grid.box(plan->leaf);
  plan->chunks = scene_->chunks_in(shells_.fallback_region(plan->leaf));
  sort_chunks(*plan);
  for (const std::uint32_t chunk : plan->chunks) plan->near_triangles += scene_->chunks()[chunk].triangles;
  plan->exceeds_budget = plan->near_triangles > settings_.near_triangles;
  // Where the sky may fill what the view does not hold: one ray for each of the mask's squares.
  cast_sphere(*scene_, glm::clamp(viewpoint, box.min, box.max), DirectionMask::kEdge, {0.5, 0.5}, {},
              [&](const RayPacket& rays, const HitPacket& hits, const double*) {
                for (int lane = 0; lane < kPacketSize; ++lane)
                  if (hits.part[lane] == kNoHit) plan->sky.insert({rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]});
              });
  plan->background_visible = true;
  plan->seconds = thread_seconds() - start;
  return plan;
}

Result<std::shared_ptr<const LeafPlan>> LeafPlanner::plan(const CellId& leaf, const CancelFlag& cancel) {
  const double start = thread_seconds();
  const auto visibility = tree_->visibility(leaf, cancel);
  if (!visibility) return tl::unexpected(visibility.error());
  const BoxVisibility& seen = **visibility;

  auto plan = std::make_shared<LeafPlan>();
  plan->leaf = leaf;
  plan->root = tree_->scene_root().level > leaf.level ? tree_->scene_root() : leaf;
  if (!leaf.is_within(plan->root)) plan->root = leaf.ancestor(std::max<int>(plan->root.level, leaf.level));
  // A leaf beside the scene's root: climb until one ancestor's near region holds the scene.
  while (plan->root.level < kMaxCellLevel && !shells_.near_region(plan->root).contains(scene_->bounds())) plan->root = plan->root.parent();
  list_near(*plan, seen);
  count_unseen_chunks(*plan);
  plan->skips.blocked_cells = seen.is_blocked;

  std::vector<std::unique_ptr<ShellNeeds>> shells(plan->root.level + 1);
  for (const FarHit& hit : seen.far_hits) {
    const int level = shells_.shell_at(leaf, plan->root, glm::dvec3(hit.point));
    if (level == NestedShells::kNear) continue;  // a chunk that reaches across the border
    if (!shells[level]) {
      const CellId cell = leaf.ancestor(level);
      const auto views = views_->views(cell, cancel);
      if (!views) return tl::unexpected(views.error());
      shells[level] = std::make_unique<ShellNeeds>(*scene_, CellSpace::of_shell(shells_, cell, plan->root), *views, settings_, seen);
    }
    shells[level]->add(hit);
  }
  for (std::size_t level = leaf.level; level < shells.size(); ++level) {
    ShellNeeds* const shell = shells[level].get();
    if (!shell) {
      plan->skips.tiles_unseen += tiles_of(settings_, 1);
      continue;
    }
    shell->ask_delta_views();
    shell->list(ShellNeeds::kWhole, plan->tiles);
    shell->count_skips(plan->skips);
    if (level == leaf.level) plan->delta_views = shell->delta_views();
  }
  for (std::size_t e = 0; e < seen.enclosures.size(); ++e) {
    const EnclosureVisibility& here = seen.enclosures[e];
    auto part = std::make_shared<LeafPlan>();
    part->leaf = leaf;
    part->root = plan->root;
    part->enclosure = here.mask;
    list_near(*part, here);
    for (const auto& shell : shells)
      if (shell) shell->list(static_cast<int>(e), part->tiles);
    plan->enclosures.push_back(std::move(part));
  }
  if (is_cancelled(cancel)) return fail(ErrorCode::kCancelled, "cancelled");
  plan->seconds = thread_seconds() - start;
  const std::lock_guard lock(mutex_);
  skipped_ += plan->skips;
  return std::shared_ptr<const LeafPlan>(plan);
}

}  // namespace farfield
