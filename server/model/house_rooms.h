// SPDX-License-Identifier: Apache-2.0
// What furnishes one room of the generated house.
#pragma once

#include "server/model/house_furniture.h"

namespace farfield {

inline constexpr float kRoomWidth = 4.35f, kRoomDepth = 4.9f;

/// Room frame: x along the window wall (z = 0), z towards the corridor; [0, kRoomWidth] × [0, kRoomDepth]. The strip
/// 0.7 m < x < 1.7 m from the door to the window and the last 1.5 m before the corridor stay free for walking.
void furnish_room(ModelBuilder& builder, const HousePaints& paints, const Frame& room, RandomStream& random);

}  // namespace farfield
