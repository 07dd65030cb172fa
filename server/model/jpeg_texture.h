// SPDX-License-Identifier: Apache-2.0
// The JPEG half of texture_file.h.
#pragma once

#include "server/model/texture_file.h"

namespace farfield {

/// Errors: kBadData, kLimitExceeded.
Result<TextureImage> decode_jpeg(ByteView file_bytes);

}  // namespace farfield
