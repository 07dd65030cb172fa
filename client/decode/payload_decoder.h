// SPDX-License-Identifier: Apache-2.0
// From a payload's bytes to what the renderers draw. Stateless: any number of threads may call one decoder.
#pragma once

#include <functional>

#include "client/decode/payload.h"
#include "common/base/result.h"
#include "common/cells/cell_id.h"
#include "common/impostor/tile.h"

namespace farfield::client {

/// What a tile is turned into: a depth mesh for the GL renderer, splats for the CPU warper. Nothing: what arrives is counted and held,
/// and cannot be drawn; for clients that only put load on a server.
enum class DecodeForm { kMesh, kSplats, kBoth, kNone };

/// Bytes to a tile; the codec of common/codec unless a test brings its own. Must be thread-safe.
using TileDecoder = std::function<Result<Tile>(ByteView)>;

class PayloadDecoder {
 public:
  PayloadDecoder(CellGrid grid, DecodeForm form, TileDecoder tile_decoder);

  /// Errors: kBadData, kLimitExceeded; the message names the payload.
  Result<DecodedPayload> decode(const EncodedPayload& payload) const;

 private:
  Result<DecodedPayload> decode_tile_payload(const EncodedPayload& payload) const;

  CellGrid grid_;
  DecodeForm form_;
  TileDecoder tile_decoder_;
};

/// What DecodeForm::kNone makes of a payload, without its bytes being looked at: microseconds less than handing it to another thread.
DecodedPayload undecoded(const EncodedPayload& payload);

}  // namespace farfield::client
