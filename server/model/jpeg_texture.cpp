// SPDX-License-Identifier: Apache-2.0
// libjpeg reports errors by longjmp: see png_texture.cpp for how the objects are kept safe.
#include "server/model/jpeg_texture.h"

#include <cstdio>
// jpeglib.h needs FILE to be declared before it.
#include <jpeglib.h>

#include <csetjmp>
#include <optional>

#include "server/model/row_reducer.h"

namespace farfield {
namespace {

struct JpegReading {
  jpeg_error_mgr errors{};  // must stay first: libjpeg hands back a pointer to it
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX] = {};
  Bytes row;
  std::optional<RowReducer> reducer;
};

void on_error(j_common_ptr info) {
  auto* state = reinterpret_cast<JpegReading*>(info->err);
  info->err->format_message(info, state->message);
  std::longjmp(state->jump, 1);
}

void on_message(j_common_ptr, int) {}

void reserve_rows(JpegReading& state, int width, int height) {
  state.row.resize(static_cast<std::size_t>(width) * 4);
  state.reducer.emplace(width, height, reduction_factor(std::max(width, height), kMaxTextureFileEdge));
}

/// Returns: false with state.message set if libjpeg gave up.
bool read_jpeg(jpeg_decompress_struct& info, JpegReading& state, ByteView bytes) {
  if (setjmp(state.jump)) return false;
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  // JPEG edges are at most 65535 = less than 8 × kMaxTextureFileEdge: the reducer handles all of them row by row. A
  // progressive file needs all its coefficients in memory, though; refuse those that would take over a gigabyte.
  if (jpeg_has_multiple_scans(&info)) {
    const double coefficient_bytes = 2.0 * info.num_components * info.image_width * info.image_height;
    if (coefficient_bytes > 1e9) {
      std::snprintf(state.message, sizeof(state.message), "progressive and over 1 GB in memory; save it smaller");
      return false;
    }
  }
  info.out_color_space = JCS_EXT_RGBA;
  jpeg_start_decompress(&info);
  reserve_rows(state, static_cast<int>(info.output_width), static_cast<int>(info.output_height));
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = state.row.data();
    jpeg_read_scanlines(&info, &row, 1);
    state.reducer->add_row(state.row.data());
  }
  jpeg_finish_decompress(&info);
  return true;
}

}  // namespace

Result<TextureImage> decode_jpeg(ByteView file_bytes) {
  JpegReading state;
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&state.errors);
  state.errors.error_exit = &on_error;
  state.errors.emit_message = &on_message;
  const bool is_read = read_jpeg(info, state, file_bytes);
  jpeg_destroy_decompress(&info);
  if (!is_read) return fail(ErrorCode::kBadData, "JPEG cannot be read: {}", state.message);
  return state.reducer->take();
}

}  // namespace farfield
