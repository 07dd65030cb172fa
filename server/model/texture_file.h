// SPDX-License-Identifier: Apache-2.0
// PNG, JPEG and TGA files to textures, and textures to PNG. The kind is told by the bytes, never by a file's name.
//
// Thread-safe. Bytes may be anything: dimensions are checked before memory is taken, and images with an edge beyond
// kMaxTextureFileEdge are averaged down by a power of two, in linear light, while they are read.
#pragma once

#include <filesystem>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "server/model/model.h"

namespace farfield {

inline constexpr int kMaxTextureFileEdge = 8192;

/// Errors: kBadData (neither PNG nor JPEG nor TGA, or damaged), kLimitExceeded (an edge beyond 8 × kMaxTextureFileEdge, or an
/// interlaced PNG that would need averaging down).
Result<TextureImage> decode_texture(ByteView file_bytes);

/// The same from a file; the image takes the file's name. Errors: also kNotFound, kIo.
Result<TextureImage> read_texture_file(const std::filesystem::path& path);

/// 8-bit RGB, or RGBA where any texel is not opaque. Errors: kInvalidArgument (empty image), kInternal.
Result<Bytes> encode_png(const TextureImage& image);

}  // namespace farfield
