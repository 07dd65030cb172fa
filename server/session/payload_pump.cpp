// SPDX-License-Identifier: Apache-2.0
// What the viewer does, and which leaf sets follow from it. How payloads flow: payload_flow.cpp.
#include "server/session/payload_pump.h"

#include <algorithm>
#include <utility>

#include "server/session/session_messages.h"

namespace farfield {

PayloadPump::PayloadPump(Parts parts, std::uint64_t first_serial)
    : parts_(std::move(parts)), held_(parts_.limits.held_remembered), next_serial_(first_serial) {}

LeafStream* PayloadPump::find_stream(std::uint64_t serial) {
  const auto found = std::find_if(streams_.begin(), streams_.end(), [&](const auto& s) { return s->serial == serial; });
  return found == streams_.end() ? nullptr : found->get();
}

const LeafStream* PayloadPump::find_stream(LeafStream::Role role) const {
  const auto found = std::find_if(streams_.begin(), streams_.end(), [&](const auto& s) { return s->role == role; });
  return found == streams_.end() ? nullptr : found->get();
}

PayloadPump::Announced* PayloadPump::find_announced(const LeafPlan& plan) {
  const auto found =
      std::find_if(announced_.begin(), announced_.end(), [&](const Announced& a) { return a.plan->is_same_as(plan); });
  return found == announced_.end() ? nullptr : &*found;
}

std::shared_ptr<const LeafPlan> PayloadPump::announced_at(const glm::dvec3& viewpoint) const {
  const CellGrid grid{parts_.service->scene().settings.finest_side_m};
  for (const Announced& announced : announced_) {
    if (announced.plan->speaks_for(grid, viewpoint)) return announced.plan;
  }
  return nullptr;
}

bool PayloadPump::knows_ahead(const glm::dvec3& viewpoint) const {
  const CellGrid grid{parts_.service->scene().settings.finest_side_m};
  std::size_t prefetched = 0;
  for (const auto& stream : streams_) {
    if (!stream->is_prefetch()) continue;
    if (++prefetched >= parts_.limits.prefetched_leaves || stream->plan->speaks_for(grid, viewpoint)) return true;
  }
  return false;
}

bool PayloadPump::is_current_complete() const {
  const LeafStream* stream = find_stream(LeafStream::Role::kCurrent);
  return stream && stream->is_complete;
}

const LeafPlan* PayloadPump::fallback() const {
  const LeafStream* stream = find_stream(LeafStream::Role::kFallback);
  return stream ? stream->plan.get() : nullptr;
}

void PayloadPump::announce(LeafStream& stream) {
  const LeafSetHead head{stream.serial, !stream.is_prefetch()};
  parts_.connection->send(leaf_set_message(head, *parts_.service, *stream.plan));
  stream.is_announced = true;
  ++parts_.metrics.leaf_sets;
  if (stream.is_prefetch()) ++parts_.metrics.leaf_sets_prefetched;
  if (stream.is_fallback()) {
    ++parts_.metrics.leaf_sets_fallback;
    return;
  }
  const LeafStream::HeldCount held = stream.held_already(held_);
  parts_.metrics.payloads_held += held.payloads, parts_.metrics.tiles_held += held.tiles;
  parts_.metrics.payload_bytes_held += held.bytes;
  announced_.push_back({stream.serial, stream.plan, false});
  if (announced_.size() > kManifestsKept) announced_.pop_front();
}

bool PayloadPump::has_spare_capacity() const {
  const auto is_done = [](const auto& stream) { return stream->is_prefetch() || stream->is_complete; };
  return current_ && !is_awaited_ && pending_.size() == pending_prefetch_ && std::all_of(streams_.begin(), streams_.end(), is_done);
}

// Of the streams of leaves now left, keeps the one that is nearest to complete, if it is worth finishing.
void PayloadPump::leave_current(const LeafStream& next) {
  // Farther away than one of its sides a set is of no use any more.
  const CellGrid grid{parts_.service->scene().settings.finest_side_m};
  const Box next_box = grid.box(next.plan->leaf);
  const LeafStream* best = nullptr;
  std::size_t best_missing = missing(next) / 2;
  for (const auto& stream : streams_) {
    if (stream->role != LeafStream::Role::kCurrent && stream->role != LeafStream::Role::kLeft) continue;
    if (stream->is_complete || stream->plan->is_same_as(*next.plan)) continue;
    const Box reach = grid.box(stream->plan->leaf).grown(grid.side_m(stream->plan->leaf.level));
    if (!reach.intersects(next_box) || missing(*stream) > best_missing) continue;
    best = stream.get();
    best_missing = missing(*stream);
  }
  for (std::size_t i = streams_.size(); i-- > 0;) {
    LeafStream& stream = *streams_[i];
    if (&stream == best) {
      stream.role = LeafStream::Role::kLeft;
    } else if (!stream.is_fallback() && (!stream.is_prefetch() || stream.plan->is_same_as(*next.plan))) {
      drop_stream(i);
    }
  }
}

void PayloadPump::enter(std::shared_ptr<const LeafPlan> plan) {
  if (is_stopped_ || (current_ && current_->is_same_as(*plan))) return;
  current_ = std::move(plan);
  withdraw_queued(Lane::kPayload);
  withdraw_queued(Lane::kPrefetch);

  const Announced* before = find_announced(*current_);
  auto stream = std::make_unique<LeafStream>(*parts_.service, before ? before->serial : next_serial_++, current_,
                                             LeafStream::Role::kCurrent, 0.0);
  leave_current(*stream);
  std::unordered_set<ContentHash> needed;
  const auto need = [&](const LeafStream& kept) {
    for (const PayloadItem& item : kept.items()) needed.insert(item.key);
  };
  need(*stream);
  for (const auto& kept : streams_) {
    if (!kept->is_prefetch()) need(*kept);
  }
  drop_requests([&](ContentHash key, const Pending&) { return !needed.contains(key); });
  failed_.clear();
  if (before) {
    stream->is_announced = true;
    stream->is_complete = before->is_complete && stream->is_all_sent(held_);
    ++parts_.metrics.leaf_sets_reused;
  } else {
    announce(*stream);
  }
  const auto place = std::find_if(streams_.begin(), streams_.end(), [](const auto& other) { return other->is_prefetch(); });
  streams_.insert(place, std::move(stream));
  pump();
}

void PayloadPump::show_fallback(std::shared_ptr<const LeafPlan> fallback) {
  if (is_stopped_) return;
  if (const LeafStream* before = find_stream(LeafStream::Role::kFallback)) {
    const bool is_nearly_there = !before->is_complete && 2 * missing(*before) < before->items().size();
    if (before->plan->leaf == fallback->leaf || is_nearly_there) return;
    const std::uint64_t serial = before->serial;
    std::erase_if(streams_, [&](const auto& stream) { return stream.get() == before; });
    drop_requests([&](ContentHash, const Pending& p) { return p.stream == serial; });
  }
  auto stream = std::make_unique<LeafStream>(*parts_.service, next_serial_++, std::move(fallback),
                                             LeafStream::Role::kFallback, -kFallbackOverdue_s);
  announce(*stream);
  streams_.insert(streams_.begin(), std::move(stream));
  pump();
}

void PayloadPump::prefetch(std::shared_ptr<const LeafPlan> plan, double seconds_until_needed) {
  if (is_stopped_ || (current_ && current_->is_same_as(*plan))) return;
  std::size_t prefetched = 0;
  for (const auto& stream : streams_) {
    if (!stream->is_prefetch()) continue;
    if (stream->plan->is_same_as(*plan) || ++prefetched >= parts_.limits.prefetched_leaves) return;
  }
  const Announced* before = find_announced(*plan);
  auto stream = std::make_unique<LeafStream>(*parts_.service, before ? before->serial : next_serial_++, std::move(plan),
                                             LeafStream::Role::kPrefetch, seconds_until_needed);
  stream->is_announced = before != nullptr;
  stream->is_complete = before && before->is_complete && stream->is_all_sent(held_);
  const auto place = std::find_if(streams_.begin(), streams_.end(), [&](const auto& other) {
    return other->is_prefetch() && other->seconds_until_needed > seconds_until_needed;
  });
  streams_.insert(place, std::move(stream));
  pump();
}

void PayloadPump::keep_prefetch(const std::function<bool(const CellId&)>& is_ahead, bool is_new_way) {
  std::unordered_set<std::uint64_t> dropped;
  for (std::size_t i = streams_.size(); i-- > 0;) {
    const LeafStream& stream = *streams_[i];
    if (!stream.is_prefetch() || !(is_new_way || stream.is_complete) || is_ahead(stream.plan->leaf)) continue;
    if (!stream.is_complete) dropped.insert(stream.serial);
    drop_stream(i);
  }
  if (dropped.empty()) return;
  drop_requests([&](ContentHash, const Pending& p) { return p.is_prefetch && dropped.contains(p.stream); });
  withdraw_queued(Lane::kPrefetch);
  pump();
}

void PayloadPump::note_awaiting(bool is_awaiting) {
  if (std::exchange(is_awaited_, is_awaiting) && !is_awaiting) pump();
}

void PayloadPump::note_evicted(const std::vector<ContentHash>& keys) {
  std::unordered_set<ContentHash> lost;
  for (const ContentHash key : keys) {
    if (held_.erase(key)) lost.insert(key);
  }
  if (lost.empty()) return;
  for (std::size_t i = streams_.size(); i-- > 0;) {
    if (!streams_[i]->lose(lost)) continue;
    streams_[i]->is_complete = false;
    // A client that makes room by dropping what was sent ahead of need wants less of it, not the same again.
    if (streams_[i]->is_prefetch()) drop_stream(i);
  }
  pump();
}

void PayloadPump::withdraw_queued(Lane lane) {
  for (const std::uint64_t tag : parts_.connection->discard(lane)) {
    // A tag is the key of a payload, or the serial of the leaf set whose end was announced.
    if (LeafStream* stream = find_stream(tag)) {
      stream->is_complete = false;
    } else if (held_.erase(tag)) {
      ++parts_.metrics.payloads_stale;
    }
    for (Announced& announced : announced_) {
      if (announced.serial == tag) announced.is_complete = false;
    }
  }
  for (const auto& stream : streams_) stream->rewind();
}

void PayloadPump::drop_requests(const std::function<bool(ContentHash, const Pending&)>& is_stale) {
  for (auto entry = pending_.begin(); entry != pending_.end();) {
    if (!is_stale(entry->first, entry->second)) {
      ++entry;
      continue;
    }
    pending_prefetch_ -= entry->second.is_prefetch ? 1 : 0;
    ++parts_.metrics.payloads_stale;
    entry = pending_.erase(entry);
  }
  std::erase_if(arrived_, [&](ContentHash key) { return !pending_.contains(key); });
  for (const auto& stream : streams_) stream->rewind();
}

void PayloadPump::drop_stream(std::size_t index) {
  LeafStream& stream = *streams_[index];
  if (stream.is_prefetch()) parts_.planner.remove_outstanding(stream.prefetched_bytes);
  streams_.erase(streams_.begin() + static_cast<std::ptrdiff_t>(index));
}

void PayloadPump::stop() {
  is_stopped_ = true;
  on_spare_ = nullptr;
  streams_.clear();
  pending_.clear();
  arrived_.clear();
  announced_.clear();
}

}  // namespace farfield
