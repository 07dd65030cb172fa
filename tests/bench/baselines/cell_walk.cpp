// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/baselines/cell_walk.h"

namespace farfield::bench {

CellWalk::CellWalk(const World& world) : world_(world), settings_(world.options.settings) {
  settings_.display = world.options.display;
  settings_.finest_side_m = finest_side_for(*world.scene, settings_.finest_side_m);
  shells_ = {CellGrid{settings_.finest_side_m}, settings_.kappa};
  sources_ = make_impostor_sources(world.scene, settings_);
  for (std::size_t i = 0; i < world.scene->textures().size(); ++i) texture_index_[world.scene->textures()[i].hash] = i;
}

Result<SharedPlan> CellWalk::plan_for(const glm::dvec3& eye) {
  const Result<CellId> leaf = leaf_at(eye);
  if (!leaf) return tl::unexpected(leaf.error());
  SharedPlan& plan = plans_[*leaf];
  if (!plan) {
    Result<SharedPlan> made = sources_.leaves->plan(*leaf, nullptr);
    if (!made) return tl::unexpected(made.error());
    plan = std::move(*made);
  }
  return plan_at(plan, shells_.grid, eye);
}

void CellWalk::count_near(const LeafPlan& plan, EnteredCell& cell) {
  const Scene& scene = *world_.scene;
  for (const std::uint32_t chunk : plan.chunks) {
    if (!sent_.insert(scene.chunks()[chunk].hash).second) continue;
    cell.near_bytes += scene.encoded_chunk(chunk)->size();
    const auto texture = texture_index_.find(scene.chunk_geometry(chunk).texture);
    if (texture == texture_index_.end() || !sent_.insert(texture->first).second) continue;
    for (int level = 0; level < scene.textures()[texture->second].level_count; ++level)
      cell.texture_bytes += scene.encoded_texture_level(static_cast<std::uint32_t>(texture->second), level)->size();
  }
}

Result<std::vector<EnteredCell>> CellWalk::entered() {
  std::vector<EnteredCell> cells;
  std::map<CellId, std::size_t> seen;
  std::set<const LeafPlan*> counted;
  sent_.clear();
  for (const TraceFrame& frame : world_.trace.frames) {
    const glm::dvec3 eye = world_.scene_from_world(frame.pose).position;
    const Result<SharedPlan> plan = plan_for(eye);
    if (!plan) return tl::unexpected(plan.error());
    const auto [at, is_new] = seen.try_emplace((*plan)->leaf, cells.size());
    if (is_new) cells.push_back({(*plan)->leaf, eye});
    // A leaf that walls divide has a plan for each of its enclosures.
    if (counted.insert(plan->get()).second) count_near(**plan, cells[at->second]);
  }
  return cells;
}

client::PlacedChunk CellWalk::placed_chunk(std::uint32_t chunk, const glm::dvec3& centre) {
  const Scene& scene = *world_.scene;
  std::shared_ptr<const client::DecodedChunk>& decoded = chunks_[chunk];
  if (!decoded) decoded = std::make_shared<client::DecodedChunk>(client::DecodedChunk{scene.chunks()[chunk].hash, chunk + 1, scene.chunk_geometry(chunk)});
  client::PlacedChunk placed{decoded, nullptr, glm::mat4x3(1)};
  glm::dmat4x3 cell_from_chunk = scene.chunks()[chunk].scene_from_chunk;
  cell_from_chunk[3] -= centre;
  placed.cell_from_chunk = glm::mat4x3(cell_from_chunk);
  const auto index = texture_index_.find(decoded->chunk.texture);
  if (index == texture_index_.end()) return placed;
  std::shared_ptr<const client::DecodedTexture>& texture = textures_[index->first];
  if (!texture) {
    auto made = std::make_shared<client::DecodedTexture>();
    made->hash = index->first, made->serial = index->second + 1;
    for (int level = scene.textures()[index->second].level_count - 1; level >= 0; --level)
      made->levels.push_back(scene.texture_level(static_cast<std::uint32_t>(index->second), level));
    texture = std::move(made);
  }
  placed.texture = texture;
  return placed;
}

Result<std::shared_ptr<const client::LeafView>> CellWalk::near_view(const glm::dvec3& eye) {
  const Result<SharedPlan> plan = plan_for(eye);
  if (!plan) return tl::unexpected(plan.error());
  if (shown_ && shown_plan_ == *plan) return shown_;
  auto view = std::make_shared<client::LeafView>();
  view->leaf = (*plan)->leaf;
  view->leaf_box = shells_.grid.box(view->leaf);
  view->enclosure = (*plan)->enclosure;
  view->near_region = shells_.near_region(view->leaf);
  view->is_complete = true;
  view->background_visible = (*plan)->background_visible;
  view->sky = (*plan)->sky;
  view->background = world_.scene->background();
  for (const std::uint32_t chunk : (*plan)->chunks) view->chunks.push_back(placed_chunk(chunk, view->leaf_box.center()));
  shown_plan_ = *plan, shown_ = view;
  return shown_;
}

}  // namespace farfield::bench
