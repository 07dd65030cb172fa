// SPDX-License-Identifier: Apache-2.0
// CityJSON and CityJSON text sequences from anywhere.
#include "server/model/city_json_reader.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/usable_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static farfield::fuzz::ScratchFile file("model.city.json");
  const auto model = farfield::read_city_json(file.with({data, size}));
  if (model) farfield::fuzz::require_usable(*model, true);
  return 0;
}
