// SPDX-License-Identifier: Apache-2.0
#include "client/warp/wide_splats.h"

#include "client/warp/splat_pixel.h"

namespace farfield::client {

void WideSplats::draw(decltype(&sample_pixels) sample, int width, SplatPixels& pixels, RowIndices& hits,
                      std::uint64_t* keys) {
  for (int pixel = 1; pixel < 4; ++pixel) {
    sample(row_, samples_, width, pixel & 1, pixel >> 1, pixels);
    write_pixels(pixels, samples_.count, hits, keys);
  }
  for (int i = 0; i < samples_.count; ++i) {
    if (row_.right[i] > row_.left[i] + 1 || row_.bottom[i] > row_.top[i] + 1) write_beyond_four(i, width, keys);
  }
  samples_.count = 0;
}

void WideSplats::write_beyond_four(int i, int width, std::uint64_t* keys) const {
  for (int line = row_.top[i]; line <= row_.bottom[i]; ++line) {
    std::uint64_t* cells = keys + static_cast<std::size_t>(line) * width;
    for (int column = row_.left[i] + (line < row_.top[i] + 2 ? 2 : 0); column <= row_.right[i]; ++column) {
      const SplatPixel pixel = splat_pixel(row_, samples_, i, column, line);
      if (pixel.is_inside) keep_larger(cells[column], make_key(pixel.high, pixel.low));
    }
  }
}

}  // namespace farfield::client
