// SPDX-License-Identifier: Apache-2.0
// A file that exists complete or not at all: written beside its place and renamed when everything is on disk.
#pragma once

#include <cstdio>
#include <filesystem>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield {

/// One thread. Unless commit() succeeds, the destructor removes what was written.
class CompleteFile {
 public:
  /// Errors: kIo.
  static Result<CompleteFile> create(const std::filesystem::path& path);
  CompleteFile(CompleteFile&& other) noexcept;
  CompleteFile& operator=(CompleteFile&&) = delete;
  ~CompleteFile();

  /// Failures are remembered and reported by commit().
  void write(ByteView bytes);
  /// Flushes to disk and takes the place of `path`. Errors: kIo.
  Status commit();

 private:
  CompleteFile(std::filesystem::path path, std::filesystem::path partial_path, std::FILE* file)
      : path_(std::move(path)), partial_path_(std::move(partial_path)), file_(file) {}

  std::filesystem::path path_, partial_path_;
  std::FILE* file_ = nullptr;
  int error_ = 0;  // errno of the first failure
};

}  // namespace farfield
