// SPDX-License-Identifier: Apache-2.0
// PNG files and bytes, 8 bits per channel, through libpng.
#pragma once

#include <string>

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/image/image.h"

namespace farfield {

/// Larger images are refused before anything is allocated.
inline constexpr int kMaxPngEdge = 32768;
inline constexpr std::size_t kMaxPngPixels = std::size_t{1} << 28;

/// Requires: 1, 3 or 4 channels. Errors: kInvalidArgument (no pixels), kInternal.
Result<Bytes> encode_png(const Image8& image);
/// Gives `channels` channels whatever the file has. Errors: kBadData, kLimitExceeded.
Result<Image8> decode_png(ByteView bytes, int channels = 3);

/// The file appears complete or not at all: it is written beside its place and renamed. Errors: kIo.
Status write_png(const std::string& path, const Image8& image);
/// Errors: kNotFound, kIo, kBadData, kLimitExceeded.
Result<Image8> read_png(const std::string& path, int channels = 3);

}  // namespace farfield
