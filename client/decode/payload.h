// SPDX-License-Identifier: Apache-2.0
// Payloads on their way through the client: as they come off the wire, and decoded.
#pragma once

#include <memory>

#include "client/store/leaf_view.h"
#include "common/base/bytes.h"
#include "common/base/hash.h"

namespace farfield::client {

enum class PayloadKind : std::uint8_t { kTile, kChunk, kTextureLevel };

/// Which payload this is. `key` is what the wire calls it: in LeafSet.tiles, Hello.held and Evicted.
struct PayloadName {
  PayloadKind kind = PayloadKind::kTile;
  ContentHash key = 0;
  ContentHash texture = 0;  // texture levels only: the texture they belong to
  int level = 0;            // texture levels only: 0 is the full size

  /// What leaf sets ask for: textures as a whole, tiles and chunks by their key.
  ContentHash item() const { return kind == PayloadKind::kTextureLevel ? texture : key; }
};

struct EncodedPayload {
  PayloadName name;
  SharedBytes bytes;
};

/// One of the three is set, by name.kind; none for a tile that turned out to hold nothing.
struct DecodedPayload {
  PayloadName name;
  std::shared_ptr<const DecodedTile> tile;
  std::shared_ptr<const DecodedChunk> chunk;
  TextureLevel texture_level;
  std::size_t memory_bytes = 0;
  double seconds = 0;  // thread time spent decoding
};

/// "tile", "chunk" or "texture level", for messages.
const char* payload_kind_name(PayloadKind kind);

/// A number that no other call in this process has returned: GL objects are cached under it. Thread-safe.
std::uint64_t next_serial();

}  // namespace farfield::client
