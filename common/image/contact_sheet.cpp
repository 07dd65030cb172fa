// SPDX-License-Identifier: Apache-2.0
#include "common/image/contact_sheet.h"

#include <algorithm>

#include "common/image/tiny_font.h"

namespace farfield {
namespace {

void paste(const Image8& image, int left, int top, Image8& sheet) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) std::copy_n(image.at(x, y), 3, sheet.at(left + x, top + y));
  }
}

}  // namespace

Image8 make_contact_sheet(const std::vector<std::vector<SheetImage>>& rows, const SheetOptions& options) {
  const int gap = options.gap_px, label_height = kGlyphHeight * options.text_scale + 2;
  int width = 0, height = gap;
  std::vector<int> row_tops;
  for (const auto& row : rows) {
    int row_width = gap, row_height = 0;
    for (const SheetImage& entry : row) {
      row_width += entry.image.width + gap;
      row_height = std::max(row_height, entry.image.height);
    }
    row_tops.push_back(height);
    width = std::max(width, row_width);
    height += label_height + row_height + gap;
  }
  if (width <= gap) return Image8(1, 1, 3);
  Image8 sheet(width, height, 3, 32);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    int left = gap;
    for (const SheetImage& entry : rows[r]) {
      const int character = text_width(1, options.text_scale);
      const std::string label = entry.label.substr(0, static_cast<std::size_t>(entry.image.width / character));
      draw_text(sheet, left, row_tops[r], label, options.text_scale, {235, 235, 235});
      paste(entry.image, left, row_tops[r] + label_height, sheet);
      left += entry.image.width + gap;
    }
  }
  return sheet;
}

}  // namespace farfield
