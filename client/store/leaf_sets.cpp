// SPDX-License-Identifier: Apache-2.0
// Which leaf set is shown, and the bookkeeping of arrivals. How room is made: leaf_sets_memory.cpp.
#include "client/store/leaf_sets.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace farfield::client {
namespace {

/// What a fallback view is worth: as much as a whole set seen from this many sides outside its leaf. A set's near
/// geometry is exact for kappa sides around its leaf, and from there its shells begin; a fallback view is made for one
/// point, at a quarter of the samples, of everything more than a side away from its cell.
constexpr double kFallbackSides = 1.5;

/// How much nearer another set has to be to take the screen: a walk along a border does not switch to and fro.
constexpr double kSwitchSides = 0.25;

/// How far outside its leaf a fallback view still does, in sides, until that of the next leaf is there.
constexpr double kFallbackReach = 0.25;

double distance_sides(const TrackedLeafSet& set, const glm::dvec3& eye) {
  return set.sides_outside(eye) + (set.set().is_fallback ? kFallbackSides : 0.0);
}

}  // namespace

bool is_late(const LeafView* view, const glm::dvec3& eye) {
  return !view || view->is_fallback || !view->is_complete || !view->speaks_for(eye);
}

void LeafSets::announce(LeafSet set) {
  auto tracked = std::make_shared<TrackedLeafSet>(std::move(set), frame_, store_);
  // A newer list for the same leaf takes the place of the older one, unless that is on the screen.
  std::erase_if(sets_, [&](const Tracked& old) {
    return old != shown_ && old->is_same_as(*tracked);
  });
  sets_.push_back(std::move(tracked));
  assign_roles();
  forget_surplus();
}

void LeafSets::mark_all_sent(std::uint64_t serial) {
  // Serials begin anew with a new session: the newest set of that serial is meant.
  const auto set = std::find_if(sets_.rbegin(), sets_.rend(),
                                [&](const Tracked& candidate) { return candidate->set().serial == serial; });
  if (set != sets_.rend()) (*set)->mark_all_sent();
}

void LeafSets::receive(DecodedPayload payload) {
  const ContentHash item = payload.name.item();
  if (!make_room(payload)) {
    report_gone(payload.name.key, item);
    if (!is_needed_by_role(item)) return;
    ++given_up_;
    // A finer texture level without room changes nothing; an item without room is one its sets do without.
    if (store_.contains(item)) return;
    for (const Tracked& set : sets_) {
      if (is_role(set)) set->mark_abandoned(item);
    }
    return;
  }
  store_.insert(std::move(payload), is_needed_by_role(item));
  for (const Tracked& set : sets_) set->mark_arrived(item);
  if (shown_ && shown_->is_needed(item)) is_stale_ = true;
}

void LeafSets::receive_empty(const PayloadName& name) {
  DecodedPayload nothing;
  nothing.name = name;
  nothing.memory_bytes = sizeof(DecodedPayload);
  receive(std::move(nothing));
}

void LeafSets::abandon(const PayloadName& name) {
  const ContentHash item = name.item();
  report_gone(name.key, item);
  if (store_.contains(item)) return;  // a bad finer level of a texture that can be drawn
  for (const Tracked& set : sets_) {
    if (is_role(set)) set->mark_abandoned(item);
  }
}

void LeafSets::report_gone(ContentHash payload, ContentHash item) {
  if (is_needed_by_role(item)) {
    withheld_[payload] = item;
  } else {
    evicted_.push_back(payload);
  }
}

void LeafSets::forget_reports() {
  evicted_.clear();
  withheld_.clear();
}

bool LeafSets::is_needed_by_role(ContentHash item) const {
  return (shown_ && shown_->is_needed(item)) || (awaited_ && awaited_->is_needed(item)) ||
         (fallback_ && fallback_->is_needed(item));
}

void LeafSets::set_eye(const glm::dvec3& eye) {
  eye_ = eye;
  has_eye_ = true;
}

bool LeafSets::update(bool with_refinement) {
  assign_roles();
  const Tracked chosen = choose();
  if (!chosen) return false;
  const bool is_switch = chosen != shown_;
  // Becoming complete on the screen is news at once; everything else about the shown set can wait a little.
  const bool is_completion = view_ && !is_switch && chosen->is_complete() && !view_->is_complete;
  if (!is_switch && !is_completion && !(is_stale_ && with_refinement)) return false;
  shown_ = chosen;
  if (is_switch) assign_roles();
  is_stale_ = false;
  // A set of which nothing could be kept, by a tiny budget or bad payloads, leaves the last picture on the screen;
  // one that truly holds nothing is shown as that.
  std::shared_ptr<const LeafView> next = shown_->view(store_, frame_);
  if (view_ && shown_->is_reduced() && next->tiles.empty() && next->chunks.empty()) return false;
  view_ = std::move(next);
  return true;
}

LeafSets::Tracked LeafSets::choose() const {
  Tracked nearest;
  double nearest_sides = std::numeric_limits<double>::infinity();
  for (const Tracked& set : sets_) {  // newest last, and the newest of equals wins
    if (!set->is_complete()) continue;
    const bool is_inside = !set->set().is_fallback && set->speaks_for(eye_);
    // What speaks for the eye comes before whatever does not, even if that is shown and no distance away.
    const double sides = (is_inside ? -2 * kSwitchSides : distance_sides(*set, eye_)) - (set == shown_ ? kSwitchSides : 0.0);
    if (sides <= nearest_sides) nearest = set, nearest_sides = sides;
  }
  if (nearest) return nearest;
  if (shown_ && shown_->held() > 0) return shown_;
  // Nothing was ever complete: the fallback view as far as it has come, else the set itself.
  if (fallback_ && fallback_->held() > 0) return fallback_;
  return awaited_ && awaited_->held() > 0 ? awaited_ : nullptr;
}

LeafSets::Tracked LeafSets::find_awaited() const {
  Tracked inside, newest;
  for (const Tracked& set : sets_) {
    if (set->set().is_fallback) continue;
    if (has_eye_ && set->speaks_for(eye_)) inside = set;
    if (set->set().is_current) newest = set;
  }
  return inside ? inside : newest;
}

LeafSets::Tracked LeafSets::find_fallback() const {
  if (has_usable_view() && !(shown_->set().is_fallback)) return nullptr;
  Tracked inside, newest;
  for (const Tracked& set : sets_) {
    if (!set->set().is_fallback) continue;
    if (has_eye_ && set->box().contains(eye_)) inside = set;
    newest = set;
  }
  return inside ? inside : newest;
}

bool LeafSets::has_usable_view() const {
  if (!shown_ || !shown_->is_complete()) return false;
  return shown_->sides_outside(eye_) <= (shown_->set().is_fallback ? kFallbackReach : kFallbackSides);
}

void LeafSets::assign_roles() {
  awaited_ = find_awaited();
  fallback_ = find_fallback();
  const std::array<Tracked, 3> roles{shown_, awaited_, fallback_};
  if (roles == pinning_) return;
  for (const Tracked& former : pinning_) {
    if (former && !is_role(former)) former->restore_abandoned();
  }
  std::erase_if(withheld_, [&](const auto& gone) {
    // For a set that has just become one to draw there may be room: the server has to send it again.
    const bool is_wanted_anew = std::any_of(roles.begin(), roles.end(), [&](const Tracked& role) {
      return role && std::find(pinning_.begin(), pinning_.end(), role) == pinning_.end() && role->is_missing(gone.second);
    });
    if (is_needed_by_role(gone.second) && !is_wanted_anew) return false;
    evicted_.push_back(gone.first);
    return true;
  });
  std::unordered_set<ContentHash> pins;
  for (const Tracked& role : roles) {
    if (role) pins.insert(role->needs().begin(), role->needs().end());
  }
  store_.set_pins(pins);
  pinning_ = roles;
  ++roles_version_;
}

DecodeGroup LeafSets::group_of(const PayloadName& name) const {
  const ContentHash item = name.item();
  const bool is_finer = name.kind == PayloadKind::kTextureLevel && store_.contains(item);
  if (fallback_ && fallback_->is_needed(item)) return is_finer ? DecodeGroup::kRefinement : DecodeGroup::kFallback;
  const bool is_needed = (awaited_ && awaited_->is_needed(item)) || (shown_ && shown_->is_needed(item));
  if (!is_needed) return DecodeGroup::kPrefetch;
  return is_finer ? DecodeGroup::kRefinement : DecodeGroup::kNeeded;
}

bool LeafSets::is_redundant(const PayloadName& name) const {
  if (name.kind == PayloadKind::kTextureLevel) return store_.contains_level(name.texture, name.level);
  return store_.contains(name.key);
}

}  // namespace farfield::client
