// SPDX-License-Identifier: Apache-2.0
// A file that exists complete or not at all: written beside its place and renamed when everything is on disk.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

#include "common/base/bytes.h"
#include "common/base/result.h"

namespace farfield {

/// One thread. Unless commit() succeeds, the destructor removes what was written. A symbolic link stays one: the file
/// it names is replaced. What is no regular file (a device, a pipe) is never replaced but written as it comes.
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
  CompleteFile(std::filesystem::path path, std::filesystem::path target, std::filesystem::path partial_path,
               std::FILE* file)
      : path_(std::move(path)), target_(std::move(target)), partial_path_(std::move(partial_path)), file_(file) {}

  std::filesystem::path path_;          // as it was asked for, for messages
  std::filesystem::path target_;        // where links lead
  std::filesystem::path partial_path_;  // empty: `target_` is written directly
  std::FILE* file_ = nullptr;
  int error_ = 0;  // errno of the first failure
};

/// Errors: kIo. Nothing is left behind by a failure.
Status write_complete_file(const std::filesystem::path& path, ByteView bytes);
Status write_complete_file(const std::filesystem::path& path, std::string_view text);

/// Whether a file could be created there now: for saying so before the work, not after it. Errors: kIo.
Status check_file_can_be_written(const std::filesystem::path& path);

}  // namespace farfield
