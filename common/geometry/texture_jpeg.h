// SPDX-License-Identifier: Apache-2.0
// Colour of a texture level as a baseline JPEG, 4:4:4. libjpeg's long jumps stay behind this header.
#pragma once

#include <vector>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield {

/// `rgba`: 4 bytes per texel, the fourth is ignored. Returns: the JPEG, empty if the library failed (memory).
Bytes encode_texture_jpeg(ByteView rgba, int width, int height, int quality);

/// Fills `rgba` with width × height texels, the fourth byte 255. The size in the JPEG must be the one given, and
/// nothing is allocated before that is known. What the library calls a warning (cut or damaged data) is an error here.
/// Errors: kBadData.
Status decode_texture_jpeg(ByteView jpeg, int width, int height, std::vector<std::uint8_t>& rgba);

}  // namespace farfield
