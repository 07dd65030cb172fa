// SPDX-License-Identifier: Apache-2.0
// Which levels to send for the colours of a tile's blocks: the cheapest for what they leave of the error.
//
// Based on: Y. Shoham & A. Gersho, "Efficient bit allocation for an arbitrary set of quantizers", 1988: whatever is sent, a
// byte should buy the same error everywhere. With its step a coefficient does, but for those that are small:
// these are dropped where the bits they cost buy less than that.
#pragma once

#include <vector>

#include "common/codec/block_transform.h"
#include "common/codec/colour_blocks.h"

namespace farfield {

/// The samples of one plane of a block, and which are covered; the others are 0.
struct ColourPlane {
  BlockPlane samples{};
  std::uint64_t covered = 0;
};

/// The quantiser's step for each coefficient, of luma and of colour differences.
struct ColourSteps {
  BlockPlane luma, difference;
  const BlockPlane& of(std::size_t plane) const { return plane == 0 ? luma : difference; }
};

/// `planes`: kColourPlanes for each block; what they hold is lost. The same for the same input, whatever thread.
std::vector<ColourBlock> quantise_colours(std::vector<ColourPlane>& planes, const ColourSteps& steps);

}  // namespace farfield
