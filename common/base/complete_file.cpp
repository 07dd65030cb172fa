// SPDX-License-Identifier: Apache-2.0
#include "common/base/complete_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

namespace farfield {

Result<CompleteFile> CompleteFile::create(const std::filesystem::path& path) {
  if (path.empty()) return fail(ErrorCode::kIo, "no file is named to write to; name one");
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status)) {
    return fail(ErrorCode::kIo, "{}: is a folder; name a file to write", path.string());
  }
  std::filesystem::path target = path, partial;
  const bool is_special = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  if (!is_special) {
    constexpr int kMostLinks = 40;  // as Linux follows them; also links to what is not there yet
    for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(target, ignored); ++i) {
      target = target.parent_path() / std::filesystem::read_symlink(target, ignored);
    }
    static std::atomic<unsigned> count{0};  // threads may write files of one name
    partial = target;
    partial += fmt::format(".partial-{}-{}", getpid(), count++);
  }
  std::FILE* file = std::fopen((is_special ? target : partial).c_str(), "wbe");
  if (!file) return fail(ErrorCode::kIo, "{}: cannot be written: {}", path.string(), std::strerror(errno));
  return CompleteFile(path, std::move(target), std::move(partial), file);
}

CompleteFile::CompleteFile(CompleteFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      partial_path_(std::move(other.partial_path_)),
      file_(std::exchange(other.file_, nullptr)),
      error_(other.error_) {}

CompleteFile::~CompleteFile() {
  if (!file_) return;
  std::fclose(file_);
  if (!partial_path_.empty()) unlink(partial_path_.c_str());
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
  if (error_ == 0 && !partial_path_.empty()) check(std::rename(partial_path_.c_str(), target_.c_str()) == 0);
  if (error_ != 0)
    return fail(ErrorCode::kIo, "{}: cannot be written: {}; nothing was left behind", path_.string(),
                std::strerror(error_));
  std::fclose(std::exchange(file_, nullptr));
  return {};
}

Status write_complete_file(const std::filesystem::path& path, ByteView bytes) {
  Result<CompleteFile> file = CompleteFile::create(path);
  if (!file) return tl::unexpected(file.error());
  file->write(bytes);
  return file->commit();
}

Status write_complete_file(const std::filesystem::path& path, std::string_view text) {
  return write_complete_file(path, ByteView(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

Status check_file_can_be_written(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  // Opening a pipe or a device is something others notice.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) && !std::filesystem::is_directory(status)) return {};
  const Result<CompleteFile> file = CompleteFile::create(path);
  if (!file) return tl::unexpected(file.error());
  return {};
}

}  // namespace farfield
