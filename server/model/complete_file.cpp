// SPDX-License-Identifier: Apache-2.0
#include "server/model/complete_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace farfield {

Result<CompleteFile> CompleteFile::create(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return fail(ErrorCode::kIo, "{}: is a folder; name a file to write", path.string());
  }
  std::filesystem::path partial = path;
  partial += fmt::format(".partial-{}", getpid());
  std::FILE* file = std::fopen(partial.c_str(), "wbe");
  if (!file) return fail(ErrorCode::kIo, "{}: cannot be written: {}", path.string(), std::strerror(errno));
  return CompleteFile(path, std::move(partial), file);
}

CompleteFile::CompleteFile(CompleteFile&& other) noexcept
    : path_(std::move(other.path_)),
      partial_path_(std::move(other.partial_path_)),
      file_(std::exchange(other.file_, nullptr)),
      error_(other.error_) {}

CompleteFile::~CompleteFile() {
  if (!file_) return;
  std::fclose(file_);
  unlink(partial_path_.c_str());
}

void CompleteFile::write(ByteView bytes) {
  if (error_ != 0 || bytes.empty()) return;
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) error_ = errno != 0 ? errno : EIO;
}

Status CompleteFile::commit() {
  const auto check = [this](bool is_done) {
    if (!is_done && error_ == 0) error_ = errno;
  };
  check(std::fflush(file_) == 0);
  check(fsync(fileno(file_)) == 0 || errno == EINVAL);  // EINVAL: a file system that cannot, such as a pipe's
  if (error_ == 0) check(std::rename(partial_path_.c_str(), path_.c_str()) == 0);
  if (error_ != 0)
    return fail(ErrorCode::kIo, "{}: cannot be written: {}; nothing was left behind", path_.string(),
                std::strerror(error_));
  std::fclose(std::exchange(file_, nullptr));
  return {};
}

}  // namespace farfield
