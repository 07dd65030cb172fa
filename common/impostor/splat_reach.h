// SPDX-License-Identifier: Apache-2.0
// How far a sample's surface reaches towards its neighbours, in sixteenths of the sample spacing. A recorded cut gives an
// odd number; towards a neighbour of the same surface, surfaces overlap a little, as curved ones need it. A surface that a
// nearer one hides goes on behind it: from its own view nothing changes, and from beside it the gap between the two is narrower.
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

/// Towards a neighbour in front of it, a surface is drawn on to just short of the neighbour's place.
inline constexpr std::uint32_t kReachBehind = 15;

/// One of a sample's neighbours in a tile's arrays; a cut between the two is held by `before`, the upper or left one.
struct ReachSide {
  int neighbour;  // -1: none
  int before;
};

inline bool is_connected_to(const Tile& tile, const ReachSide& side, const std::vector<std::uint8_t>& cuts) {
  return side.neighbour >= 0 && tile.coverage[side.neighbour] && cuts[side.before] == kConnected;
}

/// Whether the sample's surface, drawn on to the place of the neighbour at `side`, runs behind what is there, whichever way it
/// is taken to go on: with the slope from the neighbour at `opposite`, if the two are connected, or at its own disparity.
inline bool runs_behind(const Tile& tile, int index, const ReachSide& side, const ReachSide& opposite,
                        const std::vector<std::uint8_t>& cuts) {
  if (!tile.coverage[side.neighbour]) return false;
  const float own = tile.disparity[index], slope = is_connected_to(tile, opposite, cuts) ? own - tile.disparity[opposite.neighbour] : 0.0f;
  // own + slope is twice the sample's disparity less the opposite one's, each within the tolerance, as is the neighbour's.
  constexpr float kTolerances = 2 + 1 + 1;
  return std::max(own, own + slope) + kTolerances * tile.disparity_tolerance < tile.disparity[side.neighbour];
}

/// Of the sample at `index` towards `side`; `opposite`: the other way along the same axis, whose `cuts` these are.
inline std::uint32_t reach_towards(const Tile& tile, int index, const ReachSide& side, const ReachSide& opposite,
                                   const std::vector<std::uint8_t>& cuts) {
  if (side.neighbour < 0) return kReachToNothing;
  const std::uint32_t cut = std::min<std::uint32_t>(cuts[side.before], 8);
  if (cut == kConnected) return tile.coverage[side.neighbour] ? kReachConnected : kReachToNothing;
  if (runs_behind(tile, index, side, opposite, cuts)) return kReachBehind;
  return side.before == index ? 2 * cut - 1 : 17 - 2 * cut;
}

/// All four of the sample at `index` of the tile's arrays.
inline std::uint16_t reach_of_sample(const Tile& tile, int index, int left, int right, int up, int down) {
  const ReachSide to_left{left, left}, to_right{right, index}, to_up{up, up}, to_down{down, index};
  return pack_reach(reach_towards(tile, index, to_left, to_right, tile.cut_right), reach_towards(tile, index, to_right, to_left, tile.cut_right),
                    reach_towards(tile, index, to_up, to_down, tile.cut_down), reach_towards(tile, index, to_down, to_up, tile.cut_down));
}

}  // namespace farfield
