// SPDX-License-Identifier: Apache-2.0
// Colours where a tile holds no sample: meshes reach past their last samples up to the cut, and texture filters farther.
#pragma once

#include <cstdint>
#include <vector>

namespace farfield {

/// Replaces the colour of uncovered samples by a smooth continuation of the covered ones (pull-push pyramid: Gortler et
/// al. 1996, section 5.3). Sizes: rgb 3·w·h, coverage w·h. O(w·h).
void fill_uncovered(std::vector<std::uint8_t>& rgb, const std::vector<std::uint8_t>& coverage, int width, int height);

}  // namespace farfield
