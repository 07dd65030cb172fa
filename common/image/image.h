// SPDX-License-Identifier: Apache-2.0
// Images in memory: [row][column][channel], top row first, without padding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace farfield {

template <class T>
struct Image {
  int width = 0, height = 0;
  int channels = 3;  // 1 grey, 3 RGB, 4 RGBA
  std::vector<T> values;

  Image() = default;
  Image(int w, int h, int c, T fill = T{})
      : width(w), height(h), channels(c), values(static_cast<std::size_t>(w) * h * c, fill) {}

  std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
  T* at(int x, int y) { return values.data() + (static_cast<std::size_t>(y) * width + x) * channels; }
  const T* at(int x, int y) const { return values.data() + (static_cast<std::size_t>(y) * width + x) * channels; }
  bool same_size(const Image& other) const { return width == other.width && height == other.height; }
};

using Image8 = Image<std::uint8_t>;  // sRGB
using ImageF = Image<float>;         // what the user of one says

}  // namespace farfield
