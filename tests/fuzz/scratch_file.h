// SPDX-License-Identifier: Apache-2.0
// A file for readers that take a path: its content is replaced for every input, its folder is removed at exit.
#pragma once

#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "common/base/bytes.h"
#include "tests/fuzz/require.h"

namespace farfield::fuzz {

class ScratchFile {
 public:
  explicit ScratchFile(const std::string& name) {
    std::string folder = (std::filesystem::temp_directory_path() / "farfield-fuzz-XXXXXX").string();
    require(mkdtemp(folder.data()) != nullptr, "the temporary folder can be written");
    folder_ = folder;
    path_ = folder_ / name;
  }
  ScratchFile(const ScratchFile&) = delete;
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Returns: the path of a file that now holds `bytes`.
  const std::filesystem::path& with(ByteView bytes) {
    std::FILE* file = std::fopen(path_.c_str(), "wb");
    require(file != nullptr, "the temporary file can be written");
    // An empty view may have no address at all, which fwrite must not be given.
    if (!bytes.empty()) {
      require(std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size(),
              "the bytes can be written");
    }
    require(std::fclose(file) == 0, "the temporary file can be closed");
    return path_;
  }

 private:
  std::filesystem::path folder_, path_;
};

}  // namespace farfield::fuzz
