// SPDX-License-Identifier: Apache-2.0
#include "server/model/source_files.h"

#include <sys/stat.h>

#include <fstream>
#include <set>

namespace farfield {
namespace {

// File systems stamp files with a clock that ticks up to every 10 ms; network ones with that of another machine.
constexpr std::chrono::milliseconds kClockStep{20};

std::int64_t nanoseconds(const timespec& time) { return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; }

/// All but the content.
SourceFile stamp(const std::string& path) {
  SourceFile file;
  file.path = path;
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return file;
  file.exists = true;
  file.size_bytes = static_cast<std::uint64_t>(status.st_size);
  file.device = status.st_dev, file.inode = status.st_ino;
  file.modified_ns = nanoseconds(status.st_mtim), file.changed_ns = nanoseconds(status.st_ctim);
  return file;
}

/// Files are larger than memory may be: in blocks. Errors: kIo.
Result<ContentHash> hash_file(const std::string& path) {
  constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  std::ifstream in(path, std::ios::binary);
  Bytes block(kBlockBytes);
  ContentHash hash = 0;
  while (in) {
    in.read(reinterpret_cast<char*>(block.data()), static_cast<std::streamsize>(block.size()));
    hash = hash_bytes({block.data(), static_cast<std::size_t>(in.gcount())}, hash);
  }
  if (!in.eof()) return fail(ErrorCode::kIo, "{}: cannot be read", path);
  return hash;
}

bool has_same_stamp(const SourceFile& a, const SourceFile& b) {
  return a.device == b.device && a.inode == b.inode && a.modified_ns == b.modified_ns && a.changed_ns == b.changed_ns;
}

}  // namespace

Result<std::vector<SourceFile>> describe_sources(const std::vector<std::string>& names, std::chrono::system_clock::time_point since) {
  std::set<std::string> paths;
  for (const std::string& name : names) paths.insert(std::filesystem::absolute(name).lexically_normal().string());
  const std::int64_t settled_ns = std::chrono::duration_cast<std::chrono::nanoseconds>((since - kClockStep).time_since_epoch()).count();
  std::vector<SourceFile> sources;
  for (const std::string& path : paths) {
    SourceFile file = stamp(path);
    if (file.exists) {
      if (file.changed_ns >= settled_ns) {
        return fail(ErrorCode::kUnavailable, "{}: was being written while it was read", path);
      }
      const Result<ContentHash> content = hash_file(path);
      if (!content) return tl::unexpected(content.error());
      file.content = *content;
      if (!has_same_stamp(file, stamp(path))) return fail(ErrorCode::kUnavailable, "{}: was being written while it was read", path);
    }
    sources.push_back(std::move(file));
  }
  return sources;
}

std::string find_changed(const std::vector<SourceFile>& sources) {
  for (const SourceFile& source : sources) {
    const SourceFile now = stamp(source.path);
    if (now.exists != source.exists || now.size_bytes != source.size_bytes) return source.path;
    if (!now.exists || has_same_stamp(now, source)) continue;
    const Result<ContentHash> content = hash_file(source.path);
    if (!content || *content != source.content) return source.path;
  }
  return {};
}

void write_sources(const std::vector<SourceFile>& sources, MemoryImageWriter& out) {
  out.put<std::uint64_t>(sources.size());
  for (const SourceFile& source : sources) {
    out.put_text(source.path);
    out.put<std::uint8_t>(source.exists);
    for (const std::uint64_t value : {source.size_bytes, source.device, source.inode, source.content}) out.put(value);
    for (const std::int64_t value : {source.modified_ns, source.changed_ns}) out.put(value);
  }
}

std::vector<SourceFile> read_sources(MemoryImageReader& in) {
  constexpr std::size_t kLeast = 8 + 1 + 6 * 8;
  std::vector<SourceFile> sources;
  for (std::size_t left = in.get_count(kLeast); left > 0 && in.is_valid(); --left) {
    SourceFile& source = sources.emplace_back();
    source.path = in.get_text();
    source.exists = in.get<std::uint8_t>() != 0;
    for (std::uint64_t* value : {&source.size_bytes, &source.device, &source.inode, &source.content}) *value = in.get<std::uint64_t>();
    for (std::int64_t* value : {&source.modified_ns, &source.changed_ns}) *value = in.get<std::int64_t>();
  }
  return sources;
}

}  // namespace farfield
