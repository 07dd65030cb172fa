// SPDX-License-Identifier: Apache-2.0
#include "server/impostor/leaf_planner.h"

#include <algorithm>
#include <map>
#include <set>

#include "common/base/thread_clock.h"
#include "common/cells/sampling.h"
#include "server/impostor/held_points.h"

namespace farfield {
namespace {

// The tile or region of a view that a direction falls into.
TileId tile_towards(const CellId& cell, int view, const glm::dvec3& direction, const ImpostorSettings& settings) {
  const int edge_samples = settings.edge_samples(static_cast<std::uint8_t>(view));
  const int face = dominant_face(direction);
  const CubeFace frame = CubeFace::of(face);
  const double scale = 1.0 / std::abs(direction[frame.axis]);
  const double i = sample_index(edge_samples, direction[frame.u_axis()] * scale);
  const double j = sample_index(edge_samples, direction[frame.v_axis()] * scale);
  TileId id{cell, static_cast<std::uint8_t>(view), static_cast<std::uint8_t>(face), 0, 0};
  const int step = id.is_delta() ? kRegionSamples : kTileStride;
  const int count = id.is_delta() ? face_regions(edge_samples) : face_tiles(edge_samples);
  const auto place = [&](double index) { return static_cast<std::uint8_t>(std::clamp(static_cast<int>(index) / step, 0, count - 1)); };
  id.x = place(i), id.y = place(j);
  return id;
}

// The tiles and regions of a shell's first `views` views.
std::uint64_t tiles_of(const ImpostorSettings& settings, std::size_t views) {
  const auto square = [](int edge) { return static_cast<std::uint64_t>(kCubeFaces) * edge * edge; };
  const std::uint64_t delta = square(face_regions(settings.edge_samples(1)));
  return square(face_tiles(settings.edge_samples(kIntraView))) + (views - 1) * delta;
}

// Tiles of which less is seen than this, as a share of the sphere, are not worth their bytes: a delta tile takes about half
// those of an intra tile, and there are many more that are hardly seen.
constexpr double kLeastIntraShare = 2e-6, kLeastDeltaShare = 4e-7;

// What one shell contributes: tiles seen, with the solid angle they cover (summed over viewpoints), by the enclosure
// of who sees them.
class ShellNeeds {
 public:
  ShellNeeds(const Scene& scene, CellSpace space, std::shared_ptr<const ShellViews> views, const ImpostorSettings& settings,
             const BoxVisibility& sight)
      : scene_(scene), space_(space), views_(std::move(views)), settings_(settings), viewpoints_{sight.viewpoints}, seen_(sight.enclosures.size() + 1) {
    for (const EnclosureVisibility& enclosed : sight.enclosures) {
      viewpoints_.push_back(enclosed.viewpoints);
      viewpoints_[0] -= enclosed.viewpoints;
    }
    slack_ = disparity_tolerance(glm::dvec3(0), settings.kappa, settings.tau_px, settings.display) * (0.5 + settings.kappa);
  }

  void add(const FarHit& hit) {
    waiting_.push_back(hit);
  }
  /// Once, when all hits are added.
  void ask_delta_views() {
    // Of each point the first view that holds it.
    for (std::size_t view = 0; view < views_->positions.size() && !waiting_.empty(); ++view)
      drop_held(scene_, space_, slack_, PointSpacing::kSparse, views_->positions[view], waiting_, [&](const FarHit& hit) {
        mark(static_cast<int>(view), hit);
      });
    waiting_.clear();
  }
  int delta_views() const { return static_cast<int>(views_->positions.size()) - 1; }
  /// What the whole leaf needs none of.
  void count_skips(LeafSkips& skips) const {
    std::set<TileId> seen;
    for (const auto& of_enclosure : seen_)
      for (const auto& [id, solid_angle] : of_enclosure) seen.insert(id);
    skips.tiles_unseen += tiles_of(settings_, views_->positions.size()) - seen.size();
    for (const TileId& id : seen) skips.tiles_too_small += !is_worth_sending(id);
  }
  /// What the viewpoints of one enclosure need, or (kWhole) all of them together.
  static constexpr int kWhole = -1;
  void list(int enclosure, std::vector<NeededTile>& tiles) const {
    std::map<TileId, double> seen;
    std::size_t viewpoints = 0;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      if (enclosure != kWhole && static_cast<std::size_t>(enclosure) + 1 != k) continue;
      viewpoints += viewpoints_[k];
      for (const auto& [id, solid_angle] : seen_[k])
        if (is_worth_sending(id)) seen[id] += solid_angle;
    }
    const double spheres = kSphere * static_cast<double>(std::max<std::size_t>(1, viewpoints));
    std::vector<NeededTile> mine;
    for (const auto& [id, solid_angle] : seen) mine.push_back({id, static_cast<float>(solid_angle / spheres)});
    std::stable_sort(mine.begin(), mine.end(), [](const NeededTile& a, const NeededTile& b) {
      if (a.id.is_delta() != b.id.is_delta()) return b.id.is_delta();
      return a.view_share > b.view_share;
    });
    tiles.insert(tiles.end(), mine.begin(), mine.end());
  }

 private:
  static constexpr double kSphere = 4 * 3.14159265358979323846;

  // Somebody sees enough of it: viewers in one of the enclosures, or in none.
  bool is_worth_sending(const TileId& id) const {
    const double least = kSphere * (id.is_delta() ? kLeastDeltaShare : kLeastIntraShare);
    for (std::size_t k = 0; k < seen_.size(); ++k)
      if (const auto found = seen_[k].find(id); found != seen_[k].end() && found->second >= least * static_cast<double>(viewpoints_[k])) return true;
    return false;
  }
  // The probe sends some hundred rays into each tile from each of its viewpoints: what none of them met is too small to
  // be worth a tile.
  void mark(int view, const FarHit& hit) {
    const glm::dvec3 direction = glm::dvec3(hit.point) - views_->positions[view];
    seen_[static_cast<std::size_t>(hit.enclosure + 1)][tile_towards(space_.cell, view, direction, settings_)] += hit.solid_angle;
  }

  const Scene& scene_;
  const CellSpace space_;
  const std::shared_ptr<const ShellViews> views_;
  const ImpostorSettings& settings_;
  double slack_;
  std::vector<FarHit> waiting_;
  // Of viewpoints in no enclosure first, then by enclosure.
  std::vector<std::size_t> viewpoints_;
  std::vector<std::map<TileId, double>> seen_;
};

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
                         std::shared_ptr<ViewCatalogue> catalogue, const NestedShells& shells, const ImpostorSettings& settings)
    : scene_(std::move(scene)), tree_(std::move(tree)), catalogue_(std::move(catalogue)), shells_(shells), settings_(settings) {}

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
  return {skipped_, catalogue_->delta_views_unneeded()};
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
      const auto views = catalogue_->views(cell, cancel);
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
