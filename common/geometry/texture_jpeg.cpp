// SPDX-License-Identifier: Apache-2.0
// Differs from the library's default: errors and warnings jump back to the caller instead of ending the program. No
// object with a destructor lives in a function that is jumped out of.
#include "common/geometry/texture_jpeg.h"

#include <jpeglib.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

namespace farfield {
namespace {

struct JumpingErrors {
  jpeg_error_mgr manager;  // first: libjpeg knows only this part
  std::jmp_buf back;
  char text[JMSG_LENGTH_MAX];
};

void jump_back(j_common_ptr info) {
  auto* errors = reinterpret_cast<JumpingErrors*>(info->err);
  errors->manager.format_message(info, errors->text);
  std::longjmp(errors->back, 1);
}

void warn_or_trace(j_common_ptr info, int level) {
  if (level < 0) jump_back(info);  // -1 is a warning: the picture would be wrong
}

jpeg_error_mgr* install(JumpingErrors& errors) {
  jpeg_error_mgr* manager = jpeg_std_error(&errors.manager);
  manager->error_exit = jump_back;
  manager->emit_message = warn_or_trace;
  errors.text[0] = '\0';
  return manager;
}

struct Compressed {
  unsigned char* data = nullptr;  // from malloc
  unsigned long size = 0;
};

bool compress(const std::uint8_t* rgba, int width, int height, int quality, Compressed& out) {
  jpeg_compress_struct info;
  JumpingErrors errors;
  info.err = install(errors);
  jpeg_create_compress(&info);
  if (setjmp(errors.back)) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_mem_dest(&info, &out.data, &out.size);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = 4;
  info.in_color_space = JCS_EXT_RGBX;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  for (int c = 0; c < info.num_components; ++c) info.comp_info[c].h_samp_factor = info.comp_info[c].v_samp_factor = 1;
  info.optimize_coding = TRUE;
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = const_cast<JSAMPROW>(rgba + std::size_t{4} * info.next_scanline * info.image_width);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

// Decodes in two calls so that the caller can allocate between them, outside the reach of the jumps.
struct Decompression {
  jpeg_decompress_struct info;
  JumpingErrors errors;
};

bool read_header(Decompression& job, ByteView jpeg) {
  if (setjmp(job.errors.back)) return false;
  jpeg_mem_src(&job.info, jpeg.data(), jpeg.size());
  jpeg_read_header(&job.info, TRUE);
  return true;
}

bool read_rows(Decompression& job, std::uint8_t* rgba) {
  if (setjmp(job.errors.back)) return false;
  job.info.out_color_space = JCS_EXT_RGBA;
  jpeg_start_decompress(&job.info);
  while (job.info.output_scanline < job.info.output_height) {
    JSAMPROW row = rgba + std::size_t{4} * job.info.output_scanline * job.info.output_width;
    jpeg_read_scanlines(&job.info, &row, 1);
  }
  jpeg_finish_decompress(&job.info);
  return true;
}

}  // namespace

Bytes encode_texture_jpeg(ByteView rgba, int width, int height, int quality) {
  Compressed out;
  Bytes bytes;
  if (compress(rgba.data(), width, height, quality, out)) bytes.assign(out.data, out.data + out.size);
  std::free(out.data);
  return bytes;
}

Status decode_texture_jpeg(ByteView jpeg, int width, int height, std::vector<std::uint8_t>& rgba) {
  if (jpeg.empty()) return fail(ErrorCode::kBadData, "JPEG: no bytes");
  Decompression job;
  job.info.err = install(job.errors);
  jpeg_create_decompress(&job.info);
  const auto finish = [&](Status status) {
    jpeg_destroy_decompress(&job.info);
    return status;
  };
  const auto damaged = [&] { return finish(fail(ErrorCode::kBadData, "JPEG: {}", job.errors.text)); };
  if (!read_header(job, jpeg)) return damaged();
  if (job.info.image_width != static_cast<JDIMENSION>(width) ||
      job.info.image_height != static_cast<JDIMENSION>(height))
    return finish(fail(ErrorCode::kBadData, "JPEG: {}×{} pixels, the header before it says {}×{}", job.info.image_width,
                       job.info.image_height, width, height));
  // Many scans over one picture would cost time out of proportion to their bytes.
  if (job.info.num_components != 3 || jpeg_has_multiple_scans(&job.info))
    return finish(fail(ErrorCode::kBadData, "JPEG: not a colour picture in one scan"));
  rgba.resize(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (!read_rows(job, rgba.data())) return damaged();
  return finish({});
}

}  // namespace farfield
