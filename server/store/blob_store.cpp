// SPDX-License-Identifier: Apache-2.0
#include "server/store/blob_store.h"

namespace farfield {

std::string BlobKey::bytes() const {
  ByteWriter out;
  out.bytes().reserve(32);
  out.put(world);
  out.put(static_cast<std::uint8_t>(kind));
  out.put(name.cell.level);
  out.put(name.cell.x), out.put(name.cell.y), out.put(name.cell.z);
  out.put(name.view), out.put(name.face), out.put(name.x), out.put(name.y);
  return {out.bytes().begin(), out.bytes().end()};
}

}  // namespace farfield
