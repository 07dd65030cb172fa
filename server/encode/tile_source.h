// SPDX-License-Identifier: Apache-2.0
// From a tile's name to its encoded bytes: the boundary between making impostors and storing them.
#pragma once

#include "common/base/bytes.h"
#include "common/impostor/tile_id.h"
#include "server/cells/leaf_plan.h"
#include "server/impostor/stage_seconds.h"

namespace farfield {

/// What was not cast, kept, coded or sent because nobody needs it: of one tile, or summed up.
struct TileSkips {
  std::uint64_t empty_tiles = 0;           // held nothing
  std::uint64_t samples_coloured_once = 0; // covered, of one ray or look-up: more would have changed nothing
  std::uint64_t hidden_samples = 0;        // of dense tiles, not cast: nobody in the leaf can see them
  std::uint64_t delta_blocks_hidden = 0;   // of delta tiles, not even probed: likewise
  std::uint64_t delta_blocks_not_cast = 0; // probed, and earlier views hold all of it
  std::uint64_t delta_samples_held = 0;    // cast, and an earlier view holds them
  std::uint64_t samples_without_depth = 0; // so far away that parallax within the cell stays below the tolerance: coded at infinity
  std::uint64_t identical_tiles = 0;       // another cell's tile shows the same: sent nevertheless, each under its own name …
  std::uint64_t identical_bytes = 0;       // … in so many bytes

  TileSkips& operator+=(const TileSkips& other) {
    empty_tiles += other.empty_tiles, samples_coloured_once += other.samples_coloured_once, hidden_samples += other.hidden_samples;
    delta_blocks_hidden += other.delta_blocks_hidden, delta_blocks_not_cast += other.delta_blocks_not_cast;
    delta_samples_held += other.delta_samples_held, samples_without_depth += other.samples_without_depth;
    identical_tiles += other.identical_tiles, identical_bytes += other.identical_bytes;
    return *this;
  }
};

/// Of the code that makes plans and tiles: raise it when they change for the same scene and settings, so that stores forget older ones.
inline constexpr std::uint64_t kImpostorVersion = 1;

struct EncodedTile {
  SharedBytes bytes;          // empty vector: the tile holds nothing and is not sent
  ContentHash hash = 0;       // of the bytes
  double seconds = 0;         // thread seconds spent
  StageSeconds stages;        // of these
  std::uint32_t covered_samples = 0;
  std::uint32_t colour_bytes = 0, disparity_bytes = 0, other_bytes = 0;
  std::uint32_t rays = 0;     // one per sample cast; probes, cuts and several rays per sample left out
  TileSkips skips;
};

/// Made so far: what certificates found.
struct CertificateCounts {
  std::uint64_t certified = 0;  // tiles
  std::uint64_t refined = 0;    // coded finer to meet their target
  std::uint64_t missed = 0;     // could not meet it, or belong to a shell that could not
};

/// Thread-safe. The bytes depend on scene, settings and id only. Runs on the calling thread (1 … 50 ms per tile).
/// Errors: kCancelled.
class TileSource {
 public:
  virtual ~TileSource() = default;
  virtual Result<std::shared_ptr<const EncodedTile>> make(const TileId& id, const CancelFlag& cancel) = 0;
  /// Of all tiles made since start.
  virtual TileSkips skips() const { return {}; }
  virtual CertificateCounts certificates() const { return {}; }
};

}  // namespace farfield
