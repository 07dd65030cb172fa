// SPDX-License-Identifier: Apache-2.0
// The colours of other impostors as JPEG 4:4:4 without its tables, which encoder and decoder both derive from the quality.
#pragma once

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield {

/// Requires: 1 <= quality <= 100, rgb holds 3·width·height bytes.
Result<Bytes> encode_jpeg(ByteView rgb, int width, int height, int quality);
/// Errors: kBadData if the stream is not a whole JPEG of exactly this size; warnings count as errors.
Result<std::vector<std::uint8_t>> decode_jpeg(ByteView bytes, int width, int height, int quality);

}  // namespace farfield
