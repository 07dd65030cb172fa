// SPDX-License-Identifier: Apache-2.0
// A folder for frames on their way between processes, which goes away with the run.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "common/base/result.h"

namespace farfield::bench {

class ScratchFolder {
 public:
  /// Errors: kIo.
  static Result<ScratchFolder> create() {
    std::string name = (std::filesystem::temp_directory_path() / "farfield-bench-XXXXXX").string();
    if (!mkdtemp(name.data())) return fail(ErrorCode::kIo, "{}: cannot make a folder for frames", name);
    return ScratchFolder(name);
  }
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace farfield::bench
