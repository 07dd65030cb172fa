// SPDX-License-Identifier: Apache-2.0
// How LeafSets makes room when the store is full. The order is that of leaf_sets.h.
#include "client/store/leaf_sets.h"

#include <unordered_set>

namespace farfield::client {
namespace {

/// The order of giving up, within a set.
enum Rank { kDeltaTile, kOtherTile, kTextureDetail, kAnything };

Rank rank_of(const DecodedTile* tile) { return !tile ? kAnything : tile->id.is_delta() ? kDeltaTile : kOtherTile; }

}  // namespace

bool LeafSets::make_room(const DecodedPayload& payload) {
  const ContentHash item = payload.name.item();
  const std::size_t bytes = payload.memory_bytes;
  if (bytes > store_.budget_bytes()) return false;
  const bool is_needed = is_needed_by_role(item);
  bool has_room = store_.make_room(bytes);
  // What no role needs displaces only what no role needs.
  while (!has_room && is_needed && give_up_one(payload)) has_room = store_.make_room(bytes);
  note_evictions();
  return has_room;
}

bool LeafSets::give_up_one(const DecodedPayload& arriving) {
  if (static_cast<double>(texture_bytes()) > kTextureShare * static_cast<double>(store_.budget_bytes())) {
    if (arriving.name.kind == PayloadKind::kTextureLevel && store_.contains(arriving.name.texture)) return false;
    for (const Tracked& set : {awaited_, fallback_, shown_}) {
      if (give_up_texture_level(set, nullptr)) return true;
    }
  }
  const Tracked coming = shown_ == awaited_ || !awaited_ ? fallback_ : awaited_;
  if (!coming || coming == shown_) return give_up_least(shown_, nullptr, arriving);
  // The awaited set may use half the budget, and always one item; the shown set keeps the rest until the switch.
  const bool is_over_half = resident_bytes(*coming) > store_.budget_bytes() / 2;
  if (!is_over_half || coming->held() == 0) {
    if (give_up_least(shown_, coming, arriving)) return true;
    if (fallback_ != coming && give_up_least(fallback_, coming, arriving)) return true;
  }
  return give_up_least(coming, nullptr, arriving);
}

/// Of what `set` holds and `other` does not need, the first in the order of giving up, unless the arriving one comes
/// before it.
bool LeafSets::give_up_least(const Tracked& set, const Tracked& other, const DecodedPayload& arriving) {
  if (!set) return false;
  const bool is_detail =
      arriving.name.kind == PayloadKind::kTextureLevel && store_.contains(arriving.name.texture);
  bool is_least = false;
  for (const int rank : {kDeltaTile, kOtherTile}) {
    if (give_up_item(set, other, rank, arriving, is_least)) return true;
    if (is_least) return false;
  }
  if (is_detail) return false;
  return give_up_texture_level(set, other) || give_up_item(set, other, kAnything, arriving, is_least);
}

/// The farthest item of that rank. `is_least`: there is none beyond the arriving one.
bool LeafSets::give_up_item(const Tracked& set, const Tracked& other, int rank, const DecodedPayload& arriving,
                            bool& is_least) {
  const ContentHash arriving_item = arriving.name.item();
  const bool may_be_least = !other && (rank == kAnything || rank == rank_of(arriving.tile.get()));
  for (auto item = set->needs().rbegin(); item != set->needs().rend(); ++item) {
    is_least = may_be_least && *item == arriving_item;
    if (is_least) return false;
    if (!store_.contains(*item) || (other && other->is_needed(*item))) continue;
    if (rank != kAnything && rank_of(store_.tile(*item).get()) != rank) continue;
    give_up(*item);
    return true;
  }
  return false;
}

/// The largest one.
bool LeafSets::give_up_texture_level(const Tracked& set, const Tracked& other) {
  if (!set) return false;
  ContentHash largest = 0;
  std::size_t largest_bytes = 0;
  for (const LeafSetChunk& chunk : set->set().chunks) {
    const auto texture = store_.texture(chunk.texture);
    if (!texture || texture->levels.size() < 2 || texture->levels.back().rgba.size() <= largest_bytes) continue;
    if (other && other->is_needed(chunk.texture)) continue;
    largest = chunk.texture;
    largest_bytes = texture->levels.back().rgba.size();
  }
  if (largest_bytes == 0 || !store_.drop_finest_level(largest)) return false;
  ++given_up_;
  if (shown_ && shown_->is_needed(largest)) is_stale_ = true;
  return true;
}

std::size_t LeafSets::texture_bytes() const {
  std::unordered_set<ContentHash> textures;
  for (const Tracked& set : {awaited_, fallback_, shown_}) {
    if (!set) continue;
    for (const LeafSetChunk& chunk : set->set().chunks) {
      if (chunk.texture != 0) textures.insert(chunk.texture);
    }
  }
  std::size_t bytes = 0;
  for (const ContentHash texture : textures) bytes += store_.item_bytes(texture);
  return bytes;
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
