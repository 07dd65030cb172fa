// SPDX-License-Identifier: Apache-2.0
// How far a sample's surface reaches towards its neighbours, in sixteenths of the sample spacing. A recorded cut gives an
// odd number; towards a neighbour of the same surface, surfaces overlap a little, as curved ones need it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/impostor/tile.h"
#include "common/impostor/tile_neighbours.h"

namespace farfield {

inline constexpr std::uint32_t kReachToNothing = 8;     // nothing is known of what lies there
inline constexpr std::uint32_t kReachConnected = 10;    // the neighbour is held
/// Four reaches as nibbles: left, right, up, down from the lowest. Left and right are along u, up and down along v
/// (down: towards larger v).
inline constexpr std::uint16_t pack_reach(std::uint32_t left, std::uint32_t right, std::uint32_t up,
                                          std::uint32_t down) {
  return static_cast<std::uint16_t>(left | right << 4 | up << 8 | down << 12);
}
inline constexpr std::uint16_t kReachHalfway =
    pack_reach(kReachToNothing, kReachToNothing, kReachToNothing, kReachToNothing);
inline constexpr std::uint16_t kReachAllConnected =
    pack_reach(kReachConnected, kReachConnected, kReachConnected, kReachConnected);

/// Towards `neighbour` (-1: none), where a cut of the two is held by `before`, the upper or left one. `is_before`: that is
/// the sample itself.
inline std::uint32_t reach_towards(const Tile& tile, int neighbour, const std::vector<std::uint8_t>& cuts, int before,
                                   bool is_before) {
  if (neighbour < 0) return kReachToNothing;
  const std::uint32_t cut = std::min<std::uint32_t>(cuts[before], 8);
  if (cut == kConnected) return tile.coverage[neighbour] ? kReachConnected : kReachToNothing;
  return is_before ? 2 * cut - 1 : 17 - 2 * cut;
}

/// All four of the sample at `index` of the tile's arrays.
inline std::uint16_t reach_of_sample(const Tile& tile, int index, int left, int right, int up, int down) {
  return pack_reach(reach_towards(tile, left, tile.cut_right, left, false),
                    reach_towards(tile, right, tile.cut_right, index, true),
                    reach_towards(tile, up, tile.cut_down, up, false),
                    reach_towards(tile, down, tile.cut_down, index, true));
}

}  // namespace farfield
