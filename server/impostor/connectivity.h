// SPDX-License-Identifier: Apache-2.0
// Which neighbouring samples belong to one surface, and where surfaces end between those that do not.
//
// Based on: Wilson & Manocha 2003, section 3 (tests 1 and 2: no connection to nothing, none along the line of sight).
// Differs: tangent planes are asked first, as the angle test alone cuts floors seen at grazing angles; test 3 (another
// view sees past the connection) is left to the delta views, which hold whatever lies behind.
#pragma once

#include "common/impostor/tile.h"
#include "common/impostor/tile_neighbours.h"
#include "server/impostor/view_frame.h"

namespace farfield {

struct ConnectionLimits {
  float one_sample = 0;      // disparity that moves a point by one sample's width anywhere in the cell, 1/side
  float angle_slope = 0;     // |Δz| per sample footprint above which test 2 calls a connection a skin
};
ConnectionLimits connection_limits(const ViewFrame& frame, double warp_gain);

/// True if samples a and b (one step apart; `ga`, `gb`: their planes' slopes along the step) are one surface: each lies on
/// the other's tangent plane within one sample's warp, or their planes meet in a crease between them, or the step in
/// depth is small against the step across (test 2). Requires: both covered.
bool is_connected(float a, float ga, float b, float gb, const ConnectionLimits& limits, float pitch);

/// Fills tile.cut_right and tile.cut_down from the samples; places cuts by bisection to an eighth of a sample with
/// packets of rays. `kept`: samples the tile will hold; between a kept sample and one that another view holds, the
/// surface goes on: the cut is put at the far end. tile.coverage must equal `kept`.
void find_cuts(const Scene& scene, const CellSpace& space, const ViewFrame& frame, const SampleArrays& samples,
               const ConnectionLimits& limits, const TileNeighbours& neighbours, const std::vector<int>& sample_i,
               const std::vector<int>& sample_j, Tile& tile);

}  // namespace farfield
