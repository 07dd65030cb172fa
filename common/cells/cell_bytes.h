// SPDX-License-Identifier: Apache-2.0
// Cells in records that are kept: level u8, x, y, z i32, little-endian.
#pragma once

#include "common/base/bytes.h"
#include "common/cells/cell_id.h"

namespace farfield {

inline constexpr std::size_t kCellBytes = 13;

inline void put_cell(ByteWriter& out, const CellId& cell) { out.put(cell.level), out.put(cell.x), out.put(cell.y), out.put(cell.z); }

/// Any bytes give a cell: whoever reads judges its level.
inline CellId get_cell(ByteReader& in) {
  CellId cell;
  cell.level = in.get<std::uint8_t>();
  cell.x = in.get<std::int32_t>(), cell.y = in.get<std::int32_t>(), cell.z = in.get<std::int32_t>();
  return cell;
}

}  // namespace farfield
