// SPDX-License-Identifier: Apache-2.0
// StreamSession: what the server sends, from the Welcome to the last payload.
#include <algorithm>
#include <asio/post.hpp>
#include <utility>

#include "client/session/stream_session.h"
#include "client/session/wire_convert.h"
#include "common/codec/tile_codec.h"
#include "common/net/message.h"
#include "proto/farfield.pb.h"

namespace farfield::client {
namespace {

constexpr double kMostPosesPerSecond = 60;

Result<PayloadName> payload_name(const IncomingFrame& frame) {
  PayloadName name;
  if (frame.is(MessageType::kTilePayload)) {
    const Result<wire::TilePayload> message = parse_message<wire::TilePayload>(frame);
    if (!message) return tl::unexpected(message.error());
    name.key = message->key();
  } else if (frame.is(MessageType::kChunkPayload)) {
    const Result<wire::ChunkPayload> message = parse_message<wire::ChunkPayload>(frame);
    if (!message) return tl::unexpected(message.error());
    name.kind = PayloadKind::kChunk;
    name.key = message->hash();
  } else {
    const Result<wire::TexturePayload> message = parse_message<wire::TexturePayload>(frame);
    if (!message) return tl::unexpected(message.error());
    constexpr std::uint32_t kMostLevels = 32;
    if (message->level() >= kMostLevels) {
      return fail(ErrorCode::kBadData, "the server sends level {} of texture {:016x}; there are at most {}",
                  message->level(), message->texture(), kMostLevels);
    }
    name.kind = PayloadKind::kTextureLevel;
    name.key = message->key();
    name.texture = message->texture();
    name.level = static_cast<int>(message->level());
  }
  return name;
}

}  // namespace

Status StreamSession::enter_scene(const wire::Welcome& welcome) {
  const Result<SceneDescription> scene = to_scene_description(welcome.scene());
  if (!scene) return tl::unexpected(scene.error());
  const bool is_same_scene = scene_ && scene_->scene_hash == scene->scene_hash &&
                             glm::all(glm::equal(scene_->origin, scene->origin));
  scene_ = *scene;
  if (!is_same_scene) {
    // Payloads of another scene are void. What is on the screen stays until something new has arrived.
    pool_ = nullptr;
    inbox_.take_all();
    decoding_.clear();
    sets_ = std::make_unique<LeafSets>(scene_->frame, options_.store_bytes);
    TileDecoder tile_decoder = options_.tile_decoder;
    if (!tile_decoder) tile_decoder = [](ByteView bytes) { return decode_tile(bytes, TileLimits{}); };
    PayloadDecoder decoder(scene_->frame.grid, options_.form, std::move(tile_decoder));
    const auto done = [this](const PayloadName& name, Result<DecodedPayload> result) { put_decoded(name, std::move(result)); };
    if (options_.form != DecodeForm::kNone) pool_ = std::make_unique<DecodePool>(std::move(decoder), options_.decode_threads, done);
  }
  const double announced = link_->poses_per_second() > 0 ? link_->poses_per_second() : kMostPosesPerSecond;
  gate_.emplace(scene_->frame.grid, scene_->frame.kappa, options_.display, std::min(announced, kMostPosesPerSecond));
  {
    const std::lock_guard lock(board_.mutex);
    board_.scene = scene_;
  }
  // After the link has noted the session, so that the pose finds it open.
  asio::post(context_, [this] { follow_pose(); });
  return {};
}

Status StreamSession::receive(IncomingFrame frame) {
  Status status;
  switch (static_cast<MessageType>(frame.type)) {
    case MessageType::kLeafSet: status = receive_leaf_set(frame); break;
    case MessageType::kLeafSetComplete: status = receive_complete(frame); break;
    case MessageType::kTilePayload:
    case MessageType::kChunkPayload:
    case MessageType::kTexturePayload: return receive_payload(frame);
    default: return {};  // of a newer server
  }
  after_change();
  return status;
}

Status StreamSession::receive_leaf_set(const IncomingFrame& frame) {
  const Result<wire::LeafSet> message = parse_message<wire::LeafSet>(frame);
  if (!message) return tl::unexpected(message.error());
  Result<LeafSet> set = to_leaf_set(*message);
  if (!set) return tl::unexpected(set.error());
  ++figures_.leaf_sets;
  sets_->announce(std::move(*set));
  return {};
}

Status StreamSession::receive_complete(const IncomingFrame& frame) {
  const Result<wire::LeafSetComplete> message = parse_message<wire::LeafSetComplete>(frame);
  if (!message) return tl::unexpected(message.error());
  sets_->mark_all_sent(message->serial());
  return {};
}

Status StreamSession::receive_payload(const IncomingFrame& frame) {
  const Result<PayloadName> name = payload_name(frame);
  if (!name) return tl::unexpected(name.error());
  const SharedBytes bytes = frame.payload ? frame.payload : std::make_shared<const Bytes>();
  count_payload(*name, *bytes);
  if (sets_->is_redundant(*name)) {
    ++figures_.redundant_payloads;
  } else if (bytes->empty() && name->kind == PayloadKind::kTile) {
    sets_->receive_empty(*name);
    after_change();
  } else {
    submit({*name, bytes});
  }
  return {};
}

void StreamSession::submit(EncodedPayload payload) {
  ++decoding_[payload.name.item()];
  if (!pool_) {
    put_decoded(payload.name, undecoded(payload));
    return;
  }
  const DecodeGroup group = sets_->group_of(payload.name);
  pool_->submit(std::move(payload), group);
  // Not reading while the decoders are behind lets TCP tell the server; what they finish is taken meanwhile.
  while (pool_->queued_bytes() > options_.decode_queue_bytes) take_decoded(inbox_.wait_and_take_all());
}

void StreamSession::put_decoded(const PayloadName& name, Result<DecodedPayload> result) {
  if (inbox_.put({name, std::move(result)})) asio::post(context_, [this] { take_decoded(inbox_.take_all()); });
}

void StreamSession::take_decoded(std::vector<DecodeInbox::Item> items) {
  if (items.empty()) return;
  for (DecodeInbox::Item& item : items) {
    if (const auto at = decoding_.find(item.name.item()); at != decoding_.end() && --at->second <= 0) decoding_.erase(at);
    if (item.result) {
      figures_.decode_seconds += item.result->seconds;
      sets_->receive(std::move(*item.result));
    } else {
      ++figures_.bad_payloads;
      sets_->abandon(item.name);
      const std::lock_guard lock(board_.mutex);
      board_.status.error = std::move(item.result.error());
    }
  }
  after_change();
}

void StreamSession::count_payload(const PayloadName& name, ByteView bytes) {
  switch (name.kind) {
    case PayloadKind::kTile: {
      ++figures_.tiles;
      const Result<TileBytes> parts = inspect_tile(bytes);
      const std::uint64_t colour = parts ? std::min<std::uint64_t>(parts->colour, bytes.size()) : 0;
      const std::uint64_t disparity = parts ? std::min<std::uint64_t>(parts->disparity, bytes.size() - colour) : 0;
      figures_.tile_colour_bytes += colour;
      figures_.tile_disparity_bytes += disparity;
      figures_.tile_other_bytes += bytes.size() - colour - disparity;
      break;
    }
    case PayloadKind::kChunk:
      ++figures_.chunks;
      figures_.chunk_bytes += bytes.size();
      break;
    case PayloadKind::kTextureLevel:
      ++figures_.texture_levels;
      figures_.texture_bytes += bytes.size();
      break;
  }
}

}  // namespace farfield::client
