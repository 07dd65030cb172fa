// SPDX-License-Identifier: Apache-2.0
// Whether the files a model was read from are still the same: what anything kept from it depends on.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/base/memory_image.h"
#include "common/base/result.h"

namespace farfield {

/// A file as it was, or the fact that there was none.
struct SourceFile {
  std::string path;  // absolute
  bool exists = false;
  std::uint64_t size_bytes = 0, device = 0, inode = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;  // Unix time; the latter nobody can set back
  ContentHash content = 0;
};

/// The files of these names, each once, in order of their paths. Reads them all to hash them.
/// Errors: kIo (one that is there cannot be read); kUnavailable (one was written to after `since` or just before it, so that nobody can
/// say whether it was read before or after).
Result<std::vector<SourceFile>> describe_sources(const std::vector<std::string>& names, std::chrono::system_clock::time_point since);

/// The path of one that is not what it was, empty if all are. A file whose times alone differ is read to be sure.
std::string find_changed(const std::vector<SourceFile>& sources);

void write_sources(const std::vector<SourceFile>& sources, MemoryImageWriter& out);
std::vector<SourceFile> read_sources(MemoryImageReader& in);

}  // namespace farfield
