// SPDX-License-Identifier: Apache-2.0
// A whole tile to bytes and back. Format: common/codec/README.md.
#pragma once

#include "common/base/bytes.h"
#include "common/base/hash.h"
#include "common/base/result.h"
#include "common/impostor/coded_samples.h"
#include "common/impostor/tile.h"

namespace farfield {

struct TileEncoding {
  int colour_quality = 88;
};

/// Where the bytes of an encoded tile went.
struct TileBytes {
  std::uint32_t colour = 0, disparity = 0, topology = 0, other = 0;
  std::uint32_t covered_samples = 0;
  /// Of what the tile shows and where in its cell, without the cell and the certificate: tiles of two cells with the same one are
  /// interchangeable. Only the encoder tells it.
  ContentHash content = 0;
};

/// What a decoder accepts: nothing beyond is allocated.
struct TileLimits {
  int edge_samples = 8194;
  std::size_t encoded_bytes = std::size_t{4} << 20;
};

/// Uncovered samples' colours are not kept; disparity error <= the tolerance in the header: tile.disparity_tolerance, or
/// 2^-15 of the largest disparity where that is more, as floats tell no more apart.
/// `decoded`: if given, becomes what decode_tile() will return, for a tenth of what that costs.
/// Requires: arrays of the tile's size. Errors: kInvalidArgument (a covered disparity that is negative or not finite, a
/// tolerance that decoders refuse), kInternal (library).
Result<Bytes> encode_tile(const Tile& tile, const TileEncoding& encoding, TileBytes* accounting = nullptr, CodedSamples* decoded = nullptr);

/// Puts another certificate into an encoded tile: it can only be measured once the tile is encoded.
/// Requires: what encode_tile() returned.
void set_certificate(Bytes& encoded, const Certificate& certificate);

/// Errors: kBadData, kVersionMismatch, kLimitExceeded. Safe on any bytes.
Result<Tile> decode_tile(ByteView bytes, const TileLimits& limits = {});

/// Reads the accounting of an encoded tile without decoding it.
Result<TileBytes> inspect_tile(ByteView bytes);

}  // namespace farfield
