// SPDX-License-Identifier: Apache-2.0
// Decoded payloads by key, bounded in bytes. What is pinned stays; of the rest the least recently used goes first.
//
// An item is a tile, a chunk, or a texture with all its levels that have arrived. Items are named as leaf sets name
// them (PayloadName::item()); what has gone is reported by payload key, as the server counts. Not thread-safe.
#pragma once

#include <list>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "client/decode/payload.h"

namespace farfield::client {

class PayloadStore {
 public:
  explicit PayloadStore(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  /// Requires: size_bytes() + payload.memory_bytes <= budget_bytes(); make_room() says whether that can be had.
  /// A texture level joins the levels already there under a new serial. Replaces an item of the same key.
  void insert(DecodedPayload payload, bool is_pinned);
  /// Evicts unpinned items until `bytes` more would fit. Returns: whether they do.
  bool make_room(std::size_t bytes);

  bool contains(ContentHash item) const { return items_.contains(item); }
  /// Null if not held.
  std::shared_ptr<const DecodedTile> tile(ContentHash key) const;
  std::shared_ptr<const DecodedChunk> chunk(ContentHash hash) const;
  std::shared_ptr<const DecodedTexture> texture(ContentHash hash) const;
  bool contains_level(ContentHash texture, int level) const;
  std::size_t item_bytes(ContentHash item) const;

  /// Exactly `items` are pinned from now on; they count as just used.
  void set_pins(const std::unordered_set<ContentHash>& items);
  bool is_pinned(ContentHash item) const;

  /// Drops the finest of at least two levels. Returns: whether there was one to drop.
  bool drop_finest_level(ContentHash texture);
  /// Drops an item, pinned or not.
  void erase(ContentHash item);

  struct Gone {
    ContentHash payload = 0;
    ContentHash item = 0;  // it belonged to; still there if only a texture's finest level has gone
  };
  /// What has gone since the last call.
  std::vector<Gone> take_gone() { return std::exchange(gone_, {}); }
  /// Payload keys held, the most recently used first, at most `count`: what a reconnecting client still has.
  std::vector<ContentHash> held_payloads(std::size_t count) const;

  std::size_t size_bytes() const { return size_bytes_; }
  std::size_t budget_bytes() const { return budget_bytes_; }
  std::size_t count() const { return items_.size(); }

 private:
  struct Item {
    std::shared_ptr<const DecodedTile> tile;
    std::shared_ptr<const DecodedChunk> chunk;
    std::shared_ptr<const DecodedTexture> texture;
    std::vector<ContentHash> level_keys;  // of texture->levels, same order
    std::size_t bytes = 0;
    bool is_pinned = false;
    std::list<ContentHash>::iterator use;
  };
  using Items = std::unordered_map<ContentHash, Item>;

  void add_level(Item& item, DecodedPayload payload);
  std::list<ContentHash>& order_of(bool is_pinned) { return is_pinned ? pinned_ : unpinned_; }
  void erase(Items::iterator at);

  const std::size_t budget_bytes_;
  std::size_t size_bytes_ = 0;
  Items items_;
  std::list<ContentHash> pinned_, unpinned_;  // least recently used first
  std::vector<Gone> gone_;
};

}  // namespace farfield::client
