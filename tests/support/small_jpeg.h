// SPDX-License-Identifier: Apache-2.0
// JPEG files for tests of what reads them: nothing in Farfield writes any.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstdlib>
// jpeglib.h needs FILE to be declared before it.
#include <jpeglib.h>

#include <span>

#include "common/base/bytes.h"

namespace farfield::test {

/// `rgba`: width × height × 4, of which the fourth is left out. As the library writes it: its errors end the program.
inline Bytes small_jpeg(std::span<const std::uint8_t> rgba, int width, int height, int quality) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &data, &size);
  info.image_width = static_cast<JDIMENSION>(width), info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = 4, info.in_color_space = JCS_EXT_RGBX;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(&rgba[std::size_t{4} * info.next_scanline * info.image_width]);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const Bytes bytes(data, data + size);
  std::free(data);
  return bytes;
}

}  // namespace farfield::test
