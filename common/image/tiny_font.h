// SPDX-License-Identifier: Apache-2.0
// A built-in font of 3×5 pixels for labels on contact sheets: printable ASCII, letters in capitals only.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "common/image/image.h"

namespace farfield {

inline constexpr int kGlyphWidth = 3, kGlyphHeight = 5;

/// Draws `text` with its upper left corner at (x, y), every font pixel `scale` pixels wide; what falls outside the
/// image is left out, and so are characters the font has not.
void draw_text(Image8& image, int x, int y, std::string_view text, int scale,
               const std::array<std::uint8_t, 3>& colour);

/// Width of `text` in pixels.
inline constexpr int text_width(std::size_t characters, int scale) {
  return static_cast<int>(characters) * (kGlyphWidth + 1) * scale;
}

}  // namespace farfield
