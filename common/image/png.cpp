// SPDX-License-Identifier: Apache-2.0
#include "common/image/png.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "common/base/complete_file.h"

namespace farfield {
namespace {

png_uint_32 png_format(int channels) {
  return channels == 1 ? PNG_FORMAT_GRAY : (channels == 4 ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB);
}

png_image begin_image() {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  return image;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace

Result<Bytes> encode_png(const Image8& image) {
  if (image.width <= 0 || image.height <= 0 || image.values.size() != image.pixels() * image.channels) {
    return fail(ErrorCode::kInvalidArgument, "an image of {} x {} pixels cannot be a PNG", image.width, image.height);
  }
  png_image header = begin_image();
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = png_format(image.channels);
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  Bytes bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, image.values.data(), 0, nullptr)) {
    return fail(ErrorCode::kInternal, "PNG encoding failed: {}", header.message);
  }
  bytes.resize(size);
  return bytes;
}

Result<Image8> decode_png(ByteView bytes, int channels) {
  png_image header = begin_image();
  if (!png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) {
    return fail(ErrorCode::kBadData, "not a PNG image: {}", header.message);
  }
  if (header.width > kMaxPngEdge || header.height > kMaxPngEdge ||
      static_cast<std::size_t>(header.width) * header.height > kMaxPngPixels) {
    const auto width = header.width, height = header.height;
    png_image_free(&header);
    return fail(ErrorCode::kLimitExceeded, "a PNG image of {} x {} pixels is larger than allowed", width, height);
  }
  header.format = png_format(channels);
  Image8 image(static_cast<int>(header.width), static_cast<int>(header.height), channels);
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&header, &black, image.values.data(), 0, nullptr)) {
    return fail(ErrorCode::kBadData, "damaged PNG image: {}", header.message);
  }
  return image;
}

Status write_png(const std::string& path, const Image8& image) {
  const Result<Bytes> bytes = encode_png(image);
  if (!bytes) return fail_within(path, bytes.error());
  return write_complete_file(path, *bytes);
}

Result<Image8> read_png(const std::string& path, int channels) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    const bool missing = errno == ENOENT;
    return fail(missing ? ErrorCode::kNotFound : ErrorCode::kIo, "{}: {}", path, std::strerror(errno));
  }
  Bytes bytes;
  std::uint8_t piece[65536];
  while (const std::size_t got = std::fread(piece, 1, sizeof(piece), file.get())) {
    bytes.insert(bytes.end(), piece, piece + got);
  }
  if (std::ferror(file.get())) return fail(ErrorCode::kIo, "{}: cannot read it: {}", path, std::strerror(errno));
  Result<Image8> image = decode_png(bytes, channels);
  if (!image) return fail_within(path, image.error());
  return image;
}

}  // namespace farfield
