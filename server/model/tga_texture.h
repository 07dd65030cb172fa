// SPDX-License-Identifier: Apache-2.0
// The TGA part of texture_file.h: true colour, grey and colour-mapped, plain or run-length encoded.
#pragma once

#include "server/model/texture_file.h"

namespace farfield {

/// Whether the header is one of a TGA image that decode_tga() knows; the format has no signature.
bool looks_like_tga(ByteView file_bytes);

/// An alpha channel that is zero everywhere is taken for an unused one. Errors: kBadData.
Result<TextureImage> decode_tga(ByteView file_bytes);

}  // namespace farfield
