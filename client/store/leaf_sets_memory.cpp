// SPDX-License-Identifier: Apache-2.0
// How LeafSets makes room when the store is full. The order is that of leaf_sets.h.
#include "client/store/leaf_sets.h"

#include <algorithm>

namespace farfield::client {

bool LeafSets::make_room(const DecodedPayload& payload) {
  const ContentHash item = payload.name.item();
  const std::size_t bytes = payload.memory_bytes;
  if (bytes > store_.budget_bytes()) return false;
  const bool is_needed = is_needed_by_role(item);
  bool has_room = store_.make_room(bytes);
  // What no role needs displaces only what no role needs.
  while (!has_room && is_needed && give_up_one(payload.name)) has_room = store_.make_room(bytes);
  note_evictions();
  return has_room;
}

bool LeafSets::give_up_one(const PayloadName& arriving) {
  // A finer level is the first thing to do without, so it displaces nothing.
  if (arriving.kind == PayloadKind::kTextureLevel && store_.contains(arriving.texture)) return false;
  const Tracked coming = shown_ == awaited_ || !awaited_ ? fallback_ : awaited_;
  for (const Tracked& set : {awaited_, fallback_, shown_}) {
    if (give_up_texture_level(set)) return true;
  }
  if (!coming || coming == shown_) return give_up_farthest(shown_, nullptr, arriving);
  // The awaited set may use half the budget, and always one item; the shown set keeps the rest until the switch.
  const bool is_over_half = resident_bytes(*coming) > store_.budget_bytes() / 2;
  if (!is_over_half || coming->held() == 0) {
    if (give_up_farthest(shown_, coming, arriving)) return true;
    if (fallback_ != coming && give_up_farthest(fallback_, coming, arriving)) return true;
  }
  return give_up_farthest(coming, nullptr, arriving);
}

bool LeafSets::give_up_texture_level(const Tracked& set) {
  if (!set) return false;
  // Smaller levels would make room for a few dozen tiles, and blur what stands next to the viewer.
  const std::size_t worthwhile = store_.budget_bytes() / 64;
  ContentHash largest = 0;
  std::size_t largest_bytes = 0;
  for (const LeafSetChunk& chunk : set->set().chunks) {
    const auto texture = store_.texture(chunk.texture);
    if (!texture || texture->levels.size() < 2 || texture->levels.back().rgba.size() <= std::max(worthwhile, largest_bytes)) continue;
    largest = chunk.texture;
    largest_bytes = texture->levels.back().rgba.size();
  }
  if (largest_bytes == 0 || !store_.drop_finest_level(largest)) return false;
  ++given_up_;
  if (shown_ && shown_->is_needed(largest)) is_stale_ = true;
  return true;
}

/// Gives up the farthest item of `set` that is held and that `other` does not need, unless the arriving one is
/// farther still.
bool LeafSets::give_up_farthest(const Tracked& set, const Tracked& other, const PayloadName& arriving) {
  if (!set) return false;
  const ContentHash arriving_item = arriving.item();
  for (auto item = set->needs().rbegin(); item != set->needs().rend(); ++item) {
    if (!other && *item == arriving_item) return false;
    if (!store_.contains(*item) || (other && other->is_needed(*item))) continue;
    give_up(*item);
    return true;
  }
  return false;
}

void LeafSets::give_up(ContentHash item) {
  ++given_up_;
  for (const Tracked& set : sets_) {
    if (is_role(set)) set->mark_abandoned(item);
  }
  if (shown_ && shown_->is_needed(item)) is_stale_ = true;
  store_.erase(item);
}

std::size_t LeafSets::resident_bytes(const TrackedLeafSet& set) const {
  std::size_t bytes = 0;
  for (const ContentHash item : set.needs()) bytes += store_.item_bytes(item);
  return bytes;
}

void LeafSets::note_evictions() {
  for (const PayloadStore::Gone& gone : store_.take_gone()) {
    report_gone(gone.payload, gone.item);
    if (store_.contains(gone.item)) continue;
    for (const Tracked& set : sets_) set->mark_evicted(gone.item);
  }
}

void LeafSets::forget_surplus() {
  for (auto at = sets_.begin(); sets_.size() > kMaxSets && at != sets_.end();) {
    at = is_role(*at) ? at + 1 : sets_.erase(at);
  }
}

}  // namespace farfield::client
