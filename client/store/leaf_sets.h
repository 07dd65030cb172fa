// SPDX-License-Identifier: Apache-2.0
// All leaf sets a client knows, what it holds of them, and which one is on the screen.
//
// A set is shown only as a whole: until the set of the eye's leaf is complete, an older one stays (design.md
// section 2). Of the complete sets the one whose leaf is nearest to the eye is shown, whichever leaf the eye has been
// in meanwhile: distance is counted in sides of the set's leaf, a fallback view counts as kFallbackSides farther than
// it is, and the set on the screen stays unless another is nearer by kSwitchSides. While nothing has ever been
// complete, whatever has arrived is shown. Once something is shown there is always something.
//
// Memory: what the shown and the awaited set need is pinned. If these alone exceed the budget, room is made in this
// order: finest texture levels while textures take more than kTextureShare of the budget; then, of whichever of the two
// holds more than its half, delta tiles from the outermost shell inwards, the other tiles likewise, finest texture
// levels, chunks and whatever is left. What is near and large on the screen stays: a texture's coarsest level goes last,
// and nothing displaces what comes after it in this order. A set is complete without what it gave up, so there is
// always progress.
//
// The server sends again at once what it is told has gone and the current set needs. So what a pinned set gave up is
// withheld from the server until no pinned set needs it, or another set comes to be pinned that does: otherwise it
// would come for ever.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "client/decode/decode_pool.h"
#include "client/store/leaf_set.h"
#include "client/store/leaf_view.h"
#include "client/store/payload_store.h"
#include "client/store/tracked_leaf_set.h"

namespace farfield::client {

/// The shown view is not the complete leaf set of the leaf that holds `eye` (scene frame): design.md section 9.
bool is_late(const LeafView* view, const glm::dvec3& eye);

/// Not thread-safe: belongs to the client core's network thread.
class LeafSets {
 public:
  /// Sets known at once; beyond it the oldest that are neither shown nor awaited are forgotten. A server counts on
  /// the last eight it has announced.
  static constexpr std::size_t kMaxSets = 32;

  /// Textures up to this share of the budget are worth more than the farthest tiles.
  static constexpr double kTextureShare = 0.25;

  LeafSets(const SceneFrame& frame, std::size_t budget_bytes) : frame_(frame), store_(budget_bytes) {}

  // ── what happens ──
  void announce(LeafSet set);
  void mark_all_sent(std::uint64_t serial);
  void receive(DecodedPayload payload);
  /// A tile that turned out to hold nothing.
  void receive_empty(const PayloadName& name);
  /// A payload that cannot be decoded: sets become complete without it.
  void abandon(const PayloadName& name);
  void set_eye(const glm::dvec3& eye);
  /// The server is about to be told afresh what is held (Hello).
  void forget_reports();

  /// Chooses what to show. `with_refinement`: also when only a detail of the shown set has changed, or the set on
  /// the screen is not complete yet; callers limit how often. Returns: whether view() is a new one.
  bool update(bool with_refinement);

  // ── questions ──
  const std::shared_ptr<const LeafView>& view() const { return view_; }
  /// Null: nothing. What view() was made from, now possibly further along.
  const TrackedLeafSet* shown() const { return shown_.get(); }
  /// Something usable is on the screen: a complete set or fallback view, and the eye not too far outside its leaf.
  bool has_usable_view() const;
  bool needs_refinement() const { return is_stale_; }
  /// Changes whenever group_of() may answer differently for payloads that wait.
  std::uint64_t roles_version() const { return roles_version_; }
  DecodeGroup group_of(const PayloadName& name) const;
  /// Held already, or known to be of no use: need not be decoded again.
  bool is_redundant(const PayloadName& name) const;
  const PayloadStore& store() const { return store_; }
  /// Payload keys that have gone, for the server, since the last call.
  std::vector<ContentHash> take_evicted() { return std::exchange(evicted_, {}); }
  std::size_t given_up() const { return given_up_; }

 private:
  using Tracked = std::shared_ptr<TrackedLeafSet>;

  Tracked choose() const;
  Tracked find_awaited() const;
  Tracked find_fallback() const;
  void assign_roles();
  bool is_role(const Tracked& set) const { return set && (set == shown_ || set == awaited_ || set == fallback_); }
  bool make_room(const DecodedPayload& payload);
  bool give_up_one(const DecodedPayload& arriving);
  bool give_up_texture_level(const Tracked& set, const Tracked& other);
  bool give_up_least(const Tracked& set, const Tracked& other, const DecodedPayload& arriving);
  bool give_up_item(const Tracked& set, const Tracked& other, int rank, const DecodedPayload& arriving, bool& is_least);
  std::size_t texture_bytes() const;
  std::size_t resident_bytes(const TrackedLeafSet& set) const;
  void give_up(ContentHash item);
  bool is_needed_by_role(ContentHash item) const;
  void note_evictions();
  void report_gone(ContentHash payload, ContentHash item);
  void forget_surplus();

  const SceneFrame frame_;
  PayloadStore store_;
  glm::dvec3 eye_{0};
  bool has_eye_ = false;
  std::vector<Tracked> sets_;                // by ascending age of announcement, newest last
  Tracked shown_, awaited_, fallback_;       // the roles that pin
  std::array<Tracked, 3> pinning_;           // the roles by which the store's pins were last set
  std::uint64_t roles_version_ = 0;
  std::vector<ContentHash> evicted_;         // payload keys to report
  std::unordered_map<ContentHash, ContentHash> withheld_;  // payload key to item
  std::shared_ptr<const LeafView> view_;
  bool is_stale_ = false;                    // the shown set has changed since view_ was made
  std::size_t given_up_ = 0;
};

}  // namespace farfield::client
