// SPDX-License-Identifier: Apache-2.0
// Material libraries from anywhere; the textures they name are missing.
#include <map>
#include <string>

#include "server/model/mtl_reader.h"
#include "tests/fuzz/usable_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  farfield::Model model;
  farfield::TextureCache textures(model, "no-such-folder");
  std::map<std::string, int> index_by_name;
  farfield::read_mtl({reinterpret_cast<const char*>(data), size}, model, textures, index_by_name);
  farfield::fuzz::require_usable(model, true);
  for (const auto& [name, index] : index_by_name) {
    farfield::fuzz::require(index >= 0 && index < static_cast<int>(model.materials.size()), "names mean materials");
  }
  return 0;
}
