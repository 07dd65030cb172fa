// SPDX-License-Identifier: Apache-2.0
// Based on: abbreviated JPEG streams (ITU-T T.81 annex B.4, B.5): a tile of two kilobytes need not repeat 600 bytes of
// tables.
#include "tests/bench/baselines/jpeg_image.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace farfield {
namespace {

// libjpeg reports through callbacks that must not return; the jump stays inside this file and crosses no destructor.
struct ErrorTrap {
  jpeg_error_mgr manager;
  std::jmp_buf jump;
  char message[JMSG_LENGTH_MAX] = {};
};

void on_error(j_common_ptr info) {
  auto* trap = reinterpret_cast<ErrorTrap*>(info->err);
  info->err->format_message(info, trap->message);
  std::longjmp(trap->jump, 1);
}
void on_message(j_common_ptr info, int level) {
  if (level < 0) on_error(info);  // a warning: corrupt data that libjpeg would paper over
}

jpeg_error_mgr* install(ErrorTrap& trap) {
  jpeg_std_error(&trap.manager);
  trap.manager.error_exit = on_error;
  trap.manager.emit_message = on_message;
  return &trap.manager;
}

void configure(jpeg_compress_struct& jpeg, int width, int height, int quality) {
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  for (int c = 0; c < 3; ++c) jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
  // T.81 annex D: adapts to each tile without a table, where the standard Huffman tables fit none.
  jpeg.arith_code = TRUE;
}

struct CBuffer {  // malloc'ed by libjpeg; freed by its owner outside every jump
  unsigned char* data = nullptr;
  unsigned long size = 0;
  ~CBuffer() { std::free(data); }
};

bool compress(ErrorTrap& trap, const std::uint8_t* rgb, int width, int height, int quality, bool tables_only, CBuffer& out) {
  jpeg_compress_struct jpeg{};
  jpeg.err = install(trap);
  if (setjmp(trap.jump)) {
    jpeg_destroy_compress(&jpeg);
    return false;
  }
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &out.data, &out.size);
  configure(jpeg, width, height, quality);
  if (tables_only) {
    jpeg_write_tables(&jpeg);
  } else {
    jpeg_suppress_tables(&jpeg, TRUE);
    jpeg.write_JFIF_header = FALSE;
    jpeg_start_compress(&jpeg, FALSE);
    while (jpeg.next_scanline < jpeg.image_height) {
      JSAMPROW row = const_cast<JSAMPROW>(rgb + std::size_t{3} * width * jpeg.next_scanline);
      jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
  }
  jpeg_destroy_compress(&jpeg);
  return true;
}

bool decompress(ErrorTrap& trap, const CBuffer& tables, ByteView bytes, int width, int height, std::uint8_t* rgb,
                bool& wrong_size) {
  jpeg_decompress_struct jpeg{};
  jpeg.err = install(trap);
  if (setjmp(trap.jump)) {
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, tables.data, tables.size);
  jpeg_read_header(&jpeg, FALSE);
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  wrong_size = static_cast<int>(jpeg.image_width) != width || static_cast<int>(jpeg.image_height) != height ||
               jpeg.num_components != 3 || jpeg.progressive_mode;
  if (!wrong_size) {
    // Without the JFIF marker libjpeg would guess the colour space from component ids: it is always YCbCr here.
    jpeg.jpeg_color_space = JCS_YCbCr;
    jpeg.out_color_space = JCS_RGB;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height) {
      JSAMPROW row = rgb + std::size_t{3} * width * jpeg.output_scanline;
      jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
  }
  jpeg_destroy_decompress(&jpeg);
  return true;
}

}  // namespace

Result<Bytes> encode_jpeg(ByteView rgb, int width, int height, int quality) {
  ErrorTrap trap;
  CBuffer out;
  if (!compress(trap, rgb.data(), width, height, quality, false, out))
    return fail(ErrorCode::kInternal, "a {}×{} image: JPEG encoder: {}", width, height, trap.message);
  return Bytes(out.data, out.data + out.size);
}

Result<std::vector<std::uint8_t>> decode_jpeg(ByteView bytes, int width, int height, int quality) {
  if (quality < 1 || quality > 100) return fail(ErrorCode::kBadData, "image: quality {} is not in 1…100", quality);
  if (bytes.empty()) return fail(ErrorCode::kBadData, "image: no bytes");
  ErrorTrap trap;
  CBuffer tables;
  if (!compress(trap, nullptr, 8, 8, quality, true, tables))
    return fail(ErrorCode::kInternal, "image: JPEG tables: {}", trap.message);
  std::vector<std::uint8_t> rgb(std::size_t{3} * width * height);
  bool wrong_size = false;
  if (!decompress(trap, tables, bytes, width, height, rgb.data(), wrong_size))
    return fail(ErrorCode::kBadData, "image: not a whole JPEG: {}", trap.message);
  if (wrong_size) return fail(ErrorCode::kBadData, "image: the JPEG is not a {}×{} colour image", width, height);
  return rgb;
}

}  // namespace farfield
