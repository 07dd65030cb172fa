// SPDX-License-Identifier: Apache-2.0
// Seeds of the fuzz corpora: small valid inputs, made by the encoders themselves where there are any.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/bytes.h"

namespace farfield::fuzz {

struct Seed {
  std::string target;  // the folder: fuzz_<target>
  std::string name;
  Bytes bytes;
};
using Seeds = std::vector<Seed>;

inline Bytes bytes_of(std::string_view text) { return Bytes(text.begin(), text.end()); }
/// For targets whose first byte chooses.
inline Bytes chosen(std::uint8_t choice, const Bytes& rest) {
  ByteWriter writer;
  writer.put(choice);
  writer.put_bytes(rest);
  return writer.take();
}

void add_tile_seeds(Seeds& seeds);
void add_geometry_seeds(Seeds& seeds);
void add_wire_seeds(Seeds& seeds);
void add_model_seeds(Seeds& seeds);
void add_store_seeds(Seeds& seeds);

}  // namespace farfield::fuzz
