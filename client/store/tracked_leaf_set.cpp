// SPDX-License-Identifier: Apache-2.0
#include "client/store/tracked_leaf_set.h"

#include <algorithm>
#include <utility>

#include "common/cells/nested_shells.h"

namespace farfield::client {
namespace {

constexpr double kBehindWallSides = 2.0;

}  // namespace

TrackedLeafSet::TrackedLeafSet(LeafSet set, const SceneFrame& frame, const PayloadStore& store)
    : set_(std::move(set)),
      box_(frame.grid.box(set_.leaf)),
      side_m_(frame.grid.side_m(set_.leaf.level)) {
  const auto need = [&](ContentHash item) {
    if (!ranks_.try_emplace(item, static_cast<std::uint32_t>(needs_.size())).second) return;
    needs_.push_back(item);
    if (!store.contains(item)) missing_.insert(item);
  };
  for (const LeafSetChunk& chunk : set_.chunks) {
    need(chunk.chunk);
    if (chunk.texture != 0) need(chunk.texture);
  }
  for (const ContentHash tile : set_.tiles) need(tile);
}

double TrackedLeafSet::sides_outside(const glm::dvec3& eye) const {
  const glm::dvec3 beyond = glm::max(box_.min - eye, eye - box_.max);
  const double sides = std::max({beyond.x, beyond.y, beyond.z, 0.0}) / side_m_;
  return set_.enclosure.is_near(box_, eye) ? sides : std::max(sides, kBehindWallSides);
}

void TrackedLeafSet::mark_arrived(ContentHash item) {
  missing_.erase(item);
  abandoned_.erase(item);
}

void TrackedLeafSet::mark_evicted(ContentHash item) {
  if (is_needed(item) && !abandoned_.contains(item)) missing_.insert(item);
}

void TrackedLeafSet::mark_abandoned(ContentHash item) {
  if (!is_needed(item)) return;
  missing_.erase(item);
  abandoned_.insert(item);
}

void TrackedLeafSet::restore_abandoned() { missing_.merge(std::exchange(abandoned_, {})); }

std::shared_ptr<const LeafView> TrackedLeafSet::view(const PayloadStore& store, const SceneFrame& frame) const {
  auto view = std::make_shared<LeafView>();
  view->leaf = set_.leaf;
  view->leaf_box = box_;
  view->enclosure = set_.enclosure;
  view->near_region = box_.grown((set_.is_fallback ? NestedShells::kFallbackKappa : frame.kappa) * side_m_);
  view->is_fallback = set_.is_fallback;
  view->is_complete = is_complete();
  view->background_visible = set_.background_visible;
  view->sky = set_.sky;
  view->background = frame.background;
  view->tiles.reserve(set_.tiles.size());
  for (const ContentHash key : set_.tiles) {
    if (std::shared_ptr<const DecodedTile> tile = store.tile(key)) view->tiles.push_back(std::move(tile));
  }
  view->chunks.reserve(set_.chunks.size());
  for (const LeafSetChunk& placed : set_.chunks) {
    if (std::shared_ptr<const DecodedChunk> chunk = store.chunk(placed.chunk)) {
      view->chunks.push_back({std::move(chunk), store.texture(placed.texture), placed.cell_from_chunk});
    }
  }
  return view;
}

}  // namespace farfield::client
