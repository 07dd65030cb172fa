// SPDX-License-Identifier: Apache-2.0
// One leaf set on its way to being complete: what it needs, what is missing, and the view it gives.
#pragma once

#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "client/store/leaf_set.h"
#include "client/store/leaf_view.h"
#include "client/store/payload_store.h"

namespace farfield::client {

/// Not thread-safe. The store is passed to each call that needs it and is not kept.
class TrackedLeafSet {
 public:
  TrackedLeafSet(LeafSet set, const SceneFrame& frame, const PayloadStore& store);

  const LeafSet& set() const { return set_; }
  const Box& box() const { return box_; }
  double side_m() const { return side_m_; }
  /// Lists all that can be seen from `eye` (scene frame).
  bool speaks_for(const glm::dvec3& eye) const { return box_.contains(eye) && set_.enclosure.contains(box_, eye); }
  /// Lists what `other` lists, whenever the server announced it.
  bool is_same_as(const TrackedLeafSet& other) const {
    return set_.leaf == other.set_.leaf && set_.is_fallback == other.set_.is_fallback && set_.enclosure == other.set_.enclosure;
  }
  /// Largest distance of `eye` from the leaf's box along any axis, in sides; 0 inside. What lies behind a wall of the set's
  /// enclosure counts as kBehindWallSides: its near geometry is that of another room.
  double sides_outside(const glm::dvec3& eye) const;

  /// Items (tiles, chunks, textures) it draws, unique, by ascending rank.
  const std::vector<ContentHash>& needs() const { return needs_; }
  bool is_needed(ContentHash item) const { return ranks_.contains(item); }
  /// Complete: nothing is missing, apart from what can never come (bad payloads) or found no room.
  bool is_complete() const { return missing_.empty(); }
  std::size_t missing() const { return missing_.size(); }
  bool is_missing(ContentHash item) const { return missing_.contains(item); }
  std::size_t held() const { return needs_.size() - missing_.size() - abandoned_.size(); }
  /// Something it needs was abandoned.
  bool is_reduced() const { return !abandoned_.empty(); }
  /// How early `item` is wanted: near geometry first, then tiles from the nearest shell outwards. Requires: is_needed(item).
  std::size_t rank(ContentHash item) const { return ranks_.at(item); }
  /// The server has sent everything it will send for this set.
  bool is_all_sent() const { return is_all_sent_; }

  void mark_arrived(ContentHash item);
  void mark_evicted(ContentHash item);
  /// It will not come, or there is no room for it: the set is complete without it.
  void mark_abandoned(ContentHash item);
  /// What was abandoned is missing again: the set has left the screen, and there may be room next time.
  void restore_abandoned();
  void mark_all_sent() { is_all_sent_ = true; }

  /// A snapshot of what is held now. O(needs).
  std::shared_ptr<const LeafView> view(const PayloadStore& store, const SceneFrame& frame) const;

 private:
  const LeafSet set_;
  const Box box_;
  const double side_m_;
  std::vector<ContentHash> needs_;
  std::unordered_map<ContentHash, std::uint32_t> ranks_;
  std::unordered_set<ContentHash> missing_, abandoned_;
  bool is_all_sent_ = false;
};

}  // namespace farfield::client
