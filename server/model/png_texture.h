// SPDX-License-Identifier: Apache-2.0
// The PNG half of texture_file.h.
#pragma once

#include "server/model/texture_file.h"

namespace farfield {

/// Errors: kBadData, kLimitExceeded.
Result<TextureImage> decode_png(ByteView file_bytes);

}  // namespace farfield
