// SPDX-License-Identifier: Apache-2.0
// Headers of model files from anywhere: what is checked before an importer is let near them. The first byte chooses
// the format.
#include <array>

#include "server/model/file_claims.h"
#include "tests/fuzz/scratch_file.h"

using farfield::fuzz::ScratchFile;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static std::array<ScratchFile, 6> files{ScratchFile("a.glb"), ScratchFile("a.gltf"), ScratchFile("a.ply"),
                                          ScratchFile("a.stl"), ScratchFile("a.off"),  ScratchFile("a.ifc")};
  if (size == 0) return 0;
  const auto& path = files[data[0] % files.size()].with({data + 1, size - 1});
  const auto format = farfield::find_model_format(path);
  if (format) (void)farfield::check_file_claims(path, *format);
  return 0;
}
