// SPDX-License-Identifier: Apache-2.0
#include "client/decode/payload.h"

#include <atomic>

namespace farfield::client {

const char* payload_kind_name(PayloadKind kind) {
  switch (kind) {
    case PayloadKind::kTile: return "tile";
    case PayloadKind::kChunk: return "chunk";
    case PayloadKind::kTextureLevel: return "texture level";
  }
  return "payload";
}

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

}  // namespace farfield::client
