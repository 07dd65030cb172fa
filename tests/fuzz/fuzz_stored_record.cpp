// SPDX-License-Identifier: Apache-2.0
// Records from a store that somebody else may have written to: tiles, plans and names of leaves, chosen by the first byte.
#include <cmath>

#include "server/store/blob_records.h"
#include "tests/fuzz/require.h"

using farfield::fuzz::require;

namespace {

constexpr std::size_t kChunks = 1000;

void check(const farfield::LeafPlan& plan) {
  for (const farfield::NeededTile& tile : plan.tiles) {
    require(tile.id.face < 6 && tile.id.cell.level <= farfield::kMaxCellLevel, "tiles have names that exist");
    require(std::isfinite(tile.view_share), "shares are finite");
  }
  for (const std::uint32_t chunk : plan.chunks) require(chunk < kChunks, "chunks are the scene's");
  for (const farfield::SharedPlan& part : plan.enclosures) {
    require(part && part->enclosures.empty(), "enclosures are not divided again");
    check(*part);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const farfield::ByteView bytes(data + 1, size - 1);
  switch (data[0] % 3) {
    case 0:
      if (const auto tile = farfield::read_tile_record(bytes)) require((*tile)->bytes && (*tile)->bytes->size() < size, "a tile's bytes are the record's");
      break;
    case 1:
      if (const auto plan = farfield::read_plan_record(bytes, kChunks)) {
        check(**plan);
        const auto again = farfield::read_plan_record(farfield::write_plan_record(**plan), kChunks);
        require(again && (*again)->tiles.size() == (*plan)->tiles.size() && (*again)->chunks == (*plan)->chunks, "what was read can be written and read");
      }
      break;
    default:
      if (const auto name = farfield::read_leaf_name_record(bytes)) require(name->leaf.level <= farfield::kMaxCellLevel, "a leaf's level exists");
  }
  return 0;
}
