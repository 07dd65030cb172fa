// SPDX-License-Identifier: Apache-2.0
#include "server/model/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

namespace farfield {

Result<Bytes> read_file_start(const std::filesystem::path& path, std::size_t count) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return fail(ErrorCode::kNotFound, "{}: no such file; check the path", path.string());
  }
  if (!std::filesystem::is_regular_file(status)) {
    return fail(ErrorCode::kBadData, "{}: not a file; name a model file, not a folder or device", path.string());
  }
  const auto size = std::filesystem::file_size(path, error);
  if (error) return fail(ErrorCode::kIo, "{}: cannot be examined: {}", path.string(), error.message());
  if (size == 0) return fail(ErrorCode::kBadData, "{}: the file is empty; copy it again", path.string());

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), &std::fclose);
  if (!file) return fail(ErrorCode::kIo, "{}: cannot be opened: {}", path.string(), std::strerror(errno));
  Bytes bytes(static_cast<std::size_t>(std::min<std::uintmax_t>(size, count)));
  const std::size_t read = std::fread(bytes.data(), 1, bytes.size(), file.get());
  if (read != bytes.size()) {
    return fail(ErrorCode::kIo, "{}: reading stopped after {} of {} bytes", path.string(), read, bytes.size());
  }
  return bytes;
}

Result<Bytes> read_file_bytes(const std::filesystem::path& path) {
  return read_file_start(path, std::numeric_limits<std::size_t>::max());
}

}  // namespace farfield
