// SPDX-License-Identifier: Apache-2.0
// Rows of labelled images side by side in one image, for looking at what a benchmark measured.
#pragma once

#include <string>
#include <vector>

#include "common/image/image.h"

namespace farfield {

struct SheetImage {
  std::string label;  // drawn above the image, cut to its width
  Image8 image;       // 3 or 4 channels (alpha is ignored)
};

struct SheetOptions {
  int gap_px = 6;
  int text_scale = 2;  // pixels per pixel of the 3×5 font
};

/// Images keep their sizes; rows start at the left edge. Returns: RGB; one pixel if there is nothing to show.
Image8 make_contact_sheet(const std::vector<std::vector<SheetImage>>& rows, const SheetOptions& options = {});

}  // namespace farfield
