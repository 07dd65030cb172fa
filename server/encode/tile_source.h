// SPDX-License-Identifier: Apache-2.0
// From a tile's name to its encoded bytes: the boundary between making impostors and storing them.
#pragma once

#include "common/base/bytes.h"
#include "common/impostor/tile_id.h"
#include "server/cells/leaf_plan.h"

namespace farfield {

struct EncodedTile {
  SharedBytes bytes;          // empty vector: the tile holds nothing and is not sent
  ContentHash hash = 0;       // of the bytes
  double seconds = 0;         // thread seconds spent
  double intra_seconds = 0;   // of these, casting and shading one ray per sample of the intra view
  std::uint32_t covered_samples = 0;
  std::uint32_t colour_bytes = 0, disparity_bytes = 0, other_bytes = 0;
};

/// What was not cast, kept or sent because nobody needs it: counted since start.
struct TileSkips {
  std::uint64_t empty_tiles = 0;           // held nothing
  std::uint64_t samples_coloured_once = 0; // covered, of one ray or look-up: more would have changed nothing
  std::uint64_t hidden_samples = 0;        // of dense tiles: nobody in the leaf can see them
  std::uint64_t delta_blocks_not_cast = 0; // probed, and earlier views hold all of it
  std::uint64_t delta_samples_held = 0;    // cast, and an earlier view holds them
};

/// Thread-safe. The bytes depend on scene, settings and id only. Runs on the calling thread (1 … 50 ms per tile).
/// Errors: kCancelled.
class TileSource {
 public:
  virtual ~TileSource() = default;
  virtual Result<std::shared_ptr<const EncodedTile>> make(const TileId& id, const CancelFlag& cancel) = 0;
  virtual TileSkips skips() const { return {}; }
};

}  // namespace farfield
