// SPDX-License-Identifier: Apache-2.0
#include "client/store/payload_store.h"

#include <algorithm>
#include <utility>

namespace farfield::client {
namespace {

std::size_t level_bytes(const TextureLevel& level) { return sizeof(TextureLevel) + level.rgba.size(); }

}  // namespace

void PayloadStore::insert(DecodedPayload payload, bool is_pinned) {
  const ContentHash key = payload.name.item();
  const auto [at, is_new] = items_.try_emplace(key);
  Item& item = at->second;
  if (is_new) {
    item.is_pinned = is_pinned;
    item.use = order_of(is_pinned).insert(order_of(is_pinned).end(), key);
  }
  const bool is_level = payload.name.kind == PayloadKind::kTextureLevel;
  // A server that calls a texture and something else by one name gets the first of them only.
  if (!is_new && is_level != (item.texture != nullptr)) return;
  if (is_level) {
    add_level(item, std::move(payload));
    return;
  }
  size_bytes_ += payload.memory_bytes - item.bytes;
  item.bytes = payload.memory_bytes;
  item.tile = std::move(payload.tile);
  item.chunk = std::move(payload.chunk);
}

void PayloadStore::add_level(Item& item, DecodedPayload payload) {
  auto texture = std::make_shared<DecodedTexture>();
  texture->hash = payload.name.texture;
  texture->serial = next_serial();
  std::vector<ContentHash> keys = std::move(item.level_keys);
  if (item.texture) texture->levels = item.texture->levels;
  const int level = payload.name.level;
  const auto place = std::find_if(texture->levels.begin(), texture->levels.end(),
                                  [&](const TextureLevel& held) { return held.level <= level; });
  const auto index = place - texture->levels.begin();
  if (place != texture->levels.end() && place->level == level) {
    size_bytes_ -= level_bytes(*place);
    item.bytes -= level_bytes(*place);
    *place = std::move(payload.texture_level);
    keys[index] = payload.name.key;
  } else {
    texture->levels.insert(place, std::move(payload.texture_level));
    keys.insert(keys.begin() + index, payload.name.key);
  }
  size_bytes_ += level_bytes(texture->levels[index]);
  item.bytes += level_bytes(texture->levels[index]);
  item.level_keys = std::move(keys);
  item.texture = std::move(texture);
}

bool PayloadStore::make_room(std::size_t bytes) {
  while (size_bytes_ + bytes > budget_bytes_ && !unpinned_.empty()) erase(items_.find(unpinned_.front()));
  return size_bytes_ + bytes <= budget_bytes_;
}

std::shared_ptr<const DecodedTile> PayloadStore::tile(ContentHash key) const {
  const auto at = items_.find(key);
  return at == items_.end() ? nullptr : at->second.tile;
}

std::shared_ptr<const DecodedChunk> PayloadStore::chunk(ContentHash hash) const {
  const auto at = items_.find(hash);
  return at == items_.end() ? nullptr : at->second.chunk;
}

std::shared_ptr<const DecodedTexture> PayloadStore::texture(ContentHash hash) const {
  const auto at = items_.find(hash);
  return at == items_.end() ? nullptr : at->second.texture;
}

bool PayloadStore::contains_level(ContentHash texture_hash, int level) const {
  const std::shared_ptr<const DecodedTexture> held = texture(texture_hash);
  return held && std::any_of(held->levels.begin(), held->levels.end(),
                             [&](const TextureLevel& have) { return have.level == level; });
}

std::size_t PayloadStore::item_bytes(ContentHash item) const {
  const auto at = items_.find(item);
  return at == items_.end() ? 0 : at->second.bytes;
}

void PayloadStore::set_pins(const std::unordered_set<ContentHash>& wanted) {
  for (auto at = pinned_.begin(); at != pinned_.end();) {
    const auto current = at++;
    if (wanted.contains(*current)) continue;
    items_.at(*current).is_pinned = false;
    unpinned_.splice(unpinned_.end(), pinned_, current);
  }
  for (const ContentHash key : wanted) {
    const auto at = items_.find(key);
    if (at == items_.end()) continue;
    pinned_.splice(pinned_.end(), order_of(at->second.is_pinned), at->second.use);
    at->second.is_pinned = true;
  }
}

bool PayloadStore::is_pinned(ContentHash item) const {
  const auto at = items_.find(item);
  return at != items_.end() && at->second.is_pinned;
}

bool PayloadStore::drop_finest_level(ContentHash texture) {
  const auto at = items_.find(texture);
  if (at == items_.end() || at->second.level_keys.size() < 2) return false;
  Item& item = at->second;
  auto coarser = std::make_shared<DecodedTexture>();
  coarser->hash = texture;
  coarser->serial = next_serial();
  coarser->levels.assign(item.texture->levels.begin(), item.texture->levels.end() - 1);
  const std::size_t freed = level_bytes(item.texture->levels.back());
  size_bytes_ -= freed;
  item.bytes -= freed;
  gone_.push_back({item.level_keys.back(), texture});
  item.level_keys.pop_back();
  item.texture = std::move(coarser);
  return true;
}

void PayloadStore::erase(ContentHash item) {
  if (const auto at = items_.find(item); at != items_.end()) erase(at);
}

void PayloadStore::erase(Items::iterator at) {
  Item& item = at->second;
  size_bytes_ -= item.bytes;
  order_of(item.is_pinned).erase(item.use);
  if (!item.texture) gone_.push_back({at->first, at->first});
  for (const ContentHash level : item.level_keys) gone_.push_back({level, at->first});
  items_.erase(at);
}

std::vector<ContentHash> PayloadStore::held_payloads(std::size_t count) const {
  std::vector<ContentHash> keys;
  const auto add = [&](ContentHash key) {
    if (keys.size() < count) keys.push_back(key);
  };
  for (const std::list<ContentHash>* order : {&pinned_, &unpinned_}) {
    for (auto at = order->rbegin(); at != order->rend() && keys.size() < count; ++at) {
      const Item& item = items_.at(*at);
      if (!item.texture) add(*at);
      for (const ContentHash level : item.level_keys) add(level);
    }
  }
  return keys;
}

}  // namespace farfield::client
