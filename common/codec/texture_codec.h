// SPDX-License-Identifier: Apache-2.0
// Levels of textures on their way to the client: the tiles' colour codec, since JPEG rounds colour differences to whole
// codes, which tints smooth walls by half a code, and takes more bytes.
#pragma once

#include "common/base/bytes.h"
#include "common/base/result.h"
#include "common/geometry/chunk.h"

namespace farfield {

/// Colours as colour_codec.h codes them, lossless under 16 texels; alpha, where any texel is not opaque, lossless. Format:
/// see texture_codec.cpp. Deterministic.
/// Requires: 1 <= width, height <= kMaxTextureEdge, rgba.size() == 4·width·height, level < level_count <= 255.
Bytes encode_texture_level(const TextureLevel& level);
/// Errors: kBadData, kVersionMismatch, kLimitExceeded (an edge beyond kMaxTextureEdge).
Result<TextureLevel> decode_texture_level(ByteView bytes);

}  // namespace farfield
