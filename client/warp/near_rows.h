// SPDX-License-Identifier: Apache-2.0
// What draws near geometry into the key buffer, rows of it at a time, before any splat is there.
#pragma once

#include <cstdint>

#include "common/math/camera.h"

namespace farfield::client {

class NearRows {
 public:
  virtual ~NearRows() = default;
  /// Overwrites rows [first_row, last_row) of `keys`, the whole buffer of `pixels`, with near_key() or kNoSplat. Any number of
  /// threads, each on rows of its own.
  virtual void draw_rows(const Display& pixels, int first_row, int last_row, std::uint64_t* keys) const = 0;
};

}  // namespace farfield::client
