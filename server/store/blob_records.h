// SPDX-License-Identifier: Apache-2.0
// What blobs say: encoded tiles, leaf plans and names of leaves, as bytes and back. One format for every tier.
//
//   every record     version u8, then
//   tile             covered u32 · colour, disparity, other bytes u32 · rays u32 · the encoded tile to the end
//   plan             leaf, root (cells) · flags u8 · near triangles u32 · delta views i8 · enclosure, sky (varint size, bytes)
//                    · tiles: varint count, each cell, view, face, x, y, share f32 · chunks: varint count, varint each
//                    · enclosures: varint count, a plan each, without enclosures of its own
//   leaf name        leaf (cell) · blocked u8
//   a cell           level u8, x, y, z i32
//
// What only statistics want (times, what was skipped) is not kept. Little-endian. Readers take any bytes and allocate no more than
// a constant times their size.
#pragma once

#include "server/cells/leaf_plan.h"
#include "server/encode/tile_source.h"

namespace farfield {

Bytes write_tile_record(const EncodedTile& tile);
/// Errors: kBadData, as for the others.
Result<std::shared_ptr<const EncodedTile>> read_tile_record(ByteView bytes);

Bytes write_plan_record(const LeafPlan& plan);
/// `chunks`: how many the scene has; a plan that names others is of another scene.
Result<SharedPlan> read_plan_record(ByteView bytes, std::size_t chunks);

/// The leaf that holds a finest cell.
struct LeafName {
  CellId leaf;
  bool is_blocked = false;  // nobody can stand in it; found out only for those who are expected there
};
Bytes write_leaf_name_record(const LeafName& name);
Result<LeafName> read_leaf_name_record(ByteView bytes);

}  // namespace farfield
