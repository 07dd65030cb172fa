// SPDX-License-Identifier: Apache-2.0
// What an import process hands over: it read a file from anywhere, so it is not trusted either. After the reader the
// model is cleaned, as load_model() does.
#include "server/model/clean_model.h"
#include "server/model/model_stream.h"
#include "tests/fuzz/usable_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto model = farfield::read_model_stream({data, size});
  if (!model) return 0;
  farfield::fuzz::require_usable(*model, false);
  farfield::clean_model(*model);
  farfield::fuzz::require_usable(*model, true);
  return 0;
}
