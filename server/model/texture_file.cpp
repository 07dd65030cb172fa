// SPDX-License-Identifier: Apache-2.0
#include "server/model/texture_file.h"

#include <algorithm>

#include "server/model/file_bytes.h"
#include "server/model/jpeg_texture.h"
#include "server/model/png_texture.h"
#include "server/model/tga_texture.h"

namespace farfield {

Result<TextureImage> decode_texture(ByteView bytes) {
  constexpr std::uint8_t kPng[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::uint8_t kJpeg[] = {0xff, 0xd8, 0xff};
  if (bytes.size() >= sizeof(kPng) && std::equal(std::begin(kPng), std::end(kPng), bytes.begin())) {
    return decode_png(bytes);
  }
  if (bytes.size() >= sizeof(kJpeg) && std::equal(std::begin(kJpeg), std::end(kJpeg), bytes.begin())) {
    return decode_jpeg(bytes);
  }
  if (looks_like_tga(bytes)) return decode_tga(bytes);  // last: TGA files have no mark of their own
  return fail(ErrorCode::kBadData, "neither PNG nor JPEG nor TGA; convert the image");
}

Result<TextureImage> read_texture_file(const std::filesystem::path& path) {
  const Result<Bytes> bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<TextureImage> image = decode_texture(*bytes);
  if (!image) return fail_within(path.string(), image.error());
  image->name = path.filename().string();
  return image;
}

}  // namespace farfield
