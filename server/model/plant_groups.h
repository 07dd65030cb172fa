// SPDX-License-Identifier: Apache-2.0
// Groups of machines that fill one strip of the generated plant, and the walls that part its spaces.
#pragma once

#include "server/model/plant_equipment.h"

namespace farfield {

/// A strip is [0, length] × [0, width] in the frame's x and z, metres; its z = 0 side backs on a corridor, its other
/// side lies open to an aisle. What stands in it is at most `kStripHeight` high.
constexpr float kStripLength = 11.6f, kStripWidth = 4.8f, kStripHeight = 4.5f;

/// One group, drawn from `random`: pumps, vessels, a tank farm, a turbine, a switch room, a bank of pipes …
void add_machine_strip(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, RandomStream& random);

/// A wall along local x, 0.15 m thick about z = 0, standing on y = 0. `door_x_m` ≥ 0: an opening of 1.6 × 2.4 m
/// begins there.
void add_partition(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame, float length_m,
                   float height_m, float door_x_m = -1);
/// A closed double door of 1.8 × 2.3 m, both sides of a partition, its middle at local x = 0.
void add_closed_door(ModelBuilder& builder, const PlantPaints& paints, const Frame& frame);

}  // namespace farfield
