// SPDX-License-Identifier: Apache-2.0
#include "common/base/hash.h"

#include <xxhash.h>

namespace farfield {

ContentHash hash_bytes(ByteView bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

}  // namespace farfield
