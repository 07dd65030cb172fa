// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ from anywhere.
#include "server/model/obj_reader.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/usable_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static farfield::fuzz::ScratchFile file("model.obj");
  const auto model = farfield::read_obj(file.with({data, size}));
  if (model) farfield::fuzz::require_usable(*model, true);
  return 0;
}
