// SPDX-License-Identifier: Apache-2.0
// libpng reports errors by longjmp. Every object with a destructor therefore lives in a struct outside the function
// that calls setjmp, and the functions that may be jumped over hold plain values only.
#include "server/model/png_texture.h"

#include <png.h>

#include <csetjmp>
#include <cstring>
#include <optional>

#include "server/model/row_reducer.h"

namespace farfield {
namespace {

struct PngReading {
  ByteReader bytes;
  std::string error;
  bool is_limit = false;
  Bytes row;
  Bytes whole;  // interlaced images only: all rows, since passes revisit them
  std::vector<png_bytep> rows;
  std::optional<RowReducer> reducer;
};

void on_read_error(png_structp png, png_const_charp message) {
  static_cast<PngReading*>(png_get_error_ptr(png))->error = message;
  longjmp(png_jmpbuf(png), 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep target, png_size_t size) {
  const ByteView view = static_cast<PngReading*>(png_get_io_ptr(png))->bytes.get_bytes(size);
  if (view.size() != size) png_error(png, "the file ends early");
  std::memcpy(target, view.data(), size);
}

void request_rgba8(png_structp png, png_infop info) {
  png_set_scale_16(png);
  png_set_expand(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xff, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
}

void read_rows(png_structp png, PngReading& state, int height, bool is_interlaced) {
  if (!is_interlaced) {
    for (int y = 0; y < height; ++y) {
      png_read_row(png, state.row.data(), nullptr);
      state.reducer->add_row(state.row.data());
    }
    return;
  }
  png_read_image(png, state.rows.data());
  for (int y = 0; y < height; ++y) state.reducer->add_row(state.rows[static_cast<std::size_t>(y)]);
}

void reserve_rows(PngReading& state, int width, int height, int factor, bool is_interlaced) {
  const std::size_t row_bytes = static_cast<std::size_t>(width) * 4;
  state.reducer.emplace(width, height, factor);
  state.row.resize(row_bytes);
  if (!is_interlaced) return;
  state.whole.resize(row_bytes * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) state.rows.push_back(state.whole.data() + row_bytes * static_cast<std::size_t>(y));
}

void read_png(png_structp png, png_infop info, PngReading& state) {
  if (setjmp(png_jmpbuf(png))) return;
  png_set_user_limits(png, 8 * kMaxTextureFileEdge, 8 * kMaxTextureFileEdge);
  png_set_read_fn(png, &state, &read_bytes);
  png_read_info(png, info);
  const int width = static_cast<int>(png_get_image_width(png, info));
  const int height = static_cast<int>(png_get_image_height(png, info));
  const bool is_interlaced = png_get_interlace_type(png, info) != PNG_INTERLACE_NONE;
  const int factor = reduction_factor(std::max(width, height), kMaxTextureFileEdge);
  if (is_interlaced && factor > 1) {
    state.is_limit = true;
    png_error(png, "interlaced and larger than 8192 texels; save it without interlacing");
  }
  request_rgba8(png, info);
  reserve_rows(state, width, height, factor, is_interlaced);
  read_rows(png, state, height, is_interlaced);
}

struct PngWriting {
  Bytes bytes;
  Bytes rgb_row;
  std::string error;
};

void on_write_error(png_structp png, png_const_charp message) {
  static_cast<PngWriting*>(png_get_error_ptr(png))->error = message;
  longjmp(png_jmpbuf(png), 1);
}

void write_bytes(png_structp png, png_bytep data, png_size_t size) {
  Bytes& bytes = static_cast<PngWriting*>(png_get_io_ptr(png))->bytes;
  bytes.insert(bytes.end(), data, data + size);
}

void write_png(png_structp png, png_infop info, PngWriting& state, const TextureImage& image, bool has_alpha) {
  if (setjmp(png_jmpbuf(png))) return;
  png_set_write_fn(png, &state, &write_bytes, nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 8,
               has_alpha ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row =
        image.rgba.data() + std::size_t{4} * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(y);
    if (!has_alpha) {
      for (int x = 0; x < image.width; ++x) std::memcpy(state.rgb_row.data() + 3 * x, row + 4 * x, 3);
      row = state.rgb_row.data();
    }
    png_write_row(png, row);
  }
  png_write_end(png, info);
}

}  // namespace

Result<TextureImage> decode_png(ByteView file_bytes) {
  PngReading state{ByteReader(file_bytes)};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &state, &on_read_error, &on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info) read_png(png, info, state);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!state.error.empty()) {
    return fail(state.is_limit ? ErrorCode::kLimitExceeded : ErrorCode::kBadData, "PNG cannot be read: {}",
                state.error);
  }
  if (!state.reducer) return fail(ErrorCode::kInternal, "libpng could not start");
  return state.reducer->take();
}

Result<Bytes> encode_png(const TextureImage& image) {
  const std::size_t texels =
      static_cast<std::size_t>(std::max(image.width, 0)) * static_cast<std::size_t>(std::max(image.height, 0));
  if (texels == 0 || image.rgba.size() != 4 * texels)
    return fail(ErrorCode::kInvalidArgument, "texture '{}' is empty", image.name);
  bool has_alpha = false;
  for (std::size_t i = 0; i < texels && !has_alpha; ++i) has_alpha = image.rgba[4 * i + 3] != 255;
  PngWriting state;
  state.rgb_row.resize(static_cast<std::size_t>(image.width) * 3);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &state, &on_write_error, &on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (info) write_png(png, info, state, image, has_alpha);
  png_destroy_write_struct(&png, &info);
  if (!state.error.empty()) return fail(ErrorCode::kInternal, "PNG cannot be written: {}", state.error);
  if (state.bytes.empty()) return fail(ErrorCode::kInternal, "libpng could not start");
  return std::move(state.bytes);
}

}  // namespace farfield
