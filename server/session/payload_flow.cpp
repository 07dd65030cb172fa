// SPDX-License-Identifier: Apache-2.0
// How payloads flow through the pump: requested, arrived, sent, and leaf sets completed.
#include <algorithm>
#include <asio/dispatch.hpp>
#include <utility>

#include "common/net/message.h"
#include "proto/farfield.pb.h"
#include "server/session/payload_pump.h"
#include "server/session/session_messages.h"

namespace farfield {
namespace {

/// Finer levels of textures after everything that has a shape.
constexpr float kFineTextureShare = 0.0f;

}  // namespace

void PayloadPump::pump() {
  // Sending can drain the connection and call pump() from below.
  if (is_stopped_ || std::exchange(is_pumping_, true)) return;
  do {
    send_arrived();
    finish_streams();
    request_more();
  } while (!arrived_.empty() && parts_.connection->has_room());  // what is at hand arrives while it is asked for
  is_pumping_ = false;
  const bool is_spare = has_spare_capacity();
  const bool has_become_spare = is_spare && !was_spare_;
  was_spare_ = is_spare;
  if (has_become_spare && on_spare_) on_spare_();
}

void PayloadPump::retry_failed() {
  if (failed_.empty()) return;
  failed_.clear();
  for (const auto& stream : streams_) stream->rewind();
  pump();
}

void PayloadPump::send_arrived() {
  while (!arrived_.empty() && parts_.connection->has_room()) {
    const auto entry = pending_.find(arrived_.front());
    arrived_.pop_front();
    if (entry == pending_.end()) continue;
    send(entry->second);
    pending_prefetch_ -= entry->second.is_prefetch ? 1 : 0;
    pending_.erase(entry);
  }
}

bool PayloadPump::send(Pending& pending) {
  SessionMetrics& metrics = parts_.metrics;
  const std::size_t size = pending.bytes->size();
  OutgoingFrame frame;
  switch (pending.item.kind) {
    case PayloadItem::Kind::kTile: {
      wire::TilePayload tile;
      tile.set_key(pending.item.key);
      ++(size == 0 ? metrics.payloads_empty_tile : metrics.payloads_tile);
      frame = make_message(MessageType::kTilePayload, tile, std::move(pending.bytes));
      break;
    }
    case PayloadItem::Kind::kChunk: {
      wire::ChunkPayload chunk;
      chunk.set_hash(pending.item.key);
      ++metrics.payloads_chunk;
      frame = make_message(MessageType::kChunkPayload, chunk, std::move(pending.bytes));
      break;
    }
    case PayloadItem::Kind::kTexture: {
      const SceneTexture texture = parts_.service->texture(pending.item.index);
      wire::TexturePayload level;
      level.set_texture(texture.hash);
      level.set_level(pending.item.level);
      level.set_level_count(static_cast<std::uint32_t>(texture.level_count));
      level.set_key(pending.item.key);
      ++metrics.payloads_texture;
      frame = make_message(MessageType::kTexturePayload, level, std::move(pending.bytes));
      break;
    }
  }
  frame.tag = pending.item.key;
  if (!parts_.connection->send(std::move(frame), pending.is_prefetch ? Lane::kPrefetch : Lane::kPayload)) return false;
  held_.insert(pending.item.key, size);
  metrics.payload_bytes += size;
  LeafStream* stream = find_stream(pending.stream);
  if (pending.is_prefetch && stream) {
    stream->prefetched_bytes += size;
    parts_.planner.add_outstanding(size);
  }
  return true;
}

void PayloadPump::finish_streams() {
  for (std::size_t i = 0; i < streams_.size() && parts_.connection->has_room();) {
    LeafStream& stream = *streams_[i];
    if (!stream.is_complete && stream.is_announced && stream.is_all_sent(held_)) {
      OutgoingFrame frame = leaf_set_complete_message(stream.serial);
      frame.tag = stream.serial;
      // In its payloads' lane, so that it comes after the last of them.
      if (!parts_.connection->send(std::move(frame), stream.is_prefetch() ? Lane::kPrefetch : Lane::kPayload)) return;
      stream.is_complete = true;
      ++parts_.metrics.leaf_sets_complete;
      for (Announced& announced : announced_) {
        if (announced.serial == stream.serial) announced.is_complete = true;
      }
    }
    ++i;
  }
  // A leaf that was left has nothing more to wait for; and once the current leaf is complete neither it nor a fallback
  // view need be waited for.
  for (std::size_t i = streams_.size(); i-- > 0;) {
    const bool is_left = streams_[i]->role == LeafStream::Role::kLeft;
    const bool is_done_with = is_current_complete() && (is_left || (streams_[i]->is_fallback() && !streams_[i]->is_complete));
    if (!is_done_with && !(is_left && streams_[i]->is_complete)) continue;
    const std::uint64_t left = streams_[i]->serial;
    drop_stream(i);
    if (is_current_complete()) drop_requests([&](ContentHash, const Pending& p) { return p.stream == left; });
  }
}

void PayloadPump::request_more() {
  const std::size_t limit = parts_.limits.requests;
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    LeafStream& stream = *streams_[i];
    if (stream.is_prefetch()) {
      // Ahead of need only when nothing needed waits: what is cast for later is not cast for now.
      if (!parts_.connection->has_room() || !parts_.planner.may_prefetch() || !has_spare_capacity()) break;
      if (!stream.is_announced) announce(stream);
    }
    const auto is_waiting = [&](ContentHash key) {
      const auto entry = pending_.find(key);
      const bool is_asked = entry != pending_.end() && (stream.is_prefetch() || !entry->second.is_prefetch);
      return is_asked || failed_.contains(key);
    };
    while (parts_.connection->has_room() && pending_.size() < limit &&
           !(stream.is_prefetch() && pending_prefetch_ >= parts_.limits.prefetch_requests)) {
      const PayloadItem* item = stream.next_item(held_, is_waiting);
      if (!item) break;
      request(*item, stream);
    }
  }
  // A stream all of whose items were held is complete without a single answer.
  finish_streams();
}

void PayloadPump::request(const PayloadItem& item, LeafStream& stream) {
  Pending& pending = pending_[item.key];
  const bool has_arrived = pending.bytes != nullptr;
  pending_prefetch_ -= pending.is_prefetch ? 1 : 0;
  pending.item = item;
  pending.stream = stream.serial;
  pending.is_prefetch = stream.is_prefetch();
  pending_prefetch_ += pending.is_prefetch ? 1 : 0;
  if (has_arrived) return;
  pending.request = next_request_++;
  const ContentHash key = item.key;
  // The former ticket, if there is one, goes after the new request is made: the work under way is not cancelled.
  Ticket ticket = ask(item, stream, pending.request);
  if (const auto entry = pending_.find(key); entry != pending_.end() && !entry->second.bytes) entry->second.ticket = std::move(ticket);
}

Ticket PayloadPump::ask(const PayloadItem& item, const LeafStream& stream, std::uint64_t request) {
  WorkPriority priority{stream.seconds_until_needed, 1.0f, stream.is_prefetch()};
  const auto answer = [weak = weak_from_this(), key = item.key, request](Result<SharedBytes> bytes) {
    // Whoever holds the pump holds what keeps its executor alive.
    const std::shared_ptr<PayloadPump> self = weak.lock();
    if (!self) return;
    // At once where it is at hand: then this is the thread that asked.
    asio::dispatch(self->parts_.connection->executor(), [self, key, request, bytes = std::move(bytes)]() mutable {
      self->receive(key, request, std::move(bytes));
    });
  };
  switch (item.kind) {
    case PayloadItem::Kind::kChunk: return parts_.service->chunk(item.index, priority, answer);
    case PayloadItem::Kind::kTexture:
      if (!is_coarse_level(parts_.service->texture(item.index), item.level)) priority.view_share = kFineTextureShare;
      return parts_.service->texture_level(item.index, item.level, priority, answer);
    case PayloadItem::Kind::kTile: break;
  }
  const LeafPlan& plan = *stream.plan;
  priority.view_share = plan.tiles[item.index].view_share;
  return parts_.service->tile(plan.tiles[item.index].id, priority,
                              [answer](Result<std::shared_ptr<const EncodedTile>> tile) {
                                answer(tile ? Result<SharedBytes>((*tile)->bytes) : tl::unexpected(tile.error()));
                              });
}

void PayloadPump::receive(ContentHash key, std::uint64_t request, Result<SharedBytes> bytes) {
  const auto entry = pending_.find(key);
  if (is_stopped_ || entry == pending_.end() || entry->second.request != request || entry->second.bytes) return;
  if (!bytes) {
    ++parts_.metrics.payloads_failed;
    failed_.insert(key);
    pending_prefetch_ -= entry->second.is_prefetch ? 1 : 0;
    pending_.erase(entry);
  } else {
    entry->second.bytes = *bytes ? std::move(*bytes) : std::make_shared<const Bytes>();
    entry->second.ticket.release();
    arrived_.push_back(key);
  }
  pump();
}

}  // namespace farfield
