// SPDX-License-Identifier: Apache-2.0
#include "common/image/tiny_font.h"

#include <algorithm>

namespace farfield {
namespace {

// One octal digit per row, top row first; its bits are the row's three pixels, left to right.
constexpr std::array<std::uint16_t, 10> kDigits{075557, 026227, 071747, 071317, 055711,
                                                074717, 074757, 071122, 075757, 075717};
constexpr std::array<std::uint16_t, 26> kLetters{
    025755, 065656, 034443, 065556, 074647, 074644, 034553, 055755, 072227, 011152, 055655, 044447, 057755,
    065555, 025552, 065644, 025563, 065655, 034216, 072222, 055557, 055552, 055775, 055255, 055222, 071247};

std::uint16_t glyph(char c) {
  if (c >= '0' && c <= '9') return kDigits[c - '0'];
  if (c >= 'a' && c <= 'z') return kLetters[c - 'a'];
  if (c >= 'A' && c <= 'Z') return kLetters[c - 'A'];
  switch (c) {
    case '.': return 000002;
    case ',': return 000024;
    case ':': return 002020;
    case '-': return 000700;
    case '+': return 002720;
    case '=': return 007070;
    case '_': return 000007;
    case '/': return 011244;
    case '%': return 051245;
    case '(': return 012221;
    case ')': return 042224;
    case '<': return 012421;
    case '>': return 042124;
    case '#': return 057575;
    default: return 0;
  }
}

}  // namespace

void draw_text(Image8& image, int x, int y, std::string_view text, int scale,
               const std::array<std::uint8_t, 3>& colour) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    const std::uint16_t bits = glyph(text[k]);
    const int left = x + text_width(k, scale);
    for (int j = 0; j < kGlyphHeight * scale; ++j) {
      for (int i = 0; i < kGlyphWidth * scale; ++i) {
        const int bit = 14 - (j / scale) * kGlyphWidth - i / scale;
        const int px = left + i, py = y + j;
        if (!(bits >> bit & 1) || px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
        std::copy_n(colour.data(), std::min(image.channels, 3), image.at(px, py));
      }
    }
  }
}

}  // namespace farfield
