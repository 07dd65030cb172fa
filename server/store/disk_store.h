// SPDX-License-Identifier: Apache-2.0
// The second tier: blobs on this machine's disk, bounded in bytes, least recently used out first, in one SQLite file.
//
//   insert ─▶ waiting (memory, bounded) ─▶ writer thread: one transaction for many ─▶ names ─▶ contents by hash
//   find   ─▶ waiting, else a reader's connection ─▶ checksum ─▶ bytes
//
// Contents are kept once, under the hash of their bytes, however many names they have. The write-ahead log makes every transaction
// whole or absent whenever the process is killed. After a power cut the last second may be gone; what is there is consistent.
// A damaged blob is a miss, and removed, so that it is made and written again. A damaged file is set aside and a new one begun.
// A full disk loses what was to be written and nothing else.
//
// Why SQLite: docs/store.md has the figures.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "server/store/blob_store.h"

namespace farfield {

struct DiskStoreOptions {
  std::filesystem::path folder;                             // made if it is not there
  std::uint64_t capacity_bytes = std::uint64_t{16} << 30;   // of the file; its log adds up to kLogBytes
  std::size_t waiting_bytes = std::size_t{64} << 20;        // more are dropped: the disk is too slow for what is made
  std::function<void(const std::string&)> log;              // failures, one line each, at most one a minute; may be empty
};

inline constexpr std::uint64_t kLeastDiskStoreBytes = std::uint64_t{1} << 20;
inline constexpr std::uint64_t kDiskStoreLogBytes = std::uint64_t{16} << 20;

/// Several processes may share a folder: each bounds the file. Destroying it writes what waits.
/// Errors: kInvalidArgument (a capacity below the least), kIo (the folder or file cannot be made or opened).
Result<std::unique_ptr<BlobStore>> open_disk_store(DiskStoreOptions options);

}  // namespace farfield
